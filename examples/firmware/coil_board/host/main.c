/* SPDX-License-Identifier: Apache-2.0 */
/* The coil board as a program of this machine: its bus is Torquer's loop bus, or slcan on a pseudo-terminal.
 *
 *     coil_board loop:PORT [PINS]
 *     coil_board slcan [PINS]        prints the terminal to open: on slcan:/dev/pts/3
 *
 * Its coils draw their nominal current at once. PINS is a file for the changes of the outputs, - for stdout, in
 * the form of torquer board coil --pins.
 */
#define _XOPEN_SOURCE 700

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "coil_board.h"
#include "coil_limits.h"
#include "record.h"
#include "slcan.h"

#define GREETING "torquer-loop/1\r\n"
#define PATIENCE_MS 10000 /* for a hub to come up */
#define RETRY_MS 10
#define TURN_MS 10 /* a silent bus is left for the dead-man and the pins so often */
#define CHUNK 4096U

typedef struct {
    int descriptor;
    bool is_slcan;
    slcan_line line;
    uint8_t record[RECORD_BYTES];
    uint32_t record_bytes;
} host_bus;

static coil_board board;
static outbox sent;
static coil_drive shown;
static FILE *pins;

static void fail(const char *what)
{
    (void)fprintf(stderr, "coil_board: %s\n", what);
    exit(2);
}

static uint64_t now_ms(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return ((uint64_t)now.tv_sec * 1000U) + ((uint64_t)now.tv_nsec / 1000000U);
}

static void pause_ms(long milliseconds)
{
    const struct timespec pause = {0, milliseconds * 1000000L};
    (void)nanosleep(&pause, NULL);
}

/* What the coils draw: the nominal current of what is on. */
static int32_t current_ma(void)
{
    static const int32_t NOMINAL_MA[] = {0, LIMITS_LEVEL_1_MA, LIMITS_LEVEL_2_MA, LIMITS_LEVEL_3_MA};
    const coil_drive drive = coil_board_drive(&board);
    return (drive.level < 0) ? -NOMINAL_MA[-drive.level] : NOMINAL_MA[drive.level];
}

static void write_all(int descriptor, const uint8_t *bytes, size_t length)
{
    size_t done = 0U;
    while (done < length) {
        const ssize_t count = write(descriptor, &bytes[done], length - done);
        if (count > 0) {
            done += (size_t)count;
        } else if ((count < 0) && (errno == EINTR)) {
            /* once more */
        } else {
            fail("the bus accepts nothing");
        }
    }
}

static void send_outbox(const host_bus *bus)
{
    for (uint32_t place = 0U; place < sent.count; place++) {
        uint8_t bytes[SLCAN_LINE_MOST] = {0U};
        uint32_t length = RECORD_BYTES;
        if (bus->is_slcan) {
            length = slcan_write(&sent.frames[place], bytes);
        } else {
            record_of_frame(&sent.frames[place], bytes);
        }
        write_all(bus->descriptor, bytes, length);
    }
    sent.count = 0U;
}

/* A change of the outputs as a line, as a logic analyser would show it. */
static void show_pins(uint64_t at_ms)
{
    const coil_drive drive = coil_board_drive(&board);
    const uint64_t until_ms = at_ms + (drive.until_ms - (uint32_t)at_ms);
    if ((pins != NULL) &&
        ((drive.level != shown.level) || (drive.coil != shown.coil) || (drive.until_ms != shown.until_ms))) {
        if (drive.level == 0) {
            (void)fprintf(pins, "%" PRIu64 " off\n", at_ms);
        } else {
            (void)fprintf(pins, "%" PRIu64 " on %d %d until %" PRIu64 "\n", at_ms, drive.coil, drive.level,
                          until_ms);
        }
        (void)fflush(pins);
    }
    shown = drive;
}

static bool take_byte(host_bus *bus, uint8_t byte, bus_frame *frame)
{
    bool complete = false;
    if (bus->is_slcan) {
        complete = slcan_take(&bus->line, byte, frame);
    } else {
        bus->record[bus->record_bytes] = byte;
        bus->record_bytes++;
        complete = bus->record_bytes == RECORD_BYTES;
        if (complete) {
            *frame = record_to_frame(bus->record);
            bus->record_bytes = 0U;
        }
    }
    return complete;
}

static void take_bytes(host_bus *bus, const uint8_t *bytes, size_t length)
{
    for (size_t place = 0U; place < length; place++) {
        bus_frame frame = {0U, 0U, {0U}};
        if (take_byte(bus, bytes[place], &frame)) {
            const uint64_t at_ms = now_ms();
            coil_board_pass_time(&board, (uint32_t)at_ms);
            show_pins(at_ms);
            coil_board_receive(&board, &frame, (uint32_t)at_ms, current_ma(), &sent);
            show_pins(at_ms);
            send_outbox(bus);
        }
    }
}

/* Serve the bus until it is closed. */
static void serve(host_bus *bus)
{
    uint8_t bytes[CHUNK];
    bool open = true;
    while (open) {
        struct pollfd ready = {bus->descriptor, POLLIN, 0};
        const int count = poll(&ready, 1U, TURN_MS);
        const uint64_t at_ms = now_ms();
        coil_board_pass_time(&board, (uint32_t)at_ms);
        show_pins(at_ms);
        if (count > 0) {
            const ssize_t length = read(bus->descriptor, bytes, sizeof bytes);
            if (length > 0) {
                take_bytes(bus, bytes, (size_t)length);
            }
            open = (length > 0) || ((length < 0) && (errno == EINTR));
        }
    }
}

/* A connection that the hub of the loop bus has greeted; -1 if there is none yet. */
static int join(uint16_t port)
{
    const int one = 1;
    char greeting[sizeof GREETING] = {0};
    size_t greeted = 0U;
    ssize_t count = 1;
    struct sockaddr_in hub;
    const int descriptor = socket(AF_INET, SOCK_STREAM, 0);
    (void)memset(&hub, 0, sizeof hub);
    hub.sin_family = AF_INET;
    hub.sin_port = htons(port);
    hub.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(descriptor, (const struct sockaddr *)&hub, sizeof hub) != 0) {
        (void)close(descriptor);
        return -1;
    }
    (void)setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    while ((greeted < strlen(GREETING)) && (count > 0)) {
        count = read(descriptor, &greeting[greeted], strlen(GREETING) - greeted);
        greeted += (count > 0) ? (size_t)count : 0U;
    }
    if (strcmp(greeting, GREETING) != 0) {
        fail("the port is taken by another program, or the hub accepts no more clients");
    }
    return descriptor;
}

static int open_loop(const char *port_text)
{
    char *end = NULL;
    const long port = strtol(port_text, &end, 10);
    int descriptor = -1;
    if ((*end != '\0') || (port < 1) || (port > 65535)) {
        fail("loop:PORT needs a port from 1 to 65535");
    }
    for (int waited_ms = 0; (descriptor < 0) && (waited_ms < PATIENCE_MS); waited_ms += RETRY_MS) {
        descriptor = join((uint16_t)port);
        if (descriptor < 0) {
            pause_ms(RETRY_MS);
        }
    }
    if (descriptor < 0) {
        fail("no hub answers on this port: who hosts the loop bus starts first");
    }
    return descriptor;
}

/* The master of a pseudo-terminal, in raw mode; its other end is held open, so that clients may come and go. */
static int open_terminal(void)
{
    struct termios settings;
    const int master = posix_openpt(O_RDWR | O_NOCTTY);
    if ((master < 0) || (grantpt(master) != 0) || (unlockpt(master) != 0)) {
        fail("there is no pseudo-terminal");
    }
    const char *const name = ptsname(master);
    const int slave = open(name, O_RDWR | O_NOCTTY);
    if ((slave < 0) || (tcgetattr(slave, &settings) != 0)) {
        fail("the pseudo-terminal cannot be opened");
    }
    settings.c_iflag = 0;
    settings.c_oflag = 0;
    settings.c_lflag = 0;
    (void)tcsetattr(slave, TCSANOW, &settings);
    (void)fprintf(stderr, "on slcan:%s\n", name);
    return master;
}

int main(int count, char **words)
{
    static host_bus bus;
    if ((count < 2) || (count > 3)) {
        fail("usage: coil_board loop:PORT|slcan [PINS]");
    }
    if (strcmp(words[1], "slcan") == 0) {
        bus.is_slcan = true;
        bus.descriptor = open_terminal();
    } else if (strncmp(words[1], "loop:", 5U) == 0) {
        bus.descriptor = open_loop(&words[1][5]);
        (void)fprintf(stderr, "on %s\n", words[1]);
    } else {
        fail("the bus is loop:PORT or slcan");
    }
    if (count == 3) {
        pins = (strcmp(words[2], "-") == 0) ? stdout : fopen(words[2], "w");
        if (pins == NULL) {
            fail("the file for the pins cannot be written");
        }
    }
    coil_board_switch_on(&board, 0U, (uint32_t)now_ms(), 0, &sent);
    send_outbox(&bus);
    serve(&bus);
    return 0;
}
