"""Proof of the interlock by exhaustion: every state that requests, ticks and restarts can reach.

The interlock is run beside a judge that sees only what is driven and keeps its own stopwatches. From each
reachable pair of states every request, one and several ticks, a restart and the dead-man are tried. The
judge demands

- safety: pulses, gaps and levels keep the limits on what was really driven;
- exactness: a request is accepted if and only if it is proper and the judge's stopwatches allow it, a
  refused one changes nothing, and an accepted one is carried out to the unit of time.

The constants are small so that the state space is finite and searched to its end; no rule depends on them.
That the demands have teeth is shown by planting bugs in copies of the interlock: each must be found.
"""

import inspect
import sys
from collections import Counter, deque
from dataclasses import dataclass, field
from itertools import product
from types import ModuleType
from typing import NamedTuple

import pytest

from fsw.wire.messages import CoilRefusedReason
from hil_stub.coils import interlock

TICK = 300
LOW = TICK % 256
PULSE_MS, BACKOFF_MS = 2500, 7000
DURATIONS_MS = (1000, 1001, PULSE_MS)
"""At 1 Hz a back-off is seven ticks; pulses end at a tick, just after one, and in the middle of one."""

IN_TIME = [
    interlock.Request(coil, level, duration_ms, seq, LOW)
    for coil, level, duration_ms, seq in product(
        (0, 1, 2, 3), (-4, -3, 0, 1), (0, *DURATIONS_MS, PULSE_MS + 1), (0, 1)
    )
]
LATE = [interlock.Request(coil, 1, PULSE_MS, seq, LOW - 1) for coil in (0, 1, 2) for seq in (0, 1)]
REQUESTS = IN_TIME + LATE
JUMPS = (1, 2, 5)


class Judge(NamedTuple):
    """Stopwatches of an onlooker, in thousandths of a tick, each stopped at the limit it is for."""

    on: tuple[int, int] | None = None  # coil and level driven up to this instant
    length: int = 0  # of that pulse so far
    since_end: tuple[int, ...] = (BACKOFF_MS,) * 3
    since_boot: int = 0
    last_seq: int | None = None
    due: tuple[int, int, int] | None = None  # coil, level and rest of the accepted request that is not over

    def allows(self, asked: interlock.Request, shared: bool) -> bool:
        """Whether the request is proper and would keep the limits if it were carried out now."""
        if asked.coil == 3 or asked.level in {-4, 0} or asked.duration_ms not in DURATIONS_MS:
            return False
        if asked.tick != LOW or asked.seq == self.last_seq or self.due or self.since_boot < BACKOFF_MS:
            return False
        waited = [0 if self.on and self.on[0] == coil else time for coil, time in enumerate(self.since_end)]
        return (min(waited) if shared else waited[asked.coil]) >= BACKOFF_MS

    def accept(self, asked: interlock.Request) -> "Judge":
        return self._replace(last_seq=asked.seq, due=(asked.coil, asked.level, asked.duration_ms))

    def reboot(self) -> "Judge":
        return self._replace(since_boot=0, last_seq=None, due=None)

    def silence(self) -> "Judge":
        """The dead-man: what is on goes off, and the wait begins anew, but what was asked stays known."""
        return self._replace(since_boot=0, due=None)

    def expect(self, coil: int, level: int, driven: int, span: int) -> None:
        """Exactness: over ``span`` the accepted request is driven, no less and no more."""
        rest = self.due[2] if self.due else 0
        assert driven == min(rest, span), f"driven for {driven} where {rest} was due"
        assert not driven or (coil, level) == self.due[:2], f"{self.due} was due, not {level} on {coil}"

    def watch(self, coil: int, level: int, driven: int, span: int, shared: bool) -> "Judge":
        """Safety: ``level`` was driven on ``coil`` for the first ``driven`` of ``span``, then nothing."""
        on, length, since_end, due = self.on, self.length, list(self.since_end), self.due
        if driven:
            assert level in {-3, -2, -1, 1, 2, 3}, f"level {level} was driven"
            assert coil in {0, 1, 2}, f"coil {coil} was driven"
            if on != (coil, level):
                if on is not None:
                    since_end[on[0]] = 0
                waited = min(since_end) if shared else since_end[coil]
                assert waited >= BACKOFF_MS, f"only {waited} between the end of a pulse and the next"
                length = 0
            on, length = (coil, level), length + driven
            assert length <= PULSE_MS, f"a pulse of {length}"
        since_end = [min(time + span, BACKOFF_MS) for time in since_end]
        if on is not None:
            since_end[on[0]] = min(span - driven, BACKOFF_MS)
        if driven < span:
            on, length = None, 0
        if due is not None:
            due = (*due[:2], due[2] - span) if due[2] > span else None
        return Judge(
            on, length, tuple(since_end), min(self.since_boot + span, BACKOFF_MS), self.last_seq, due
        )


@dataclass
class Proof:
    """What the search has seen."""

    states: int = 0
    accepted: Counter = field(default_factory=Counter)
    refused: Counter = field(default_factory=Counter)
    pulses: set[int] = field(default_factory=set)
    restarts_in_pulse: int = 0
    silences_in_pulse: int = 0


def prove(rules: ModuleType, shared: bool, exact: bool = True) -> Proof:
    """Search all that can be reached; AssertionError at the first state that breaks a demand.

    Args:
        rules: the interlock, or a copy of it.
        shared: kind of back-off.
        exact: demand exactness too, not safety alone.
    """
    limits = rules.CoilLimits(tick_hz=1, pulse_ms=PULSE_MS, backoff_ms=BACKOFF_MS, shared=shared)
    first = (rules.boot(limits), Judge())
    seen = {first}
    queue = deque(seen)
    proof = Proof()
    while queue:
        state, judge = queue.popleft()
        reached = [
            (rules.boot(limits), judge.reboot()),
            (rules.silence(state, limits), judge.silence()),
        ]
        proof.restarts_in_pulse += state.remaining > 0
        proof.silences_in_pulse += state.remaining > 0
        for asked in REQUESTS:
            after, reason = rules.ask(state, asked, TICK, limits)
            if exact:
                assert (reason is None) == judge.allows(asked, shared), f"{asked} in {state}: {reason}"
                assert reason is None or after is state, "a refusal changed the state"
            if reason is None:
                proof.accepted[asked.coil] += 1
                reached.append((after, judge.accept(asked)))
            else:
                proof.refused[reason] += 1
        for ticks in JUMPS:
            span = ticks * interlock.UNITS_PER_TICK
            driven = min(state.remaining, span)
            if exact:
                judge.expect(state.coil, state.level, driven, span)
            watched = judge.watch(state.coil, state.level, driven, span, shared)
            proof.pulses.add(watched.length)
            reached.append((rules.elapse(state, ticks), watched))
        for pair in reached:
            if pair not in seen:
                seen.add(pair)
                queue.append(pair)
        assert len(seen) < 100_000, "the states do not end"
    proof.states = len({state for state, _ in seen})
    return proof


BOTH = (True, False)

NOT_OF_THE_INTERLOCK = {
    CoilRefusedReason.MALFORMED,
    CoilRefusedReason.SECOND_DIPOLE,
    CoilRefusedReason.WRONG_BOARD,
}


@pytest.mark.parametrize("shared", BOTH, ids=["shared", "per_coil"])
def test_no_reachable_state_breaks_a_limit_or_refuses_what_it_may_not(shared):
    proof = prove(interlock, shared)
    assert proof.states > (100 if shared else 10_000)
    assert set(proof.accepted) == {0, 1, 2}, "every coil was fired"
    assert set(proof.refused) == set(CoilRefusedReason) - NOT_OF_THE_INTERLOCK, "for every reason"
    assert proof.pulses >= {0, 1000, 2000}, "pulses went on over ticks"
    assert proof.restarts_in_pulse > 0
    assert proof.silences_in_pulse > 0


def planted(old: str, new: str) -> ModuleType:
    """A copy of the interlock with one piece of its source replaced."""
    source = inspect.getsource(interlock)
    assert source.count(old) == 1, f"{old!r} stands {source.count(old)} times in the interlock"
    copy = ModuleType("planted")
    sys.modules[copy.__name__] = copy  # dataclasses look their module up
    try:
        exec(compile(source.replace(old, new), "planted", "exec"), copy.__dict__)
    finally:
        del sys.modules[copy.__name__]
    return copy


UNSAFE = {
    "no lockout at boot": ("lockout=(full, full, full)", "lockout=(0, 0, 0)", BOTH),
    "a coil forgotten at boot": ("lockout=(full, full, full)", "lockout=(full, full, 0)", BOTH),
    "half a lockout at boot": (
        "full = limits.units(limits.backoff_ms",
        "full = limits.units(limits.backoff_ms // 2",
        BOTH,
    ),
    "on at boot": ("level=0, remaining=0, lockout=(full", "level=1, remaining=500, lockout=(full", BOTH),
    "back-off from the start of the pulse": ("duration + limits.units(", "limits.units(", BOTH),
    "no back-off": ("duration + limits.units(limits.backoff_ms)", "duration", BOTH),
    "back-off a unit short": ("limits.backoff_ms)\n    a, b, c", "limits.backoff_ms) - 1\n    a, b, c", BOTH),
    "shared taken for per coil": ("limits.shared or coil ==", "coil ==", (True,)),
    "another coil locked out": ("coil == asked.coil else", "coil != asked.coil else", (False,)),
    "lockout not judged": ("state.lockout[asked.coil] > 0", "False", BOTH),
    "lockout judged half a tick early": (
        "state.lockout[asked.coil] > 0",
        "state.lockout[asked.coil] > 500",
        BOTH,
    ),
    "lockout of the wrong coil judged": (
        "state.lockout[asked.coil] >",
        "state.lockout[asked.coil - 1] >",
        (False,),
    ),
    "lockout runs twice as fast": ("max(0, b - units)", "max(0, b - 2 * units)", (False,)),
    "jumps count one tick more": ("units = ticks *", "units = (ticks + (ticks > 1)) *", BOTH),
    "a pulse that is a unit too long": ("<= limits.pulse_ms", "<= limits.pulse_ms + 1", BOTH),
    "a pulse that does not run down": ("max(0, state.remaining - units)", "state.remaining", BOTH),
    "a pulse that runs down slowly": ("max(0, state.remaining - units)", "state.remaining * 7 // 8", BOTH),
    "a coil that does not exist": ("< COILS", "<= COILS", BOTH),
    "a level too high": ("<= MAX_LEVEL,", "<= MAX_LEVEL + 1,", BOTH),
    "level 0": ("1 <= abs(asked.level)", "0 <= abs(asked.level)", BOTH),
}

SILENCE = "replace(boot(limits), seq=state.seq)"
"""What the dead-man does."""

UNSAFE |= {
    "no back-off after the dead-man": (SILENCE, "replace(state, remaining=0, lockout=(0, 0, 0))", BOTH),
    "a coil forgotten by the dead-man": (SILENCE, "replace(state, lockout=(*state.lockout[:2], 0))", BOTH),
    "the dead-man switches on": (SILENCE, "replace(boot(limits), seq=state.seq, level=1, remaining=1)", BOTH),
}

INEXACT = {
    "a dead-man that does nothing": (SILENCE, "state", BOTH),
    "a dead-man that leaves the coil on": (SILENCE, "replace(boot(limits), remaining=state.remaining)", BOTH),
    "a dead-man that only switches off": (SILENCE, "replace(state, level=0, remaining=0)", BOTH),
    "a dead-man that forgets seq": (SILENCE, "boot(limits)", BOTH),
    "a second request while a coil is on": ("state.remaining > 0)", "False)", (False,)),
    "a late request": ("asked.tick != tick & 0xFF", "False", BOTH),
    "a repeated request": ("asked.seq == state.seq", "False", BOTH),
    "seq forgotten": ("), seq=asked.seq", "), seq=state.seq", BOTH),
    "no duration": ("1 <= asked.duration_ms", "0 <= asked.duration_ms", BOTH),
    "per coil taken for shared": ("limits.shared or coil ==", "True or coil ==", (False,)),
    "lockout never over": ("max(0, c - units)", "max(1, c - units)", BOTH),
    "lockout a unit long": ("limits.backoff_ms)\n    a, b, c", "limits.backoff_ms) + 1\n    a, b, c", BOTH),
    "sign lost": ("level=asked.level", "level=abs(asked.level)", BOTH),
    "pulse a unit short": ("remaining=duration", "remaining=duration - 1", BOTH),
}


def cases(bugs: dict) -> list:
    return [
        pytest.param(old, new, shared, id=f"{name}, {'shared' if shared else 'per coil'}")
        for name, (old, new, kinds) in bugs.items()
        for shared in kinds
    ]


@pytest.mark.parametrize(("old", "new", "shared"), cases(UNSAFE))
def test_a_planted_danger_is_seen_in_what_is_driven(old, new, shared):
    with pytest.raises((AssertionError, IndexError)):
        prove(planted(old, new), shared, exact=False)


@pytest.mark.parametrize(("old", "new", "shared"), cases(UNSAFE | INEXACT))
def test_a_planted_bug_is_seen(old, new, shared):
    with pytest.raises((AssertionError, IndexError)):
        prove(planted(old, new), shared)


def test_a_copy_without_a_bug_passes():
    """What is found in the copies is the bug, not the planting."""
    assert prove(planted("MAX_LEVEL = 3", "MAX_LEVEL = 2 + 1"), shared=True).states > 100
