"""Proof of the guard by exhaustion: time and ticks are two things that need not agree.

From every state that can be reached time passes without a tick, ticks come in no time, one or several, with
their SYNC or without, every request is made, the board restarts, and the dead-man wakes. A judge that is told
of time alone demands invariant I over it, and that a request is accepted if and only if both interlocks
accept it. That it has teeth is shown by guards with a planted bug: each must be found.

The constants are small so that the search ends; no rule depends on them.
"""

import copy
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import product
from typing import NamedTuple

import pytest
from compiled_guard import interpreted_alone
from interlocks import numbers_of

from fsw.wire.messages import CoilFire
from hil_stub.coils import interlock
from hil_stub.coils.guard import CLOCK_HZ, Guard
from hil_stub.coils.interlock import CoilLimits

pytestmark = interpreted_alone()

TICK = 300
JUMPS_MS = (500, 2500)
TICKS = (1, 3)
REQUESTS = {  # by kind of back-off
    True: [
        CoilFire(2, coil, seq, TICK & 0xFF, ms) for coil, ms, seq in product((0, 1), (1000, 1500), (0, 1))
    ],
    False: [CoilFire(2, coil, seq, TICK & 0xFF, 1000) for coil, seq in product((0, 1), (0, 1))],
}
LIMITS = {
    "shared": CoilLimits(1, 1500, 2000, shared=True),
    "per coil": CoilLimits(1, 1000, 1000, shared=False),
}
NONE = {
    "none, shared": CoilLimits(1, 1500, 0, shared=True),
    "none, per coil": CoilLimits(1, 1000, 0, shared=False),
}
"""By back-off. At 1 Hz pulses and back-offs are some ticks, and some steps of half a second."""


class Judge(NamedTuple):
    """Stopwatches of true time [ms], stopped at the limit they are for; what was before boot is not known."""

    limits: CoilLimits
    on: int | None = None
    length: int = 0
    since_end: tuple[int, int, int] = (10_000,) * 3
    silent: bool = False  # the dead-man has woken, and no SYNC has come since

    def watch(self, coil: int | None, driven_ms: int, span_ms: int) -> "Judge":
        """``coil`` was on for the first ``driven_ms`` of ``span_ms``, then nothing."""
        limits, on, length, since_end = self.limits, self.on, self.length, list(self.since_end)
        if driven_ms:
            if on is None:
                waited_ms = min(since_end) if limits.shared else since_end[coil]
                assert waited_ms >= limits.backoff_ms, f"{waited_ms} ms from a pulse to the next"
                on, length = coil, 0
            assert on == coil, "one coil went on as the other"
            length += driven_ms
            assert length <= limits.pulse_ms, f"a pulse of {length} ms"
        since_end = [min(ms + span_ms, 10_000) for ms in since_end]
        if on is not None and driven_ms < span_ms:
            since_end[on] = span_ms - driven_ms
            on, length = None, 0
        return self._replace(on=on, length=length, since_end=tuple(since_end))

    def cut(self, still_on: bool) -> "Judge":
        """Something other than time has happened: the coil is still on, or off from now on."""
        if self.on is None or still_on:
            return self
        since_end = list(self.since_end)
        since_end[self.on] = 0
        return self._replace(on=None, length=0, since_end=tuple(since_end))

    def accept(self) -> "Judge":
        """A request is accepted: without a back-off a pulse may follow the one before at once."""
        assert not self.silent, "accepted while there is no SYNC"
        return self if self.limits.backoff_ms else self.cut(still_on=False)

    def hear(self, silent: bool) -> "Judge":
        """SYNC has come, or has not come for too long."""
        return self._replace(silent=silent)


@dataclass
class Proof:
    """What the search has seen."""

    states: int = 0
    accepted: Counter = field(default_factory=Counter)
    refused: Counter = field(default_factory=Counter)
    apart: int = 0  # states in which one interlock has ended a pulse that the other has not


Watching = Callable[[Judge], Judge]
"""What a judge sees of a change."""


def fresh(kind, limits):
    """A guard that has just been switched on. It is always now at 0 ms."""
    board = kind(limits)
    board.pass_time(0)
    return board


def copy_of(board):
    """A guard in the same state, with interlocks of its own."""
    other = copy.copy(board)
    other._by_ticks = copy.copy(board._by_ticks)
    other._by_clock = copy.copy(board._by_clock)
    return other


def passed(board, span_ms):
    """Time passes, and no tick comes. A pulse that is over then was over when its timer said so."""
    later = copy_of(board)
    later.pass_time(span_ms)
    driven_ms, drives = 0, later.drives
    if board.drives:
        driven_ms = span_ms if drives else board.ends_ms
        assert 0 < driven_ms <= span_ms
    vars(later).update({name: ms - span_ms for name, ms in vars(later).items() if name.endswith("_ms")})
    return later, lambda judge: judge.watch(board.coil, driven_ms, span_ms).cut(drives)


def changed(board, change):
    """Something happens in no time."""
    other = copy_of(board)
    change(other)
    drives = other.drives
    return other, lambda judge: judge.cut(drives)


def heard(board, change, silent):
    """A SYNC has come, or has not come for too long."""
    other, watched = changed(board, change)
    return other, lambda judge: watched(judge).hear(silent)


def both_accept(board, asked):
    return all(
        interlock.judge(one, asked, TICK, limits) is None
        for one, limits in ((board._by_ticks, board._limits), (board._by_clock, board._clock_limits))
    )


def asked_of(board, limits, proof):
    """The guards that have accepted a request, each request having been made."""
    for asked in REQUESTS[limits.shared]:
        answered = copy_of(board)
        reason = answered.ask(asked, TICK)
        assert reason is None or board._silent or not both_accept(board, asked), f"{asked}: {reason}"
        assert reason is not None or both_accept(board, asked), f"{asked} is accepted"
        if reason is None:
            proof.accepted[asked.coil] += 1
            assert answered.drives
            yield answered, lambda judge: judge.accept()
        else:
            proof.refused[reason] += 1
            assert vars(answered) == vars(board), "a refusal changed the state"


def reached_from(board, kind, limits, proof) -> list[tuple[Guard, Watching]]:
    """Whatever may happen to a guard, and what a judge sees of it."""
    return [
        *(passed(board, span_ms) for span_ms in JUMPS_MS),
        *(changed(board, lambda one, n=n: one.elapse(n)) for n in TICKS),
        heard(board, lambda one: one.sync(), silent=False),
        heard(board, lambda one: one.silence(), silent=True),
        (fresh(kind, limits), lambda judge: judge.cut(still_on=False).hear(silent=False)),
        *asked_of(board, limits, proof),
    ]


def prove(kind: type[Guard], limits: CoilLimits) -> Proof:
    """Search all that can be reached; AssertionError at the first state that breaks a demand.

    What may happen to a guard does not depend on the judge, and is done once for many judges.
    """
    proof = Proof()
    queue = deque([(fresh(kind, limits), Judge(limits))])
    reached, seen = {}, set()
    while queue:
        board, judge = queue.popleft()
        by_ticks, by_clock = numbers_of(board._by_ticks), numbers_of(board._by_clock)
        guard = (by_ticks, by_clock, board._tick_under_way, board._clock_ms, board._silent)
        if (guard, judge) in seen:
            continue
        seen.add((guard, judge))
        if len(seen) > 100_000:
            raise RuntimeError("the states do not end")
        proof.apart += (board._by_ticks.remaining == 0) != (board._by_clock.remaining == 0)
        if guard not in reached:
            reached[guard] = reached_from(board, kind, limits, proof)
        queue += [(other, watched(judge)) for other, watched in reached[guard]]
    proof.states = len(seen)
    return proof


BOTH = pytest.mark.parametrize("limits", LIMITS.values(), ids=LIMITS)


@pytest.mark.long
@pytest.mark.parametrize("limits", (LIMITS | NONE).values(), ids=LIMITS | NONE)
def test_no_reachable_state_breaks_a_limit_over_true_time(limits):
    proof = prove(Guard, limits)
    assert proof.states > (1000 if limits.backoff_ms else 100)
    assert set(proof.accepted) == {0, 1}
    assert len(proof.refused) == 3, "lockout or silence, coil on, repeated"
    assert proof.apart > (100 if limits.backoff_ms else 10), "time and ticks were apart"


class ToldOfTimeByTicksAlone(Guard):
    def pass_time(self, clock_ms):
        self._told_ms = clock_ms
        if self._by_clock is None:
            super().pass_time(clock_ms)

    def elapse(self, ticks):
        super().pass_time(self._told_ms)
        super().elapse(ticks)


class FastClock(Guard):
    def pass_time(self, clock_ms):
        passed_ms = 0 if self._by_clock is None else clock_ms - self._clock_ms
        super().pass_time(clock_ms)
        interlock.elapse(self._by_clock, passed_ms)


class ClockNotAsked(Guard):
    def ask(self, request, tick):
        by_clock, self._by_clock = self._by_clock, None
        reason = super().ask(request, tick)
        self._by_clock = by_clock
        return reason


class ClockNotTold(Guard):
    def ask(self, request, tick):
        by_clock = copy.copy(self._by_clock)
        reason = super().ask(request, tick)
        self._by_clock = by_clock
        return reason


class ClockThatBootsFree(Guard):
    def pass_time(self, clock_ms):
        boots = self._by_clock is None
        super().pass_time(clock_ms)
        if boots:
            self._by_clock.lockout = (0, 0, 0)


class ClockDeafToSilence(Guard):
    def silence(self):
        by_clock = copy.copy(self._by_clock)
        super().silence()
        self._by_clock = replace(by_clock, lockout=(0, 0, 0))


class LastEndsAPulse(Guard):
    @property
    def remaining_units(self):
        by_clock = self._by_clock.remaining * self._limits.tick_hz // CLOCK_HZ
        return max(self._by_ticks.remaining, by_clock)


class ClockWithShorterLimits(Guard):
    def __init__(self, limits):
        super().__init__(limits)
        self._clock_limits = replace(self._clock_limits, backoff_ms=500)


PLANTED = {
    "a clock that is told of time by ticks alone": ToldOfTimeByTicksAlone,
    "a clock that runs fast": FastClock,
    "a clock that is not asked": ClockNotAsked,
    "a clock that is not told": ClockNotTold,
    "a clock that boots free": ClockThatBootsFree,
    "a clock that is deaf to silence": ClockDeafToSilence,
    "the last of the two ends a pulse": LastEndsAPulse,
    "a clock with shorter limits": ClockWithShorterLimits,
}


@BOTH
@pytest.mark.parametrize("faulty", PLANTED.values(), ids=PLANTED)
def test_a_planted_bug_is_found(faulty, limits):
    with pytest.raises(AssertionError):
        prove(faulty, limits)


class LockedOutByTimersAlone(Guard):
    def silence(self):
        super().silence()
        self._silent = False


@pytest.mark.parametrize("limits", NONE.values(), ids=NONE)
def test_without_a_back_off_a_silence_that_ends_by_itself_is_found(limits):
    with pytest.raises(AssertionError, match="no SYNC"):
        prove(LockedOutByTimersAlone, limits)
