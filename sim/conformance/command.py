"""``torquer hil --conformance``: one board, checked over its bus.

The table of checks of a board against docs/icd.md, the same for a stub and for real hardware, and its run.

The checks are run in order, in real time, and talk to the board over the bus alone. Those that ask for a
pulse are run only when the flight software is armed.
"""

import time
from collections.abc import Callable
from functools import partial
from math import ceil
from typing import NamedTuple

from fsw.bus.open_bus import open_bus, resolve
from fsw.wire.messages import CoilStatus, TickDone
from sim.conformance import checks
from sim.conformance.board_link import BOARD_KINDS, BoardLink, NonconformanceError, TickReply
from sim.conformance.board_under_test import BoardLimits, BoardUnderTest
from sim.conformance.checks import check_replies, expect_dead_man, wake_dead_man
from sim.conformance.pauses import PauseWatch
from sim.console import answer, say
from sim.errors import HarnessError
from sim.scenario.assemble import coil_limits
from sim.scenario.schema import Scenario

# --- The checks of a board's clock and count of ticks: ticks held, repeated, in a burst, backwards

LAST_TICK = 2**32 - 1
SPEED_UP = 4.0
"""How many times too fast ticks come that come too fast."""
BURST_S = 0.01
"""From tick to tick in a burst; at most a tenth of a tick."""
SLACK_MS = 20.0
"""Tolerance for a board's own clock over some seconds, and for the way to it."""


def lost_count(board: BoardUnderTest) -> None:
    """Two strange SYNCs in a row, of one tick or of one and the next, restart it; ahead or backwards."""
    link = board.link
    for _ in range(4):
        link.step()
    for first, second in ((1000, 1001), (1000, 1000), (2**31, 2**31 + 1), (-3, -2), (-3, -3)):
        now = link.tick
        _send_unexpected_sync(link, now + first)
        link.step()  # a good one between them: they are not in a row
        _send_unexpected_sync(link, now + second + 1)
        link.step()
        now = link.tick
        _send_unexpected_sync(link, now + first)
        reply = link.sync(now + second)
        if not reply.only(link.kind.boot):
            raise NonconformanceError(
                f"two strange SYNCs, {first:+} and {second:+} ticks off: it did not restart"
            )
        link.tick = now + second
        if link.kind.sample is CoilStatus:
            board.expect_lockout(reply)
        for _ in range(4):
            link.step()


def last_tick(board: BoardUnderTest) -> None:
    """The count ends at tick 4294967295: no tick follows, and a SYNC(0) after it is strange."""
    link = board.link
    _send_unexpected_sync(link, LAST_TICK - 1)
    if not link.sync(LAST_TICK - 1).only(link.kind.boot):
        raise NonconformanceError(f"two SYNC of tick {LAST_TICK - 1}: it did not restart in that tick")
    if not link.sync(LAST_TICK - 1, frames=[TickDone(LAST_TICK - 1, 0).encode()]).only(link.kind.sample):
        raise NonconformanceError(f"it did not enter tick {LAST_TICK} after TICK_DONE({LAST_TICK - 1})")
    if link.sync(LAST_TICK, frames=[TickDone(LAST_TICK, 0).encode()]).messages:
        raise NonconformanceError(f"it entered a tick after TICK_DONE({LAST_TICK}), which is the last")
    if link.sync(0, frames=[TickDone(0, 0).encode()]).messages:
        raise NonconformanceError(f"it took SYNC(0) for the tick after {LAST_TICK}: the count does not wrap")
    if not link.sync(0).only(link.kind.boot):
        raise NonconformanceError(f"two SYNC of tick 0 after tick {LAST_TICK}: it did not restart")
    link.tick = 0


def _send_unexpected_sync(link: BoardLink, tick: int) -> None:
    if link.sync(tick).messages:
        raise NonconformanceError("one strange SYNC alone made it answer")


def repeated_tick(board: BoardUnderTest) -> None:
    """A SYNC that only repeats its tick, and an old TICK_DONE, keep no board awake: the dead-man wakes."""
    link = board.link
    link.step()
    since_s, silent_s = link.clock(), 1.5 * board.limits.deadman_s + link.period_s
    while link.clock() - since_s < silent_s:
        if link.sync(link.tick, frames=[TickDone(link.tick - 1, 0).encode()]).messages:
            raise NonconformanceError("a SYNC that repeats its tick, or an old TICK_DONE, made it answer")
    expect_dead_man(board, f"only a SYNC that repeats its tick for {silent_s:g} s")


def own_clock(board: BoardUnderTest) -> None:
    """Ticks that come four times too fast do not shorten a lockout, of the dead-man or of a restart."""
    for begin in (wake_dead_man, lambda board: board.link.restart()):
        since = begin(board)
        _rush(board, since)
    board.link.restart()


def _rush(board: BoardUnderTest, since: TickReply) -> None:
    """Ticks that come too fast in a lockout that began with the SYNC of that reply."""
    link = board.link
    seconds = min(10.0, board.limits.backoff_ms / 8000.0)
    reply = since
    for _ in range(ceil(seconds * link.tick_hz * SPEED_UP)):
        reply = link.step(early_s=link.period_s / SPEED_UP)
    _expect_locked_out(board, reply, board.limits.backoff_ms - 1000.0 * (link.clock() - since.at_s))


def held_tick(board: BoardUnderTest) -> None:
    """A tick is held and a request comes late in it, then ticks in a rush: its back-off runs from then on.

    And a pulse in a tick that is held ends by time.
    """
    board.wait_until_free()
    link, limits = board.link, board.limits
    held_s = board.longest_hold_s()
    link.sync(link.tick, held_s)
    # longer than the ticks that follow, but over before more of them come: those would end it by their count
    most_ms = int(1000.0 * (link.period_s + held_s) - 2.0 * SLACK_MS)
    duration_ms = min(limits.pulse_ms, ceil(2.1 * board.tick_ms), most_ms)
    request, reply = board.expect_accepted(duration_ms=duration_ms)
    from_s = reply.at_s  # before it was sent: the tester may be held up after it
    driven_ma = reply.status.current_ma
    link.sync(link.tick, held_s)
    reply = link.step()
    if reply.status.remaining_ms or abs(reply.status.current_ma) * 5 > abs(driven_ma):
        raise NonconformanceError(f"a pulse of {duration_ms} ms goes on in a tick that is held for longer")
    burst_s = min(BURST_S, link.period_s / 10.0)
    for _ in range(ceil((limits.pulse_ms + limits.backoff_ms) / board.tick_ms) + 3):
        reply = link.step(early_s=burst_s)
    while reply.tick % 3 != request.coil:  # the tick that reports its back-off
        reply = link.step(early_s=burst_s)
    left_ms = duration_ms + limits.backoff_ms - 1000.0 * (link.clock() - from_s)
    if left_ms > SLACK_MS:
        _expect_locked_out(board, reply, left_ms)
        if not board.send(board.request()).refused:
            raise NonconformanceError(f"accepted {left_ms:.0f} ms before the end of its back-off")


def _expect_locked_out(board: BoardUnderTest, reply: TickReply, least_ms: float) -> None:
    lockout_ms = reply.status.lockout_ms
    if lockout_ms < least_ms - SLACK_MS:
        raise NonconformanceError(
            f"lockout_ms fell to {lockout_ms}, though by the clock {least_ms:.0f} are left"
        )


class Check(NamedTuple):
    """One check; ``power``: it asks for pulses; ``coil``: it is of the coil driver alone."""

    run: Callable[[BoardUnderTest], None]
    power: bool = False
    coil: bool = True


CHECKS = (
    Check(checks.boot, coil=False),
    Check(checks.noise, coil=False),
    Check(checks.boot_lockout, power=True),
    Check(checks.back_off, power=True),
    Check(checks.dead_man_in_a_pulse, power=True),
    Check(checks.refusals, power=True),
    Check(checks.flood, power=True),
    Check(checks.restart_in_a_pulse, power=True),
    Check(checks.dead_man),
    Check(lost_count, coil=False),
    Check(last_tick, coil=False),
    Check(repeated_tick),
    Check(own_clock),
    Check(held_tick, power=True),
    Check(checks.heartbeats, coil=False),
    Check(checks.all_along, coil=False),
)


class CheckResult(NamedTuple):
    """The result of a check. ``failure`` None: kept; ``ran`` False: it needs power and nothing is armed.

    ``repeated``: how often it was run again, for this computer stood still while it failed.
    """

    name: str
    what: str
    ran: bool
    failure: str | None = None
    repeated: int = 0

    @property
    def times_run(self) -> str:
        """How often it was run, for what follows its text; empty where once."""
        return f" (run {self.repeated + 1} times, as this computer stood still)" if self.repeated else ""


MOST_REPEATED = 3
MOST_PAUSE_S = 0.05
"""A frame passes several processes within a tick, each of which may wait for so long."""
SWITCH_ON_S = 5.0
"""A board that has just been plugged in answers within that time."""


def run_checks(
    link: BoardLink,
    limits: BoardLimits,
    armed: bool,
    report: Callable[[CheckResult], None] = lambda result: None,
    paused_s: Callable[[], float] = lambda: 0.0,
) -> list[CheckResult]:
    """Run every check that fits the board, each in its turn.

    Args:
        link: to the board.
        limits: that it is set to.
        armed: whether it may drive its coils.
        report: receives each result.
        paused_s: the longest time for which this computer stood still since it was last asked.

    Raises:
        HarnessError: no board answers, or another node sends SYNC.
    """
    _await_board(link)
    board = BoardUnderTest(link, limits)
    results = []
    for check in CHECKS:
        if check.coil and link.kind.sample is not CoilStatus:
            continue
        what = " ".join((check.run.__doc__ or "").split())
        result = CheckResult(check.run.__name__, what, ran=armed or not check.power)
        if result.ran:
            failure, repeated = _failure(check, board, paused_s)
            result = result._replace(failure=failure, repeated=repeated)
            if repeated:
                board = BoardUnderTest(link, limits)  # it was restarted
        if not any(reply.messages for reply in link.replies):
            raise HarnessError(f"no {link.kind.node} board answers on this bus")
        report(result)
        results.append(result)
    return results


def _await_board(link: BoardLink) -> None:
    """Let a board that is just being switched on come up: its boot must not be taken for an answer."""
    for _ in range(ceil(SWITCH_ON_S * link.tick_hz / 2.0)):
        link.restart()
        if link.step().messages:
            break
    link.replies.clear()


def _failure(check: Check, board: BoardUnderTest, paused_s: Callable[[], float]) -> tuple[str | None, int]:
    """Why a check fails, and how often it was run again; what this computer has disturbed proves nothing."""
    link = board.link
    for repeated in range(MOST_REPEATED + 1):
        first = len(link.replies)
        paused_s()
        failure = _raised(partial(check.run, board))
        flawed = failure or _raised(partial(check_replies, link.replies[first:], link.kind))
        if not flawed or paused_s() <= MOST_PAUSE_S or repeated == MOST_REPEATED:
            break
        _boot_again(link, first)
        board = BoardUnderTest(link, board.limits)
    return failure, repeated


def _raised(run: Callable[[], None]) -> str | None:
    try:
        run()
    except NonconformanceError as error:
        return str(error)
    return None


def _boot_again(link: BoardLink, first: int) -> None:
    """Restart the board, in whatever tick it is, and forget the replies from ``first`` on."""
    while not link.restart().only(link.kind.boot) and len(link.replies) < first + 6:
        link.step()
    del link.replies[first:-1]


# --- The command

LEAST_DEADMAN_TICKS = 2
"""A tick is held for part of the dead-man, and may be late."""

_MARKS = {True: "ok    ", False: "FAILED"}


def conformance(scenario: Scenario, kind: str, bus: str, armed: bool, deadman_s: float) -> int:
    """Check the board of ``kind`` on ``bus`` against docs/icd.md, its limits being those of the scenario.

    Raises:
        BusError: the bus cannot be used.
        HarnessError: no board answers, another node sends SYNC, the scenario's coil board is another one, or
            its dead-man is too short.
    """
    if kind == "coil" and scenario.coils.driver == "continuous":
        raise HarnessError(
            f"{scenario.name}: coils.driver: the board is a continuous driver; the checks are of a pulsed one"
        )
    tick_hz = scenario.time.tick_hz
    if kind == "coil" and deadman_s * tick_hz < LEAST_DEADMAN_TICKS:
        raise HarnessError(
            f"--deadman-s {deadman_s:g}: at {tick_hz} Hz the checks need at least "
            f"{LEAST_DEADMAN_TICKS / tick_hz:g} s, as a SYNC that is late would wake a shorter one"
        )
    board = coil_limits(scenario.coils, tick_hz)
    limits = BoardLimits(board.pulse_ms, board.backoff_ms, board.shared, deadman_s)
    spec = resolve(bus)
    can_bus = open_bus(spec)
    say(f"{kind} on {spec}, {tick_hz} Hz, {_limits_text(limits)}")
    began = time.monotonic()
    try:
        with PauseWatch() as watch:
            link = BoardLink(can_bus, BOARD_KINDS[kind], tick_hz)
            results = run_checks(link, limits, armed, _say, watch.take_longest_s)
    finally:
        can_bus.close()
    failed = [result for result in results if result.failure]
    unarmed = [result for result in results if not result.ran]
    skipped = f", {len(unarmed)} not run: they drive coils and need --arm" if unarmed else ""
    say(f"{len(results) - len(failed) - len(unarmed)} kept, {len(failed)} failed{skipped}")
    checks = [result._asdict() for result in results]
    answer({"board": kind, "bus": spec, "seconds": time.monotonic() - began, "checks": checks})
    return int(bool(failed))


def _limits_text(limits: BoardLimits) -> str:
    scope = "shared" if limits.shared else "per coil"
    return (
        f"pulses up to {limits.pulse_ms / 1000.0:g} s, back-off {limits.backoff_ms / 1000.0:g} s ({scope}), "
        f"dead-man {limits.deadman_s:g} s"
    )


def _say(result: CheckResult) -> None:
    mark = _MARKS[result.failure is None] if result.ran else "not run"
    text = f"{result.failure or result.what}{result.times_run}"
    say(f"{mark:<8}{result.name:<20} {text}", failed=bool(result.failure))
