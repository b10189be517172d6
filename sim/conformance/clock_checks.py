"""The checks of a board's clock and count of ticks: ticks held, repeated, in a burst, backwards."""

from math import ceil

from fsw.wire.messages import CoilStatus
from sim.conformance.board_link import BoardLink, NonconformanceError, TickReply
from sim.conformance.board_under_test import BoardUnderTest
from sim.conformance.checks import expect_dead_man

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
    for first, second in ((1000, 1001), (1000, 1000), (-3, -2), (-3, -3)):
        now = link.tick
        _strange(link, now + first)
        link.step()  # a good one between them: they are not in a row
        _strange(link, now + second + 1)
        link.step()
        now = link.tick
        _strange(link, now + first)
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


def _strange(link: BoardLink, tick: int) -> None:
    if link.sync(tick).messages:
        raise NonconformanceError("one strange SYNC alone made it answer")


def repeated_tick(board: BoardUnderTest) -> None:
    """A SYNC that only repeats the tick of the last keeps no board awake: the dead-man wakes."""
    link = board.link
    link.step()
    since_s, silent_s = link.clock(), 1.5 * board.limits.deadman_s + link.period_s
    while link.clock() - since_s < silent_s:
        if link.sync(link.tick).messages:
            raise NonconformanceError("a SYNC that repeats its tick made it answer")
    expect_dead_man(board, f"only a SYNC that repeats its tick for {silent_s:g} s")


def own_clock(board: BoardUnderTest) -> None:
    """Ticks that come four times too fast do not shorten a lockout."""
    link = board.link
    since = link.restart()
    since_s, seconds = since.at_s, min(10.0, board.limits.backoff_ms / 8000.0)
    reply = since
    for _ in range(ceil(seconds * link.tick_hz * SPEED_UP)):
        reply = link.step(early_s=link.period_s / SPEED_UP)
    _expect_locked_out(board, reply, board.limits.backoff_ms - 1000.0 * (link.clock() - since_s))
    link.restart()


def held_tick(board: BoardUnderTest) -> None:
    """A tick is held and a request comes late in it, then ticks in a rush: its back-off runs from then on.

    And a pulse in a tick that is held ends by time.
    """
    board.wait_until_free()
    link, limits = board.link, board.limits
    # for so long and a tick no SYNC goes on in the count: that has to be short of the dead-man
    held_s = max(limits.deadman_s - 2.5 * link.period_s, (limits.deadman_s - link.period_s) / 2.0)
    link.sync(link.tick, held_s)
    # longer than the ticks that follow, but over before more of them come: those would end it by their count
    most_ms = int(1000.0 * (link.period_s + held_s) - 2.0 * SLACK_MS)
    duration_ms = min(limits.pulse_ms, ceil(2.1 * board.tick_ms), most_ms)
    request, reply = board.expect_accepted(duration_ms=duration_ms)
    from_s = reply.at_s  # before it was sent: the tester may be held up after it
    link.sync(link.tick, held_s)
    reply = link.step()
    if reply.status.remaining_ms:
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
