/* SPDX-License-Identifier: Apache-2.0 */
#include "coil_board.h"

#include "coil_limits.h"

#define HEARTBEAT_TICKS (60U * LIMITS_TICK_HZ)
#define SETTLE_TICKS (((READ_BACK_SETTLE_MS * LIMITS_TICK_HZ) + 999U) / 1000U)

static void post(outbox *out, bus_frame frame)
{
    if (out->count < OUTBOX_MOST) {
        out->frames[out->count] = frame;
        out->count++;
    }
}

/* One more, but never back to 0. */
static uint32_t one_more(uint32_t count)
{
    uint32_t more = count;
    if (more < UINT32_MAX) {
        more++;
    }
    return more;
}

/* --- what is reported in a tick */

static void report_status(coil_board *board, int32_t current_ma, outbox *out)
{
    const guard *coils = &board->coils;
    coil_status status;
    status.level = coils->level;
    status.coil = (coils->level != 0) ? coils->coil : ((uint8_t)(board->tick % COILS));
    status.remaining_ms = guard_remaining_ms(coils);
    status.current_ma = current_ma;
    status.lockout_ms = guard_lockout_ms(coils, status.coil);
    status.seq = coils->seq;
    post(out, status_frame(&status, board->status_counter));
    board->status_counter++;
}

static void report_refusals(coil_board *board, outbox *out)
{
    for (uint32_t place = 0U; (place < board->refusal_count) && (place < REFUSALS_MOST); place++) {
        post(out, refused_frame(&board->refusals[place], board->refusal_counter));
        board->refusal_counter++;
    }
    board->refusal_count = 0U;
}

static void report_event(coil_board *board, coil_event event, int32_t argument, outbox *out)
{
    post(out, event_frame(event, board->tick, argument, board->event_counter));
    board->event_counter++;
}

/* Whether what is driven has been so for long enough for its current to be judged. */
static bool has_settled(coil_board *board)
{
    const bool on = guard_is_on(&board->coils);
    const uint8_t coil = on ? board->coils.coil : 0U;
    const int8_t level = on ? board->coils.level : 0;
    if ((coil == board->held_coil) && (level == board->held_level)) {
        board->held_ticks = one_more(board->held_ticks);
    } else { /* a pulse ends, and may end within a tick */
        board->held_coil = coil;
        board->held_level = level;
        board->held_ticks = 0U;
    }
    return board->held_ticks >= SETTLE_TICKS;
}

static void judge_current(coil_board *board, int32_t current_ma, outbox *out)
{
    const coil_event before = board->finding;
    board->finding = read_back_judge(guard_is_on(&board->coils) ? board->coils.level : 0, current_ma);
    if ((board->finding != NO_EVENT) && (board->finding != before)) {
        report_event(board, board->tested ? board->finding : SELF_TEST_FAILED, current_ma, out);
    }
    board->tested = true;
}

/* A current flows that the board does not drive: a coil is on, whatever the guard says. */
static bool is_shorted(const coil_board *board)
{
    return board->finding == CURRENT_WHILE_OFF;
}

static board_state state_of(const coil_board *board)
{
    board_state state = STATE_READY;
    if (is_shorted(board)) {
        state = STATE_FAULT;
    } else if (guard_is_on(&board->coils)) {
        state = STATE_ON;
    } else if (guard_is_locked_out(&board->coils)) {
        state = STATE_LOCKED_OUT;
    } else {
        /* nothing runs */
    }
    return state;
}

static void report_heartbeat(coil_board *board, outbox *out)
{
    if (((board->tick - board->first_tick) % HEARTBEAT_TICKS) == 0U) {
        post(out, heartbeat_frame(state_of(board), board->rejects, board->tick, board->heartbeat_counter));
        board->heartbeat_counter++;
    }
}

/* --- requests */

/* Note a refusal, to be reported in the next tick. */
static void refuse(coil_board *board, const fire_request *request, refusal_reason reason)
{
    if (board->refusal_count < REFUSALS_MOST) {
        coil_refusal *refusal = &board->refusals[board->refusal_count];
        refusal->coil = request->coil;
        refusal->seq = request->seq;
        refusal->tick = (uint8_t)(board->tick & 0xFFU);
        refusal->reason = reason;
        board->refusal_count++;
    }
}

static void take_request(coil_board *board, const bus_frame *frame)
{
    const fire_request request = fire_of(frame);
    refusal_reason reason = COIL_ON;
    if (!is_shorted(board)) {
        reason = guard_ask(&board->coils, &request, board->tick);
    }
    if (reason != NOT_REFUSED) {
        refuse(board, &request, reason);
    } else { /* a pulse may end before the next tick, in which all coils are off again */
        board->held_coil = request.coil;
        board->held_level = request.level;
        board->held_ticks = 0U;
    }
}

static void reject(coil_board *board, const bus_frame *frame)
{
    board->rejects = one_more(board->rejects);
    if ((frame->can_id == COIL_FIRE_ID) && (frame->length >= COIL_FIRE_NAMED_BYTES)) {
        const fire_request request = fire_of(frame);
        refuse(board, &request, MALFORMED);
    }
}

/* --- the count of ticks */

static void enter_next(coil_board *board, int32_t current_ma, outbox *out)
{
    board->tick++;
    guard_tick(&board->coils);
    report_status(board, current_ma, out);
    report_refusals(board, out);
    if (board->silenced) {
        board->silenced = false;
        report_event(board, DEAD_MAN, 0, out);
    }
    if (has_settled(board)) {
        judge_current(board, current_ma, out);
    }
    report_heartbeat(board, out);
}

/* Whether b is the tick after a. The last tick has none after it. */
static bool follows(uint32_t a, uint32_t b)
{
    return (b > a) && ((b - a) == 1U);
}

/* A SYNC that goes on in the count: it names this tick or the next. */
static void follow_sync(coil_board *board, uint32_t tick, int32_t current_ma, outbox *out)
{
    if ((!board->has_synced) || (tick != board->synced_tick)) { /* one that is repeated is no sign of life */
        board->has_synced = true;
        board->synced_tick = tick;
        board->since_sync_ms = 0U;
    }
    if (tick != board->tick) {
        enter_next(board, current_ma, out);
    }
    guard_sync(&board->coils);
}

static void take_sync(coil_board *board, uint32_t tick, int32_t current_ma, outbox *out)
{
    const bool had_strange = board->has_strange;
    const uint32_t strange = board->strange_tick;
    board->has_strange = false;
    if ((tick == board->tick) || follows(board->tick, tick)) {
        follow_sync(board, tick, current_ma, out);
    } else if (had_strange && ((tick == strange) || follows(strange, tick))) { /* the count is lost */
        coil_board_switch_on(board, tick, board->coils.clock_ms, current_ma, out);
        board->has_synced = true;
        board->synced_tick = tick;
    } else {
        board->has_strange = true;
        board->strange_tick = tick;
    }
}

static void take_tick_done(coil_board *board, uint32_t tick, int32_t current_ma, outbox *out)
{
    if ((tick == board->tick) && (tick != UINT32_MAX)) {
        enter_next(board, current_ma, out);
    }
}

/* --- the board */

void coil_board_switch_on(coil_board *board, uint32_t tick, uint32_t now_ms, int32_t current_ma, outbox *out)
{
    guard_boot(&board->coils, now_ms);
    board->tick = tick;
    board->first_tick = tick;
    board->has_synced = false;
    board->synced_tick = 0U;
    board->has_strange = false;
    board->strange_tick = 0U;
    board->since_sync_ms = 0U;
    board->silenced = false;
    board->held_coil = 0U;
    board->held_level = 0;
    board->held_ticks = 0U;
    board->tested = false;
    board->finding = NO_EVENT;
    board->rejects = 0U;
    board->status_counter = 0U;
    board->refusal_counter = 0U;
    board->event_counter = 0U;
    board->heartbeat_counter = 0U;
    board->refusal_count = 0U;
    post(out, boot_frame(LIMITS_TABLE_CRC));
    report_status(board, current_ma, out);
}

void coil_board_pass_time(coil_board *board, uint32_t now_ms)
{
    const uint32_t elapsed_ms = guard_pass_time(&board->coils, now_ms);
    const uint32_t room_ms = UINT32_MAX - board->since_sync_ms;
    board->since_sync_ms += (elapsed_ms < room_ms) ? elapsed_ms : room_ms;
    if ((LIMITS_DEADMAN_MS > 0U) && (board->since_sync_ms > LIMITS_DEADMAN_MS)) {
        guard_silence(&board->coils);
        board->silenced = true;
    }
}

void coil_board_receive(coil_board *board, const bus_frame *frame, uint32_t now_ms, int32_t current_ma,
                        outbox *out)
{
    coil_board_pass_time(board, now_ms);
    if (!frame_is_intact(frame)) {
        reject(board, frame);
    } else if (frame->can_id == COIL_FIRE_ID) {
        take_request(board, frame);
    } else if (frame->can_id == SYNC_ID) {
        take_sync(board, tick_of(frame), current_ma, out);
    } else if (frame->can_id == TICK_DONE_ID) {
        take_tick_done(board, tick_of(frame), current_ma, out);
    } else if ((frame->can_id == PLANT_BOOT_ID) && (board->tick > 0U)) {
        coil_board_switch_on(board, 0U, now_ms, current_ma, out);
    } else {
        /* a message that is not for this board */
    }
}

coil_drive coil_board_drive(const coil_board *board)
{
    coil_drive drive = {0U, 0, 0U};
    if (guard_drives(&board->coils)) {
        drive.coil = board->coils.coil;
        drive.level = board->coils.pulse_level;
        drive.until_ms = guard_ends_ms(&board->coils);
    }
    return drive;
}
