"""Errors planted in the coil board in C: what a programmer might write, by replacing text of its sources."""

import shutil
from typing import NamedTuple

from firmware_bench import BOARD, compile_board, limits_header


class Planted(NamedTuple):
    """One error.

    Args:
        file: of ``src``.
        old: text that stands there once.
        new: what stands there instead.
        finds: the check of the conformance suite that finds it.
        limits: of the board on which it shows, where the default ones hide it.
    """

    file: str
    old: str
    new: str
    finds: str
    limits: tuple[tuple[str, int], ...] = ()


def compile_planted(folder, error):
    """The board with the error, as a library in ``folder``."""
    board = folder / "coil_board"
    for part in ("src", "host"):
        shutil.copytree(BOARD / part, board / part)
    source = board / "src" / error.file
    text = source.read_text()
    assert text.count(error.old) == 1, f"{error.file}: {text.count(error.old)} times {error.old!r}"
    source.write_text(text.replace(error.old, error.new))
    return compile_board(folder, limits_header(**dict(error.limits)), board, strict=False)


GUARD, COIL_BOARD, MESSAGES, FRAME, READ_BACK = (
    "guard.c",
    "coil_board.c",
    "messages.c",
    "frame.c",
    "read_back.c",
)
OTHER = (("tick_hz", 3), ("pulse_ms", 1200), ("backoff_ms", 3900), ("deadman_ms", 2000))
PER_COIL = (("shared", 0),)

PLANTED = {
    # the timers
    "a restart locks out for none": Planted(
        GUARD, "timers->lockout[coil] = BACKOFF_UNITS;", "timers->lockout[coil] = 0U;", "boot"
    ),
    "a restart locks out for 1 % less": Planted(
        GUARD,
        "timers->lockout[coil] = BACKOFF_UNITS;",
        "timers->lockout[coil] = BACKOFF_UNITS - (BACKOFF_UNITS / 100U);",
        "boot",
    ),
    "a restart leaves the pulse on": Planted(
        GUARD, "{\n    timers->remaining = 0U;", "{", "restart_in_a_pulse"
    ),
    "the back-off counts from the start of the pulse": Planted(
        GUARD, "timers->remaining + BACKOFF_UNITS", "BACKOFF_UNITS", "back_off"
    ),
    "a pulse locks out for its own length": Planted(
        GUARD, "timers->remaining + BACKOFF_UNITS", "timers->remaining", "back_off"
    ),
    "a pulse locks out its own coil alone": Planted(GUARD, "(LIMITS_SHARED == 1) || ", "", "back_off"),
    "a pulse locks out the others too": Planted(
        GUARD, "(LIMITS_SHARED == 1) || (coil == request->coil)", "coil < COILS", "back_off", PER_COIL
    ),
    "a pulse is a tick too long": Planted(
        GUARD,
        "timers->remaining = request->duration_ms * UNITS_PER_MS;",
        "timers->remaining = (request->duration_ms * UNITS_PER_MS) + UNITS_PER_TICK;",
        "back_off",
    ),
    "milliseconds are taken for units": Planted(
        GUARD,
        "timers->remaining = request->duration_ms * UNITS_PER_MS;",
        "timers->remaining = request->duration_ms;",
        "back_off",
        OTHER,
    ),
    "a second coil is let on": Planted(GUARD, "if (timers->remaining > 0U) {", "if (false) {", "back_off"),
    "the back-off is not judged": Planted(
        GUARD, "} else if (timers->lockout[coil] > 0U) {", "} else if (false) {", "boot_lockout"
    ),
    "the back-off of coil 0 is judged for all": Planted(
        GUARD,
        "} else if (timers->lockout[coil] > 0U) {",
        "} else if ((coil < COILS) && (timers->lockout[0] > 0U)) {",
        "back_off",
        PER_COIL,
    ),
    "lockout_ms is rounded down": Planted(
        GUARD,
        "return divided_up(left, UNITS_PER_MS * LOCKOUT_STEP_MS) * LOCKOUT_STEP_MS;",
        "return (left / (UNITS_PER_MS * LOCKOUT_STEP_MS)) * LOCKOUT_STEP_MS;",
        "boot_lockout",
        (("tick_hz", 3), ("pulse_ms", 1200), ("backoff_ms", 3669)),
    ),
    # ticks and clock
    "its own clock does not judge requests": Planted(
        GUARD,
        "reason = judge_timers(&state->by_clock, request->coil);",
        "reason = judge_timers(&state->by_ticks, request->coil);",
        "held_tick",
    ),
    "ticks do not judge requests": Planted(
        GUARD,
        "reason = judge_timers(&state->by_ticks, request->coil);",
        "reason = judge_timers(&state->by_clock, request->coil);",
        "boot_lockout",
    ),
    "its own clock counts ticks": Planted(
        GUARD,
        "    elapse(&state->by_ticks, UNITS_PER_TICK);",
        "    elapse(&state->by_ticks, UNITS_PER_TICK);\n    elapse(&state->by_clock, UNITS_PER_TICK);",
        "own_clock",
    ),
    "its own clock ends no pulse in the status": Planted(
        GUARD,
        "smaller(state->by_ticks.remaining, state->by_clock.remaining)",
        "smaller(state->by_ticks.remaining, UINT32_MAX)",
        "held_tick",
    ),
    "its own clock ends the pulse in the status alone": Planted(
        GUARD,
        "|| state->tick_under_way) && (state->by_clock.remaining > 0U);",
        "|| state->tick_under_way);",
        "held_tick",
    ),
    "lockout_ms is that of the ticks": Planted(
        GUARD,
        "larger(state->by_ticks.lockout[coil], state->by_clock.lockout[coil])",
        "larger(state->by_ticks.lockout[coil], 0U)",
        "own_clock",
    ),
    "lockout_ms is that of the clock": Planted(
        GUARD,
        "larger(state->by_ticks.lockout[coil], state->by_clock.lockout[coil])",
        "larger(0U, state->by_clock.lockout[coil])",
        "boot_lockout",
    ),
    "the dead-man leaves the clock's timers alone": Planted(
        GUARD,
        "    lock_out(&state->by_clock);\n    state->coil = 0U;",
        "    state->coil = 0U;",
        "own_clock",
    ),
    # requests
    "a late request is taken": Planted(
        GUARD, "if (request->tick != (tick & 0xFFU)) {", "if (request->tick > 0xFFU) {", "refusals"
    ),
    "seven bits of the tick are compared": Planted(
        GUARD, "request->tick != (tick & 0xFFU)", "request->tick != (tick & 0x7FU)", "back_off"
    ),
    "a repeated request is taken": Planted(
        GUARD, "state->has_seq && (request->seq == state->seq)", "false", "refusals"
    ),
    "seq 0 is taken for a repeated one after boot": Planted(
        GUARD,
        "state->has_seq && (request->seq == state->seq)",
        "request->seq == state->seq",
        "restart_in_a_pulse",
    ),
    "a restart remembers the last seq": Planted(
        GUARD, "    state->has_seq = false;\n    state->seq = 0U;\n", "", "restart_in_a_pulse"
    ),
    "the dead-man forgets the last seq": Planted(
        GUARD,
        "    state->silent = true;",
        "    state->has_seq = false;\n    state->silent = true;",
        "dead_man_in_a_pulse",
    ),
    "there is a coil 3": Planted(GUARD, "request->coil >= COILS", "request->coil > COILS", "refusals"),
    "level 4 is driven": Planted(GUARD, "request->level > LEVEL_MOST", "request->level > 4", "refusals"),
    "level -8 is driven": Planted(GUARD, "(request->level < -LEVEL_MOST) || ", "", "refusals"),
    "level 0 is driven": Planted(GUARD, "(request->level == 0) || ", "", "refusals"),
    "a pulse of 0 ms is driven": Planted(GUARD, "(request->duration_ms == 0U) || ", "", "refusals"),
    "the longest pulse is a millisecond longer": Planted(
        GUARD,
        "request->duration_ms > LIMITS_PULSE_MS",
        "request->duration_ms > (LIMITS_PULSE_MS + 1U)",
        "refusals",
    ),
    "the longest pulse is refused": Planted(
        GUARD,
        "request->duration_ms > LIMITS_PULSE_MS",
        "request->duration_ms >= LIMITS_PULSE_MS",
        "boot_lockout",
    ),
    "a broken request is taken": Planted(
        FRAME, "intact = (frame->data[frame->length - 1U] == crc_of(frame));", "intact = true;", "refusals"
    ),
    "a request of another length is taken": Planted(
        FRAME, "(shape != NULL) && (frame->length == shape->length)", "shape != NULL", "noise"
    ),
    "flags are masked away": Planted(
        COIL_BOARD,
        "    coil_board_pass_time(board, now_ms);\n    if (!frame_is_intact(frame)) {",
        "    bus_frame plain = *frame;\n    plain.can_id &= 0x7FFU;\n    frame = &plain;\n"
        "    coil_board_pass_time(board, now_ms);\n    if (!frame_is_intact(frame)) {",
        "refusals",
    ),
    "a request too short to be named is refused": Planted(
        COIL_BOARD, "(frame->length >= COIL_FIRE_NAMED_BYTES)", "(frame->length >= 1U)", "refusals"
    ),
    "duration_ms is big-endian": Planted(
        MESSAGES,
        "(uint32_t)bytes[4] | ((uint32_t)bytes[5] << 8U)",
        "(uint32_t)bytes[5] | ((uint32_t)bytes[4] << 8U)",
        "boot_lockout",
    ),
    "the level has no sign": Planted(MESSAGES, "((int32_t)nibble - 16)", "(int32_t)nibble", "boot_lockout"),
    "a flood of requests is answered by a flood": Planted(
        COIL_BOARD,
        "if (board->refusal_count < REFUSALS_MOST) {",
        "if (board->refusal_count < (REFUSALS_MOST - 1U)) {",
        "flood",
    ),
    # what it sends
    "a level is reported for ever": Planted(
        GUARD,
        "state->level = state->driven ? state->pulse_level : 0;",
        "state->level = state->pulse_level;",
        "back_off",
    ),
    "all off, coil 0 is reported": Planted(
        COIL_BOARD, "(uint8_t)(board->tick % COILS)", "(uint8_t)0U", "boot"
    ),
    "the last seq is not reported": Planted(
        COIL_BOARD, "status.seq = coils->seq;", "status.seq = 0U;", "boot_lockout"
    ),
    "the sign of the current is lost": Planted(
        MESSAGES, "(uint32_t)current & 0xFFFU", "(uint32_t)current & 0x7FFU", "back_off"
    ),
    "refusals bear the tick in which they are reported": Planted(
        MESSAGES,
        "frame.data[3] = refusal->tick;",
        "frame.data[3] = (uint8_t)(refusal->tick + 1U);",
        "refusals",
    ),
    "statuses are not counted": Planted(COIL_BOARD, "    board->status_counter++;\n", "", "all_along"),
    "refusals are not counted": Planted(COIL_BOARD, "        board->refusal_counter++;\n", "", "all_along"),
    "events are not counted": Planted(COIL_BOARD, "    board->event_counter++;\n", "", "all_along"),
    "heartbeats are not counted": Planted(
        COIL_BOARD, "        board->heartbeat_counter++;\n", "", "all_along"
    ),
    "a heartbeat comes every 59 s": Planted(
        COIL_BOARD, "(60U * LIMITS_TICK_HZ)", "(59U * LIMITS_TICK_HZ)", "heartbeats"
    ),
    "the heartbeat tells no rejects": Planted(
        COIL_BOARD, "    board->rejects = one_more(board->rejects);\n", "", "heartbeats"
    ),
    "the heartbeat is always ready": Planted(
        COIL_BOARD, "        state = STATE_LOCKED_OUT;", "        state = STATE_READY;", "heartbeats"
    ),
    "the heartbeat bears eight bits of the tick": Planted(
        MESSAGES, "put(&frame, 5U, 2U, tick);", "put(&frame, 5U, 1U, tick);", "heartbeats"
    ),
    "the boot message is of another contract": Planted(
        MESSAGES, "#define CONTRACT_VERSION 1U", "#define CONTRACT_VERSION 2U", "boot"
    ),
    # the count of ticks, and the dead-man
    "the tick has 16 bits": Planted(
        COIL_BOARD,
        "    board->tick++;",
        "    board->tick = (board->tick + 1U) & 0xFFFFU;",
        "all_along",
    ),
    "PLANT_BOOT restarts it in tick 0 too": Planted(
        COIL_BOARD,
        "(frame->can_id == PLANT_BOOT_ID) && (board->tick > 0U)",
        "frame->can_id == PLANT_BOOT_ID",
        "boot",
    ),
    "PLANT_BOOT is not heard": Planted(COIL_BOARD, "(board->tick > 0U)", "false", "boot"),
    "one strange SYNC restarts it": Planted(
        COIL_BOARD, "had_strange && ((tick == strange) || follows(strange, tick))", "true", "noise"
    ),
    "two strange SYNCs of one tick are not believed": Planted(
        COIL_BOARD,
        "had_strange && ((tick == strange) || follows(strange, tick))",
        "had_strange && follows(strange, tick)",
        "lost_count",
    ),
    "a good SYNC does not end a row of strange ones": Planted(
        COIL_BOARD,
        "    board->has_strange = false;\n    if ((tick == board->tick)",
        "    if ((tick == board->tick)",
        "lost_count",
    ),
    "there is no dead-man": Planted(COIL_BOARD, "(LIMITS_DEADMAN_MS > 0U) && ", "false && ", "dead_man"),
    "the dead-man wakes a tenth late": Planted(
        COIL_BOARD,
        "board->since_sync_ms > LIMITS_DEADMAN_MS",
        "board->since_sync_ms > (LIMITS_DEADMAN_MS + (LIMITS_DEADMAN_MS / 10U))",
        "dead_man",
    ),
    "the dead-man locks out once, when it wakes": Planted(
        COIL_BOARD,
        "(board->since_sync_ms > LIMITS_DEADMAN_MS)",
        "(board->since_sync_ms > LIMITS_DEADMAN_MS) && !board->silenced",
        "own_clock",
    ),
    "the dead-man is told again and again": Planted(
        COIL_BOARD, "        board->silenced = false;\n", "", "dead_man_in_a_pulse"
    ),
    "the dead-man is not told": Planted(
        COIL_BOARD, "        report_event(board, DEAD_MAN, 0, out);\n", "", "dead_man"
    ),
    "a SYNC that repeats its tick feeds the dead-man": Planted(
        COIL_BOARD, "(!board->has_synced) || (tick != board->synced_tick)", "true", "repeated_tick"
    ),
    "any frame feeds the dead-man": Planted(
        COIL_BOARD,
        "    } else if (frame->can_id == TICK_DONE_ID) {",
        "    } else if (frame->can_id == TICK_DONE_ID) {\n        board->since_sync_ms = 0U;",
        "repeated_tick",
    ),
    "a self-test takes no current for one": Planted(
        READ_BACK,
        "(10 * size_of(current)) > NOMINAL_MA[1]",
        "(10 * size_of(current)) >= 0 * NOMINAL_MA[1]",
        "boot",
    ),
}

UNSEEN = {
    "the outputs go off when the last tick of a pulse is entered": Planted(
        GUARD, "state->tick_under_way = guard_is_on(state);", "state->tick_under_way = false;", ""
    ),
    "a pulse goes on when the last tick is over": Planted(
        GUARD,
        "void guard_sync(guard *state)\n{\n    state->tick_under_way = false;",
        "void guard_sync(guard *state)\n{",
        "",
    ),
    "the clock may not wrap": Planted(
        GUARD, "if (elapsed_ms < CLOCK_BACKWARDS) {", "if (clock_ms >= state->clock_ms) {", ""
    ),
    "a current may be off by a third": Planted(
        READ_BACK,
        "if ((5 * size_of(forward_ma - nominal_ma)) <= nominal_ma) {",
        "if ((3 * size_of(forward_ma - nominal_ma)) <= nominal_ma) {",
        "",
    ),
    "a reversed current is taken for none": Planted(
        READ_BACK, "if ((10 * forward_ma) < -nominal_ma) {", "if (forward_ma < (-2 * nominal_ma)) {", ""
    ),
    "a current that flows while all is off lets requests through": Planted(
        COIL_BOARD, "    if (!is_shorted(board)) {", "    if (board->tick <= UINT32_MAX) {", ""
    ),
}
"""What no bus shows, or only in weeks, or with a fault of the coils: found beside the stub alone."""
