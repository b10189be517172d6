/* SPDX-License-Identifier: Apache-2.0 */
/* One step of the board, from any state that keeps its invariant, on any frame at any time, for Frama-C's Eva:
 * proof/prove.sh.
 *
 * No step is undefined: no index is out of bounds, nothing overflows, nothing is read that was not written. And
 * the invariant is kept, so that both hold for ever.
 */
#include <__fc_builtin.h>

#include "coil_board.h"
#include "coil_limits.h"

#define LOCKOUT_MOST ((LIMITS_PULSE_MS + LIMITS_BACKOFF_MS) * LIMITS_TICK_HZ)

static coil_board board;
static outbox sent;

static uint32_t any_word(void)
{
    return Frama_C_unsigned_int_interval(0U, UINT32_MAX);
}

static uint8_t any_byte(void)
{
    return Frama_C_unsigned_char_interval(0U, 255U);
}

static bool any_truth(void)
{
    return Frama_C_interval(0, 1) == 1;
}

static int8_t any_level(void)
{
    return (int8_t)Frama_C_interval(-3, 3);
}

static void any_timers(interlock *timers)
{
    timers->remaining = Frama_C_unsigned_int_interval(0U, LIMITS_PULSE_MS * LIMITS_TICK_HZ);
    for (uint32_t coil = 0U; coil < COILS; coil++) {
        timers->lockout[coil] = Frama_C_unsigned_int_interval(0U, LOCKOUT_MOST);
    }
}

static void any_board(void)
{
    any_timers(&board.coils.by_ticks);
    any_timers(&board.coils.by_clock);
    board.coils.clock_ms = any_word();
    board.coils.coil = Frama_C_unsigned_char_interval(0U, COILS - 1U);
    board.coils.level = any_level();
    board.coils.pulse_level = any_level();
    board.coils.has_seq = any_truth();
    board.coils.seq = any_byte();
    board.coils.driven = any_truth();
    board.coils.tick_under_way = any_truth();
    board.coils.silent = any_truth();
    board.tick = any_word();
    board.first_tick = any_word();
    board.has_synced = any_truth();
    board.synced_tick = any_word();
    board.has_strange = any_truth();
    board.strange_tick = any_word();
    board.since_sync_ms = any_word();
    board.silenced = any_truth();
    board.held_coil = any_byte();
    board.held_level = any_level();
    board.held_ticks = any_word();
    board.tested = any_truth();
    board.finding = (coil_event)Frama_C_interval(NO_EVENT, CURRENT_WRONG);
    board.rejects = any_word();
    board.status_counter = any_byte();
    board.refusal_counter = any_byte();
    board.event_counter = any_byte();
    board.heartbeat_counter = any_byte();
    for (uint32_t place = 0U; place < REFUSALS_MOST; place++) {
        board.refusals[place].coil = any_byte();
        board.refusals[place].seq = any_byte();
        board.refusals[place].tick = any_byte();
        board.refusals[place].reason = (refusal_reason)Frama_C_interval(NOT_REFUSED, LOCKOUT);
    }
    board.refusal_count = Frama_C_unsigned_int_interval(0U, REFUSALS_MOST);
}

static bus_frame any_frame(void)
{
    bus_frame frame;
    frame.can_id = any_word();
    frame.length = Frama_C_unsigned_char_interval(0U, FRAME_DATA_MOST);
    for (uint32_t place = 0U; place < FRAME_DATA_MOST; place++) {
        frame.data[place] = any_byte();
    }
    return frame;
}

int main(void)
{
    const bus_frame frame = any_frame();
    const int32_t current_ma = Frama_C_interval(INT32_MIN, INT32_MAX);
    any_board();
    sent.count = 0U;
    if (any_truth()) {
        coil_board_switch_on(&board, any_word(), any_word(), current_ma, &sent);
    } else if (any_truth()) {
        coil_board_receive(&board, &frame, any_word(), current_ma, &sent);
    } else {
        coil_board_pass_time(&board, any_word());
    }
    const coil_drive drive = coil_board_drive(&board);
    const guard *coils = &board.coils;
    /*@ assert level_of_drive: -3 <= drive.level <= 3; */
    /*@ assert coil_of_drive: drive.coil < COILS; */
    /*@ assert levels: -3 <= coils->level <= 3 && -3 <= coils->pulse_level <= 3 && -3 <= board.held_level <= 3; */
    /*@ assert coil: coils->coil < COILS; */
    /*@ assert pulse_by_ticks: coils->by_ticks.remaining <= LIMITS_PULSE_MS * LIMITS_TICK_HZ; */
    /*@ assert pulse_by_clock: coils->by_clock.remaining <= LIMITS_PULSE_MS * LIMITS_TICK_HZ; */
    /*@ assert lockout_by_ticks: \forall integer i; 0 <= i < COILS ==> coils->by_ticks.lockout[i] <= LOCKOUT_MOST; */
    /*@ assert lockout_by_clock: \forall integer i; 0 <= i < COILS ==> coils->by_clock.lockout[i] <= LOCKOUT_MOST; */
    /*@ assert finding: NO_EVENT <= board.finding <= CURRENT_WRONG; */
    /*@ assert refusals: board.refusal_count <= REFUSALS_MOST; */
    /*@ assert outbox: sent.count <= OUTBOX_MOST; */
    return 0;
}
