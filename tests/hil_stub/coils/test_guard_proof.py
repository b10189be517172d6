"""Proof of the guard by exhaustion: time and ticks are two things that need not agree.

From every state that can be reached time passes without a tick, ticks come in no time, one or several, with
their SYNC or without, every request is made, the board restarts, and the dead-man wakes. A judge that is told
of time alone demands invariant I over it, and that a request is accepted if and only if both interlocks
accept it. That it has teeth is shown by planting bugs in copies of the guard: each must be found.

The constants are small so that the search ends; no rule depends on them.
"""

import copy
import inspect
import sys
from collections import Counter, deque
from dataclasses import dataclass, field
from itertools import product
from types import ModuleType
from typing import NamedTuple

import pytest

from hil_stub.coils import guard, interlock
from hil_stub.coils.interlock import CoilLimits, Request

TICK = 300
JUMPS_MS = (500, 2500)
TICKS = (1, 3)
REQUESTS = {
    True: [Request(coil, 2, ms, seq, TICK & 0xFF) for coil, ms, seq in product((0, 1), (1000, 1500), (0, 1))],
    False: [Request(coil, 2, 1000, seq, TICK & 0xFF) for coil, seq in product((0, 1), (0, 1))],
}
LIMITS = {True: CoilLimits(1, 1500, 2000, shared=True), False: CoilLimits(1, 1000, 1000, shared=False)}
"""By kind of back-off. At 1 Hz pulses and back-offs are some ticks, and some steps of half a second."""


class Judge(NamedTuple):
    """Stopwatches of true time [ms], stopped at the limit they are for; what was before boot is not known."""

    limits: CoilLimits
    on: int | None = None
    length: int = 0
    since_end: tuple[int, int, int] = (10_000,) * 3

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
        return Judge(limits, on, length, tuple(since_end))

    def cut(self, still_on: bool) -> "Judge":
        """Something other than time has happened: the coil is still on, or off from now on."""
        if self.on is None or still_on:
            return self
        since_end = list(self.since_end)
        since_end[self.on] = 0
        return Judge(self.limits, None, 0, tuple(since_end))


@dataclass
class Proof:
    """What the search has seen."""

    states: int = 0
    accepted: Counter = field(default_factory=Counter)
    refused: Counter = field(default_factory=Counter)
    apart: int = 0  # states in which one interlock has ended a pulse that the other has not


def fresh(module, limits, clock_ms):
    """A guard that has just been switched on."""
    board = module.Guard(limits)
    board.pass_time(clock_ms)
    return board


def passed(board, judge, now_ms, span_ms):
    """Time passes, and no tick comes. A pulse that is over then was over when its timer said so."""
    later = copy.copy(board)
    later.pass_time(now_ms + span_ms)
    driven_ms = 0
    if board.drives:
        driven_ms = span_ms if later.drives else board.ends_ms - now_ms
        assert 0 < driven_ms <= span_ms
    return later, judge.watch(board.coil, driven_ms, span_ms).cut(later.drives), now_ms + span_ms


def changed(board, judge, now_ms, change):
    """Something happens in no time."""
    other = copy.copy(board)
    change(other)
    return other, judge.cut(other.drives), now_ms


def both_accept(board, asked):
    return all(
        interlock.ask(one, asked, TICK, limits)[1] is None
        for one, limits in ((board._by_ticks, board._limits), (board._by_clock, board._clock_limits))
    )


def prove(module: ModuleType, shared: bool) -> Proof:
    """Search all that can be reached; AssertionError at the first state that breaks a demand."""
    limits, proof = LIMITS[shared], Proof()
    queue = deque([(fresh(module, limits, 0), Judge(limits), 0)])
    seen = set()
    while queue:
        board, judge, now_ms = queue.popleft()
        state = (board._by_ticks, board._by_clock, board._tick_under_way, now_ms - board._clock_ms, judge)
        if state in seen:
            continue
        seen.add(state)
        if len(seen) > 100_000:
            raise RuntimeError("the states do not end")
        proof.apart += (board._by_ticks.remaining == 0) != (board._by_clock.remaining == 0)
        queue += [passed(board, judge, now_ms, span_ms) for span_ms in JUMPS_MS]
        queue += [changed(board, judge, now_ms, lambda one, n=n: one.elapse(n)) for n in TICKS]
        queue.append(changed(board, judge, now_ms, lambda one: one.sync()))
        queue.append(changed(board, judge, now_ms, lambda one: one.silence()))
        queue.append((fresh(module, limits, now_ms), judge.cut(still_on=False), now_ms))
        for asked in REQUESTS[shared]:
            answered = copy.copy(board)
            reason = answered.ask(asked, TICK)
            assert (reason is None) == both_accept(board, asked), f"{asked}: {reason}"
            if reason is None:
                proof.accepted[asked.coil] += 1
                assert answered.drives
                queue.append((answered, judge, now_ms))
            else:
                proof.refused[reason] += 1
                assert vars(answered) == vars(board), "a refusal changed the state"
    proof.states = len(seen)
    return proof


BOTH = pytest.mark.parametrize("shared", [True, False], ids=["shared", "per coil"])


@BOTH
def test_no_reachable_state_breaks_a_limit_over_true_time(shared):
    proof = prove(guard, shared)
    assert proof.states > 1000
    assert set(proof.accepted) == {0, 1}
    assert len(proof.refused) == 3, "lockout, coil on, repeated"
    assert proof.apart > 100, "time and ticks were apart"


TOLD = """    def pass_time(self, clock_ms: int | None) -> None:
"""
TOLD_WITH_A_TICK = """    def pass_time(self, clock_ms):
        self._told_ms = clock_ms
        if self._by_clock is None:
            self._pass_time(clock_ms)

    def elapse(self, ticks):
        self._pass_time(self._told_ms)
        self._elapse(ticks)

    def _pass_time(self, clock_ms):
"""

PLANTED = {
    "a clock that is told of time by ticks alone": (TOLD, TOLD_WITH_A_TICK),
    "a clock that runs fast": ("clock_ms - self._clock_ms)", "2 * (clock_ms - self._clock_ms))"),
    "a clock that is not asked": ("if reason is None and by_clock is not None:", "if False:"),
    "a clock that is not told": (
        "self._by_ticks, self._by_clock = by_ticks, by_clock",
        "self._by_ticks = by_ticks",
    ),
    "a clock that boots free": (
        "boot(self._clock_limits), clock_ms",
        "boot(replace(self._clock_limits, backoff_ms=0)), clock_ms",
    ),
    "a clock that is deaf to silence": (
        "self._by_clock = silence(self._by_clock, self._clock_limits)",
        "self._by_clock = replace(self._by_clock, lockout=(0, 0, 0))",
    ),
    "the last of the two ends a pulse": ("return min(by_ticks.remaining", "return max(by_ticks.remaining"),
    "a clock with shorter limits": (
        "replace(limits, tick_hz=CLOCK_HZ)",
        "replace(limits, tick_hz=CLOCK_HZ, backoff_ms=500)",
    ),
}


def planted(old: str, new: str) -> ModuleType:
    """A copy of the guard with one piece of its source replaced."""
    source = inspect.getsource(guard)
    assert source.count(old) == 1, f"{old!r} stands {source.count(old)} times in the guard"
    if new is TOLD_WITH_A_TICK:
        source = source.replace("def elapse(self", "def _elapse(self")
    copied = ModuleType("planted")
    sys.modules[copied.__name__] = copied
    try:
        exec(compile(source.replace(old, new), "planted", "exec"), copied.__dict__)
    finally:
        del sys.modules[copied.__name__]
    return copied


@BOTH
@pytest.mark.parametrize(("old", "new"), PLANTED.values(), ids=PLANTED)
def test_a_planted_bug_is_found(old, new, shared):
    with pytest.raises(AssertionError):
        prove(planted(old, new), shared)
