/* SPDX-License-Identifier: Apache-2.0 */
/* A coil driver board: frames and the time in, frames and the drive of the coils out.
 *
 * It does no input or output, reads no clock and allocates nothing: the adapter that calls it has the bus, the
 * clock, the coils and their current. Everything that it remembers is in one coil_board.
 *
 *     coil_board_switch_on   once, after reset
 *     coil_board_receive     for each frame of the bus
 *     coil_board_pass_time   while none comes: at least every millisecond, or when the drive ends
 *
 * After each of these drive the coils as coil_board_drive says, and send what is in the outbox.
 */
#ifndef COIL_BOARD_H
#define COIL_BOARD_H

#include "guard.h"
#include "read_back.h"

/* Refusals that are reported in one tick: a flood of requests is not answered by a flood of frames. */
#define REFUSALS_MOST 64U
/* Boot, status, refusals, dead-man and a fault of the current, heartbeat. */
#define OUTBOX_MOST (REFUSALS_MOST + 5U)

/* Frames to send, in their order. The adapter empties it: count = 0. */
typedef struct {
    bus_frame frames[OUTBOX_MOST];
    uint32_t count;
} outbox;

/* What is on: level on coil, and when a timer must end it, by the board's clock [ms]. Level 0: all are off. */
typedef struct {
    uint8_t coil;
    int8_t level;
    uint32_t until_ms;
} coil_drive;

typedef struct {
    guard coils;
    uint32_t tick; /* that the board is in */
    uint32_t first_tick;
    bool has_synced;
    uint32_t synced_tick; /* of the last SYNC that went on in the count */
    bool has_strange;
    uint32_t strange_tick;  /* of the last SYNC, if it was a strange one */
    uint32_t since_sync_ms; /* since a SYNC went on in the count, or boot */
    bool silenced;          /* the dead-man has woken, and is still to be reported */
    uint8_t held_coil;      /* what has been driven without a change, level 0: nothing, */
    int8_t held_level;
    uint32_t held_ticks; /* and for how many ticks */
    bool tested;         /* the self-test is done */
    coil_event finding;  /* what is wrong with the current */
    uint32_t rejects;    /* frames that failed the gate since boot */
    uint8_t status_counter;
    uint8_t refusal_counter;
    uint8_t event_counter;
    uint8_t heartbeat_counter;
    coil_refusal refusals[REFUSALS_MOST]; /* to be reported in the next tick */
    uint32_t refusal_count;
} coil_board;

/* The board wakes up in a tick, off and with a full lockout.
 *
 * now_ms: the board's own clock, modulo 2^32, that never runs back.
 * current_ma: read-back of the coil current at this instant, or CURRENT_UNKNOWN.
 */
void coil_board_switch_on(coil_board *board, uint32_t tick, uint32_t now_ms, int32_t current_ma, outbox *out);

/* A frame of the bus. */
void coil_board_receive(coil_board *board, const bus_frame *frame, uint32_t now_ms, int32_t current_ma,
                        outbox *out);

/* Time has passed: pulses end, and the dead-man acts. */
void coil_board_pass_time(coil_board *board, uint32_t now_ms);

/* What is to be on at the latest time given to the board. */
coil_drive coil_board_drive(const coil_board *board);

#endif
