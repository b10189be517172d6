"""The checks of a board's clock and count of ticks: ticks held, repeated, in a rush, backwards."""

from math import ceil

from fsw.wire.messages import CoilStatus
from sim.conformance.checks import silenced
from sim.conformance.session import BrokenError, Heard, Session
from sim.conformance.subject import Subject

FAST = 4.0
"""Ticks that come too fast come so many times too fast."""
RUSH_S = 0.01
"""From tick to tick in a rush, or a tenth of a tick."""
SLACK_MS = 20.0
"""What is allowed to a board's own clock over some seconds, and to the way to it."""


def lost_count(subject: Subject) -> None:
    """Two strange SYNCs in a row, of one tick or of one and the next, restart it; ahead or backwards."""
    session = subject.session
    for _ in range(4):
        session.step()
    for first, second in ((1000, 1001), (1000, 1000), (-3, -2), (-3, -3)):
        now = session.tick
        _strange(session, now + first)
        session.step()  # a good one between them: the row is over
        _strange(session, now + second + 1)
        session.step()
        now = session.tick
        _strange(session, now + first)
        heard = session.sync(now + second)
        if not heard.only(session.kind.boot):
            raise BrokenError(f"two strange SYNCs, {first:+} and {second:+} ticks off: it did not restart")
        session.tick = now + second
        if session.kind.sample is CoilStatus:
            subject.locked_out(heard)
        for _ in range(4):
            session.step()


def _strange(session: Session, tick: int) -> None:
    if session.sync(tick).messages:
        raise BrokenError("one strange SYNC alone moved it")


def repeated_tick(subject: Subject) -> None:
    """A SYNC that only repeats the tick of the last keeps no board awake: the dead-man wakes."""
    session = subject.session
    session.step()
    since_s = session.clock()
    while session.clock() - since_s < 1.5 * subject.limits.deadman_s + session.period_s:
        if session.sync(session.tick).messages:
            raise BrokenError("a SYNC that repeats its tick moved it")
    silenced(subject, "only a SYNC that repeats its tick")


def own_clock(subject: Subject) -> None:
    """Ticks that come four times too fast do not shorten a lockout."""
    session = subject.session
    since = session.restart()
    since_s, seconds = since.at_s, min(10.0, subject.limits.backoff_ms / 8000.0)
    heard = since
    for _ in range(ceil(seconds * session.tick_hz * FAST)):
        heard = session.step(early_s=session.period_s / FAST)
    _still_locked_out(subject, heard, subject.limits.backoff_ms - 1000.0 * (session.clock() - since_s))
    session.restart()


def held_tick(subject: Subject) -> None:
    """A tick is held and a request comes late in it, then ticks in a rush: its back-off runs from then on.

    And a pulse in a tick that is held ends by time.
    """
    subject.free()
    session, limits = subject.session, subject.limits
    longest_s = limits.deadman_s - 2.5 * session.period_s  # so that the next tick does not find it silent
    _hold(session, longest_s)
    duration_ms = min(limits.pulse_ms, ceil(2.1 * subject.tick_ms))  # more than the ticks that it will hear
    asked, heard = subject.accept(duration_ms=duration_ms)
    from_s = session.clock() - session.period_s
    if duration_ms + SLACK_MS < 1000.0 * (session.period_s + longest_s):
        _hold(session, longest_s)
        heard = session.step()
        if heard.status.remaining_ms:
            raise BrokenError(f"a pulse of {duration_ms} ms goes on in a tick that is held for longer")
    rush_s = min(RUSH_S, session.period_s / 10.0)
    for _ in range(ceil((limits.pulse_ms + limits.backoff_ms) / subject.tick_ms) + 3):
        heard = session.step(early_s=rush_s)
    while heard.tick % 3 != asked.coil:  # the tick that tells of its back-off
        heard = session.step(early_s=rush_s)
    left_ms = duration_ms + limits.backoff_ms - 1000.0 * (session.clock() - from_s)
    if left_ms > SLACK_MS:
        _still_locked_out(subject, heard, left_ms)
        if not subject.ask(subject.fire()).refused:
            raise BrokenError(f"accepted {left_ms:.0f} ms before the end of its back-off")


def _hold(session: Session, seconds: float) -> None:
    """One SYNC, and nothing after it: for a tick at least."""
    session.sync(session.tick)
    session.silence(max(0.0, seconds - session.period_s))


def _still_locked_out(subject: Subject, heard: Heard, least_ms: float) -> None:
    told_ms = heard.status.lockout_ms
    if told_ms < least_ms - SLACK_MS:
        raise BrokenError(f"lockout_ms fell to {told_ms}, and not even to {least_ms:.0f} by the clock")
