/* SPDX-License-Identifier: Apache-2.0 */
/* The flight software as a program of this machine, on the loop bus.
 *
 *     detumble PORT
 *
 * It ends at PLANT_END, or when the bus is closed.
 */
#define _XOPEN_SOURCE 700

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "detumble.h"
#include "record.h"

#define GREETING "torquer-loop/1\r\n"
#define PATIENCE_MS 10000 /* for a hub to come up */
#define RETRY_MS 10
#define CHUNK_RECORDS 64U

static detumble fsw;
static outbox answers;

static void fail(const char *what)
{
    (void)fprintf(stderr, "detumble: %s\n", what);
    exit(2);
}

static void pause_ms(long milliseconds)
{
    const struct timespec pause = {0, milliseconds * 1000000L};
    (void)nanosleep(&pause, NULL);
}

/* Frames of an answer go at once, in one write. */
static void send_answers(int descriptor)
{
    uint8_t bytes[RECORD_BYTES * OUTBOX_MOST];
    const size_t length = RECORD_BYTES * (size_t)answers.count;
    size_t done = 0U;
    for (uint32_t place = 0U; place < answers.count; place++) {
        record_of_frame(&answers.frames[place], &bytes[RECORD_BYTES * place]);
    }
    answers.count = 0U;
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

/* Whether the flight goes on. */
static bool take_record(int descriptor, const uint8_t *record)
{
    const bus_frame frame = record_to_frame(record);
    const bool ends = detumble_is_end(&fsw, &frame);
    if (!ends) {
        detumble_step(&fsw, &frame, 1U, &answers);
        send_answers(descriptor);
    }
    return !ends;
}

/* Serve the bus until the flight ends. TCP may cut a record anywhere: its rest comes with the next bytes. */
static void serve(int descriptor)
{
    uint8_t bytes[RECORD_BYTES * CHUNK_RECORDS];
    size_t held = 0U;
    bool flies = true;
    while (flies) {
        const ssize_t count = read(descriptor, &bytes[held], sizeof bytes - held);
        size_t place = 0U;
        held += (count > 0) ? (size_t)count : 0U;
        flies = (count > 0) || ((count < 0) && (errno == EINTR));
        while (flies && ((held - place) >= RECORD_BYTES)) {
            flies = take_record(descriptor, &bytes[place]);
            place += RECORD_BYTES;
        }
        held -= place;
        (void)memmove(bytes, &bytes[place], held);
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
        fail("PORT must be from 1 to 65535");
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

int main(int count, char **words)
{
    if (count != 2) {
        fail("usage: detumble PORT");
    }
    const int descriptor = open_loop(words[1]);
    detumble_boot(&fsw, &answers);
    send_answers(descriptor);
    serve(descriptor);
    (void)close(descriptor);
    return 0;
}
