/* SPDX-License-Identifier: Apache-2.0 */
/* The board: the order of what it sends, the dead-man, lost count, a flood, and a current that it does not drive. */
#include "coil_board.h"

#include "check.h"
#include "coil_limits.h"

static coil_board board;
static outbox sent;
static uint32_t now_ms;
static int32_t current_ma;

static void say(uint32_t can_id, uint32_t tick)
{
    bus_frame frame = {can_id, 8U, {0U}};
    for (uint32_t place = 0U; place < 4U; place++) {
        frame.data[place] = (uint8_t)((tick >> (8U * place)) & 0xFFU);
    }
    sent.count = 0U;
    coil_board_receive(&board, &frame, now_ms, current_ma, &sent);
}

static void ask(uint8_t seq)
{
    bus_frame frame = {COIL_FIRE_ID, 7U, {0x10U, 0U, seq, (uint8_t)(board.tick & 0xFFU), 100U, 0U, 0U, 0U}};
    frame_seal(&frame);
    sent.count = 0U;
    coil_board_receive(&board, &frame, now_ms, current_ma, &sent);
}

static void run_ticks(uint32_t ticks)
{
    for (uint32_t count = 0U; count < ticks; count++) {
        say(SYNC_ID, board.tick);
        now_ms += 1000U / LIMITS_TICK_HZ;
        say(TICK_DONE_ID, board.tick);
    }
}

static void switched_on(void)
{
    now_ms = 0U;
    current_ma = 0;
    sent.count = 0U;
    coil_board_switch_on(&board, 0U, now_ms, current_ma, &sent);
}

static uint32_t count_of(uint32_t can_id)
{
    uint32_t count = 0U;
    for (uint32_t place = 0U; place < sent.count; place++) {
        count += (sent.frames[place].can_id == can_id) ? 1U : 0U;
        CHECK(frame_is_intact(&sent.frames[place]));
    }
    return count;
}

static void it_boots_with_a_message_and_a_status(void)
{
    switched_on();
    CHECK(sent.count == 2U);
    CHECK((sent.frames[0].can_id == COIL_BOOT_ID) && (sent.frames[1].can_id == COIL_STATUS_ID));
    CHECK(coil_board_drive(&board).level == 0);
}

static void a_flood_is_answered_by_64_refusals(void)
{
    switched_on();
    for (uint32_t request = 0U; request < 1000U; request++) {
        ask((uint8_t)(request & 0xFFU));
        CHECK(sent.count == 0U);
    }
    run_ticks(1U);
    CHECK((count_of(COIL_STATUS_ID) == 1U) && (count_of(COIL_REFUSED_ID) == REFUSALS_MOST));
}

static void the_dead_man_is_told_once(void)
{
    switched_on();
    run_ticks(3U);
    now_ms += LIMITS_DEADMAN_MS + 1U;
    coil_board_pass_time(&board, now_ms);
    run_ticks(1U);
    CHECK(count_of(COIL_EVENT_ID) == 1U);
    run_ticks(1U);
    CHECK(count_of(COIL_EVENT_ID) == 0U);
}

static void two_strange_syncs_in_a_row_restart_it(void)
{
    switched_on();
    run_ticks(3U);
    say(SYNC_ID, 1000U);
    CHECK(sent.count == 0U);
    say(SYNC_ID, board.tick); /* a good one ends the row */
    say(SYNC_ID, 1001U);
    CHECK((sent.count == 0U) && (board.tick == 3U));
    say(SYNC_ID, 1002U);
    CHECK((count_of(COIL_BOOT_ID) == 1U) && (board.tick == 1002U));
}

static void the_last_tick_has_none_after_it(void)
{
    switched_on();
    say(SYNC_ID, UINT32_MAX);
    say(SYNC_ID, UINT32_MAX);
    CHECK(board.tick == UINT32_MAX);
    say(TICK_DONE_ID, UINT32_MAX);
    CHECK((sent.count == 0U) && (board.tick == UINT32_MAX));
    say(SYNC_ID, 0U);
    CHECK(sent.count == 0U);
    say(SYNC_ID, 1U);
    CHECK(count_of(COIL_BOOT_ID) == 1U);
}

static void a_current_that_it_does_not_drive_refuses_everything(void)
{
    switched_on();
    run_ticks(1U);
    CHECK(count_of(COIL_EVENT_ID) == 0U);
    current_ma = LIMITS_LEVEL_1_MA;
    run_ticks(LIMITS_BACKOFF_MS / 1000U * LIMITS_TICK_HZ);
    ask(1U);
    CHECK(coil_board_drive(&board).level == 0);
    current_ma = 0;
    run_ticks(1U);
    CHECK(count_of(COIL_REFUSED_ID) == 1U);
    ask(2U);
    CHECK(coil_board_drive(&board).level == 1);
}

static void a_heartbeat_comes_every_minute(void)
{
    switched_on();
    run_ticks(60U * LIMITS_TICK_HZ - 1U);
    CHECK(count_of(COIL_HEARTBEAT_ID) == 0U);
    run_ticks(1U);
    CHECK(count_of(COIL_HEARTBEAT_ID) == 1U);
}

int main(void)
{
    it_boots_with_a_message_and_a_status();
    a_flood_is_answered_by_64_refusals();
    the_dead_man_is_told_once();
    two_strange_syncs_in_a_row_restart_it();
    the_last_tick_has_none_after_it();
    a_current_that_it_does_not_drive_refuses_everything();
    a_heartbeat_comes_every_minute();
    return failed_checks;
}
