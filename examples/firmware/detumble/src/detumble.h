/* SPDX-License-Identifier: Apache-2.0 */
/* A flight software: frames of the bus in, frames out.
 *
 * It brakes a tumble by B-dot, from the magnetometer alone. Where attitude and rate are given and the body turns
 * slowly, it points by PD. What these laws demand is paid in pulses by the scheduler.
 *
 * It does no input or output, reads no clock and allocates nothing: time is the tick that SYNC names. Everything
 * that it remembers is in one detumble.
 */
#ifndef DETUMBLE_H
#define DETUMBLE_H

#include "board.h"

/* Frames of one answer: FSW_BOOT, or COIL_FIRE and TICK_DONE. */
#define ANSWER_MOST 2U
/* Answers that are kept; there is one for each SYNC of a call. */
#define OUTBOX_MOST (8U * ANSWER_MOST)

/* Frames to send, in their order. The adapter empties it: count = 0. */
typedef struct {
    bus_frame frames[OUTBOX_MOST];
    uint32_t count;
} outbox;

typedef enum { MODE_DETUMBLE = 0, MODE_POINT = 1 } control_mode;

/* A sample of the field while no coil disturbed it, body axes. */
typedef struct {
    bool is_known;
    uint32_t tick;
    vec3 b_t;
} field_sample;

typedef struct {
    coil_set coils;
    gate gate;
    scheduler pulses;
    board_view board;
    control_mode mode;
    vec3 integral_s; /* of the attitude's error, while it points */
    field_sample sample; /* the last one, */
    field_sample before; /* and the last one of the tick before */
    bool has_tick;
    uint32_t tick; /* answered last */
    bool has_strange;
    uint32_t strange_tick; /* of the last SYNC, if it was a strange one, or abandoned for it */
    bool is_asked;         /* by PLANT_BOOT, since the last SYNC */
    uint8_t fire_counter;
} detumble;

/* After reset: nothing is known, and a whole back-off comes first. */
void detumble_boot(detumble *fsw, outbox *out);

/* Frames of the bus, in their order, as many as have come; each SYNC among them is answered. */
void detumble_step(detumble *fsw, const bus_frame *in, uint32_t count, outbox *out);

/* Whether this frame is a PLANT_END that fits the ticks that were answered: a false one ends no flight. */
bool detumble_is_end(const detumble *fsw, const bus_frame *frame);

#endif
