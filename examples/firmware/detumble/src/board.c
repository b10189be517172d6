/* SPDX-License-Identifier: Apache-2.0 */
#include "board.h"

#include "detumble_gains.h"
#include "torquer.h"

#define IDLE_MOST 10000U
#define REFUSED_WITHIN_TICKS 2U
#define LOW_BYTE 0xFFU

/* Refusals of a broken or repeated frame, which may stand beside the very request that is driven. */
#define REASON_MALFORMED TORQUER_COIL_REFUSED_REASON_MALFORMED_CHOICE
#define REASON_REPEATED_SEQ TORQUER_COIL_REFUSED_REASON_REPEATED_SEQ_CHOICE

void board_boot(board_view *view)
{
    for (uint32_t coil = 0U; coil < COILS; coil++) {
        view->has_lockout[coil] = false;
        view->lockout_ms[coil] = 0U;
    }
    view->seq = 0U;
    view->idle_ticks = 0U;
    view->has_fired = false;
    view->fired_tick = 0U;
    view->fired.coil = 0U;
    view->fired.level = 0;
    view->paid_nms = VEC3_ZERO;
}

bool board_is_off(const gate_readings *readings)
{
    const int32_t current_ma = readings->current_ma;
    return readings->has_status && (readings->level == 0) && (current_ma >= -GAINS_OFF_MA) &&
           (current_ma <= GAINS_OFF_MA);
}

bool board_is_stuck(const gate_readings *readings)
{
    return readings->has_status && (readings->level == 0) && (!board_is_off(readings));
}

void board_update(board_view *view, const gate_readings *readings)
{
    if (readings->coil_booted) {
        for (uint32_t coil = 0U; coil < COILS; coil++) {
            view->has_lockout[coil] = false;
        }
    }
    if (readings->has_status) {
        view->has_lockout[readings->coil] = true;
        view->lockout_ms[readings->coil] = readings->lockout_ms;
        view->seq = readings->seq;
    }
    if (!board_is_off(readings)) {
        view->idle_ticks = 0U;
    } else if (view->idle_ticks < IDLE_MOST) {
        view->idle_ticks++;
    } else {
        /* longer than any sample is late */
    }
}

/* Whether this is the refusal of the last request. Not if the board reports that it is driven. */
static bool refuses(const board_view *view, const gate_readings *readings, const coil_refusal *refused)
{
    const bool driven = readings->has_status && (readings->level != 0) &&
                        (readings->coil == view->fired.coil) && (readings->level == view->fired.level);
    bool is_ours = false;
    if (driven || (refused->tick != (uint8_t)(view->fired_tick & LOW_BYTE))) {
        is_ours = false;
    } else if ((refused->reason == REASON_MALFORMED) || (refused->reason == REASON_REPEATED_SEQ)) {
        is_ours = readings->has_status;
    } else {
        is_ours = (refused->coil == view->fired.coil) && (refused->seq != view->seq);
    }
    return is_ours;
}

bool board_has_refused(const board_view *view, const gate_readings *readings, uint32_t tick)
{
    bool refused = false;
    if (view->has_fired && ((tick - view->fired_tick) <= REFUSED_WITHIN_TICKS)) {
        for (uint32_t place = 0U; (place < readings->refused_count) && (place < REFUSALS_MOST); place++) {
            refused = refused || refuses(view, readings, &readings->refused[place]);
        }
    }
    return refused;
}

bool board_is_ready(const board_view *view, const gate_readings *readings, uint8_t coil)
{
    return readings->has_status && view->has_lockout[coil] && (view->lockout_ms[coil] == 0U);
}
