/* A flight software in C99 and POSIX: B-dot with one self-ending pulse at a time, on the loop bus.
 *
 *     torquer header microsat --out torquer
 *     cc -std=c99 -D_POSIX_C_SOURCE=200809L -Itorquer examples/tiny_firmware.c torquer/torquer.c -lm -o firmware
 *     torquer judge microsat --flight-software './firmware {port}' --profile detumble
 */
#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "torquer.h"
#include "torquer_crc.h"
#include "torquer_scenario.h"

#define RECORD 16      /* struct can_frame: identifier, number of data bytes, 3 spare, data */
#define SPAN 10        /* ticks over which the change of the field is taken */
#define LEAST_NT 1300  /* by which it must change, or nothing is fired */

static int bus;
static uint8_t answer[8 * RECORD];
static size_t answer_size;

static void put(uint32_t id, const uint8_t *data, int length)
{
    uint8_t *record = answer + answer_size;
    memset(record, 0, RECORD);
    memcpy(record, &id, sizeof id);
    record[4] = (uint8_t)length;
    memcpy(record + 8, data, (size_t)length);
    answer_size += RECORD;
}

static void send_all(void)
{
    for (size_t sent = 0; sent < answer_size;) {
        ssize_t size = send(bus, answer + sent, answer_size - sent, 0);
        if (size <= 0) exit(0); /* the bus is closed: the flight is over */
        sent += (size_t)size;
    }
    answer_size = 0;
}

static void receive_all(uint8_t *bytes, size_t length)
{
    for (size_t had = 0; had < length;) {
        ssize_t size = recv(bus, bytes + had, length - had, 0);
        if (size <= 0) exit(0);
        had += (size_t)size;
    }
}

static void boot(void)
{
    uint8_t data[8];
    struct torquer_fsw_boot_t message = {0};
    message.version = 1;
    int length = torquer_fsw_boot_pack(data, &message, sizeof data);
    torquer_seal(TORQUER_FSW_BOOT_FRAME_ID, data, (size_t)length);
    put(TORQUER_FSW_BOOT_FRAME_ID, data, length);
    send_all();
}

/* A pulse of the coil along which the field changes most, against that change; none in its back-off. */
static void fire(uint32_t tick, const double *change, const uint32_t *lockout_ms)
{
    static uint8_t count;
    int coil = 0;
    for (int axis = 1; axis < 3; axis++) {
        if (change[axis] * change[axis] > change[coil] * change[coil]) coil = axis;
    }
    if (change[coil] * change[coil] < (double)LEAST_NT * LEAST_NT || lockout_ms[coil]) return;
    uint8_t data[8];
    struct torquer_coil_fire_t message = {0};
    message.counter = count & 0xF;
    message.seq = count++;
    message.level = change[coil] > 0.0 ? -3 : 3;
    message.coil = (uint8_t)coil;
    message.tick = (uint8_t)tick;
    message.duration_ms = TORQUER_PULSE_MS;
    int length = torquer_coil_fire_pack(data, &message, sizeof data);
    torquer_seal(TORQUER_COIL_FIRE_FRAME_ID, data, (size_t)length);
    put(TORQUER_COIL_FIRE_FRAME_ID, data, length);
}

int main(int count, char **words)
{
    if (count != 2) return 2;
    struct sockaddr_in hub = {0};
    hub.sin_family = AF_INET;
    hub.sin_port = htons((uint16_t)atoi(words[1]));
    hub.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    int now = 1;
    bus = socket(AF_INET, SOCK_STREAM, 0);
    if (bus < 0 || connect(bus, (struct sockaddr *)&hub, sizeof hub)) return 2;
    setsockopt(bus, IPPROTO_TCP, TCP_NODELAY, &now, sizeof now);
    uint8_t greeting[16];
    receive_all(greeting, sizeof greeting);
    if (memcmp(greeting, "torquer-loop/1\r\n", sizeof greeting)) return 2;
    boot();

    double field[SPAN + 1][3] = {{0.0}};
    uint32_t lockout_ms[3] = {1, 1, 1}, seen = 0;
    int driven = 0;
    for (;;) {
        uint8_t record[RECORD], *data = record + 8;
        uint32_t id;
        receive_all(record, sizeof record);
        memcpy(&id, record, sizeof id);
        size_t length = record[4];
        if (length > 8) continue; /* no CAN frame has more */
        if (id == TORQUER_MAG_FIELD_FRAME_ID && torquer_intact((uint16_t)id, data, length)) {
            struct torquer_mag_field_t sample;
            if (torquer_mag_field_unpack(&sample, data, length) || !sample.valid) continue;
            memmove(field[0], field[1], sizeof field - sizeof field[0]);
            field[SPAN][0] = torquer_mag_field_b_x_decode(sample.b_x);
            field[SPAN][1] = torquer_mag_field_b_y_decode(sample.b_y);
            field[SPAN][2] = torquer_mag_field_b_z_decode(sample.b_z);
            seen++;
        } else if (id == TORQUER_COIL_STATUS_FRAME_ID && torquer_intact((uint16_t)id, data, length)) {
            struct torquer_coil_status_t status;
            if (torquer_coil_status_unpack(&status, data, length) || status.coil > 2) continue;
            driven = status.level != 0;
            uint32_t left_ms = (uint32_t)torquer_coil_status_lockout_ms_decode(status.lockout_ms);
            for (int coil = 0; coil < 3; coil++) {
                if (coil == status.coil || (driven && TORQUER_BACKOFF_SHARED)) lockout_ms[coil] = left_ms;
            }
        } else if (id == TORQUER_SYNC_FRAME_ID) {
            struct torquer_sync_t sync;
            struct torquer_tick_done_t done = {0};
            if (torquer_sync_unpack(&sync, data, length)) continue;
            double change[3];
            for (int axis = 0; axis < 3; axis++) change[axis] = field[SPAN][axis] - field[0][axis];
            if (!driven && seen > SPAN) fire(sync.tick, change, lockout_ms);
            done.tick = sync.tick; /* and no CRC of the state: 0 */
            uint8_t last[8];
            put(TORQUER_TICK_DONE_FRAME_ID, last, torquer_tick_done_pack(last, &done, sizeof last));
            send_all();
        } else if (id == TORQUER_PLANT_BOOT_FRAME_ID) {
            boot();
        } else if (id == TORQUER_PLANT_END_FRAME_ID) {
            close(bus);
            return 0;
        }
    }
}
