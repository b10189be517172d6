/* SPDX-License-Identifier: Apache-2.0 */
/* The coil driver board as the flight software knows it: its last reports, and the last request to it. */
#ifndef BOARD_H
#define BOARD_H

#include "gate.h"
#include "scheduler.h"

typedef struct {
    bool has_lockout[COILS]; /* reported since the board booted */
    uint32_t lockout_ms[COILS];
    uint8_t seq;         /* of the last request that it accepted */
    uint32_t idle_ticks; /* reports in a row of coils that are off */
    bool has_fired;
    uint32_t fired_tick;
    coil_pulse fired; /* the last request, level 0: none, or taken back, */
    vec3 paid_nms;    /* and the impulse that it paid */
} board_view;

void board_boot(board_view *view);

/* Take what the board has said in this tick. */
void board_update(board_view *view, const gate_readings *readings);

/* The board says that its coils are off: a current that the read-back's offset explains is none. */
bool board_is_off(const gate_readings *readings);

/* A current flows that the board does not drive: a coil is stuck. */
bool board_is_stuck(const gate_readings *readings);

/* Whether the board has refused the last request, so that it pays nothing. */
bool board_has_refused(const board_view *view, const gate_readings *readings, uint32_t tick);

/* Whether the board has reported that it would accept a request of this coil. */
bool board_is_ready(const board_view *view, const gate_readings *readings, uint8_t coil);

#endif
