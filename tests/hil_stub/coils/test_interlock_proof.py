"""Proof of the interlock by exhaustion: every state that requests, ticks and restarts can reach.

The interlock is run beside a judge that sees only what is driven and keeps its own stopwatches. From each
reachable pair of states every request, one and several ticks, a restart and the dead-man are tried. The
judge demands

- safety: pulses, gaps and levels keep the limits on what was really driven;
- exactness: a request is accepted if and only if it is proper and the judge's stopwatches allow it, a
  refused one changes nothing, and an accepted one is carried out to the unit of time.

The constants are small so that the state space is finite and searched to its end; no rule depends on them.
That the demands have teeth is shown by planting bugs in the interlock: each must be found.
"""

from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, partial
from itertools import product
from typing import NamedTuple

import pytest
from interlocks import Numbers, after_request, after_silence, after_ticks, become, numbers_of

from fsw.wire.messages import CoilFire
from fsw.wire.messages import CoilRefusedReason as Reason
from hil_stub.coils import interlock

TICK = 300
LOW = TICK % 256
PULSE_MS, BACKOFF_MS = 2500, 7000
DURATIONS_MS = (1000, 1001, PULSE_MS)
"""At 1 Hz a back-off is seven ticks; pulses end at a tick, just after one, and in the middle of one."""

IN_TIME = [
    CoilFire(level, coil, seq, LOW, duration_ms)
    for coil, level, duration_ms, seq in product(
        (0, 1, 2, 3), (-4, -3, 0, 1), (0, *DURATIONS_MS, PULSE_MS + 1), (0, 1)
    )
]
LATE = [CoilFire(1, coil, seq, LOW - 1, PULSE_MS) for coil in (0, 1, 2) for seq in (0, 1)]
REQUESTS = IN_TIME + LATE
JUMPS = (1, 2, 5)


@cache
def proper(ready: tuple[bool, ...], last_seq: int | None) -> frozenset[int]:
    """The requests that nothing is wrong with, of coils that are ready, with another number than the last.

    Each by its place among ``REQUESTS``.
    """
    return frozenset(
        place
        for place, asked in enumerate(REQUESTS)
        if asked.coil != 3 and ready[asked.coil]
        if asked.level not in {-4, 0} and asked.duration_ms in DURATIONS_MS
        if asked.tick == LOW and asked.seq != last_seq
    )


class Judge(NamedTuple):
    """Stopwatches of an onlooker, in thousandths of a tick, each stopped at the limit it is for."""

    on: tuple[int, int] | None = None  # coil and level driven up to this instant
    length: int = 0  # of that pulse so far
    since_end: tuple[int, ...] = (BACKOFF_MS,) * 3
    since_boot: int = 0
    last_seq: int | None = None
    due: tuple[int, int, int] | None = None  # coil, level and rest of the accepted request that is not over
    backoff: int = BACKOFF_MS

    def allowed(self, shared: bool) -> frozenset[int]:
        """The requests that are proper and would keep the limits if they were carried out now."""
        if self.due or self.since_boot < self.backoff:
            return frozenset()
        waited = [0 if self.on and self.on[0] == coil else time for coil, time in enumerate(self.since_end)]
        ready = (min(waited),) * 3 if shared else waited
        return proper(tuple(time >= self.backoff for time in ready), self.last_seq)

    def accept(self, asked: CoilFire) -> "Judge":
        """Without a back-off a pulse may follow the one before at once, and is another one."""
        begun = self if self.backoff else self._replace(on=None, length=0)
        return begun._replace(last_seq=asked.seq, due=(asked.coil, asked.level, asked.duration_ms))

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
                assert waited >= self.backoff, f"only {waited} between the end of a pulse and the next"
                length = 0
            on, length = (coil, level), length + driven
            assert length <= PULSE_MS, f"a pulse of {length}"
        since_end = [min(time + span, self.backoff) for time in since_end]
        if on is not None:
            since_end[on[0]] = min(span - driven, self.backoff)
        if driven < span:
            on, length = None, 0
        if due is not None:
            due = (*due[:2], due[2] - span) if due[2] > span else None
        since_boot = min(self.since_boot + span, self.backoff)
        return Judge(on, length, tuple(since_end), since_boot, self.last_seq, due, self.backoff)


@dataclass
class Proof:
    """What the search has seen."""

    states: int = 0
    accepted: Counter = field(default_factory=Counter)
    refused: Counter = field(default_factory=Counter)
    pulses: set[int] = field(default_factory=set)
    restarts_in_pulse: int = 0
    silences_in_pulse: int = 0


def accepted_by(numbers: Numbers, limits: interlock.CoilLimits, proof: Proof, exact: bool) -> dict:
    """The requests that are accepted in a state, by their places, and the states after them."""
    accepted = {}
    for place, asked in enumerate(REQUESTS):
        after, reason = after_request(interlock.Interlock(*numbers), asked, TICK, limits)
        if reason is None:
            proof.accepted[asked.coil] += 1
            accepted[place] = numbers_of(after)
        else:
            proof.refused[reason] += 1
            assert numbers_of(after) == numbers or not exact, "a refusal changed the state"
    return accepted


def prove(shared: bool, exact: bool = True, backoff_ms: int = BACKOFF_MS) -> Proof:
    """Search all that can be reached; AssertionError at the first state that breaks a demand.

    With ``exact`` exactness is demanded too, not safety alone.
    """
    limits = interlock.CoilLimits(tick_hz=1, pulse_ms=PULSE_MS, backoff_ms=backoff_ms, shared=shared)
    booted = numbers_of(interlock.boot(limits))
    seen = {(booted, Judge(since_end=(backoff_ms,) * 3, backoff=backoff_ms))}
    queue = deque(seen)
    proof, answers = Proof(), {}
    while queue:
        numbers, judge = queue.popleft()
        state = interlock.Interlock(*numbers)
        reached = [(booted, judge.reboot())]
        reached.append((numbers_of(after_silence(state, limits)), judge.silence()))
        proof.restarts_in_pulse += state.remaining > 0
        proof.silences_in_pulse += state.remaining > 0
        if numbers not in answers:
            answers[numbers] = accepted_by(numbers, limits, proof, exact)
        assert not exact or answers[numbers].keys() == judge.allowed(shared), f"in {state}"
        reached += [(after, judge.accept(REQUESTS[place])) for place, after in answers[numbers].items()]
        for ticks in JUMPS:
            span = ticks * interlock.UNITS_PER_TICK
            driven = min(state.remaining, span)
            if exact:
                judge.expect(state.coil, state.level, driven, span)
            watched = judge.watch(state.coil, state.level, driven, span, shared)
            proof.pulses.add(watched.length)
            reached.append((numbers_of(after_ticks(state, ticks)), watched))
        for pair in reached:
            if pair not in seen:
                seen.add(pair)
                queue.append(pair)
        assert len(seen) < 100_000, "the states do not end"
    proof.states = len({numbers for numbers, _ in seen})
    return proof


BOTH = (True, False)

NOT_OF_THE_INTERLOCK = {Reason.MALFORMED, Reason.SECOND_DIPOLE, Reason.WRONG_BOARD}


@pytest.mark.long
@pytest.mark.parametrize("shared", BOTH, ids=["shared", "per_coil"])
@pytest.mark.slow
def test_no_reachable_state_breaks_a_limit_or_refuses_what_it_may_not(shared):
    proof = prove(shared)
    assert proof.states > (100 if shared else 10_000)
    assert set(proof.accepted) == {0, 1, 2}, "every coil was fired"
    assert set(proof.refused) == set(Reason) - NOT_OF_THE_INTERLOCK, "for every reason"
    assert proof.pulses >= {0, 1000, 2000}, "pulses went on over ticks"
    assert proof.restarts_in_pulse > 0
    assert proof.silences_in_pulse > 0


@pytest.mark.parametrize("shared", BOTH, ids=["shared", "per_coil"])
def test_nor_without_a_back_off(shared):
    proof = prove(shared, backoff_ms=0)
    assert set(proof.accepted) == {0, 1, 2}
    assert set(proof.refused) == set(Reason) - NOT_OF_THE_INTERLOCK - {Reason.LOCKOUT}
    assert proof.restarts_in_pulse > 0
    assert proof.silences_in_pulse > 0


Planting = Callable[[pytest.MonkeyPatch], None]


def around(name: str, change: Callable) -> Planting:
    """A bug in a function of the interlock: ``change`` is called in its place, with it and its arguments."""
    return lambda patch: patch.setattr(interlock, name, partial(change, getattr(interlock, name)))


def judging(reason: Reason, refuses: Callable = lambda state, asked, limits: False) -> Planting:
    """A bug in the rule for one reason, which is judged otherwise; by default never."""

    def applies(state, asked, tick, limits):
        return refuses(state, asked, limits)

    rules = tuple((one, applies if one is reason else rule) for one, rule in interlock._REFUSED_IF)
    return lambda patch: patch.setattr(interlock, "_REFUSED_IF", rules)


def booting(**values: object) -> Planting:
    """A bug in what holds after boot."""
    return around("boot", lambda boot, limits: replace(boot(limits), **values))


def accepting(change: Callable) -> Planting:
    """A bug in what an accepted request does: ``change(after, before, asked, limits)``."""

    def wrong(accept, state, asked, limits):
        before = replace(state)
        accept(state, asked, limits)
        become(state, change(state, before, asked, limits))

    return around("accept", wrong)


def locking_out(
    until_next: Callable[[int, int], int] = lambda pulse, backoff: pulse + backoff,
    locks: Callable = lambda coil, asked, limits: limits.shared or coil == asked.coil,
) -> Planting:
    """A bug in the lockout of an accepted request: for how long, in units, or of which coils."""

    def change(after, before, asked, limits):
        units = until_next(limits.units(asked.duration_ms), limits.units(limits.backoff_ms))
        lockout = [units if locks(n, asked, limits) else left for n, left in enumerate(before.lockout)]
        return replace(after, lockout=tuple(lockout))

    return accepting(change)


def elapsing(change: Callable) -> Planting:
    """A bug in how time passes: ``change(after, before, units)``."""

    def wrong(elapse, state, ticks):
        before = replace(state)
        elapse(state, ticks)
        become(state, change(state, before, ticks * interlock.UNITS_PER_TICK))

    return around("elapse", wrong)


def silencing(change: Callable) -> Planting:
    """A bug in what the dead-man does: ``change(after, before)``."""

    def wrong(silence, state, limits):
        before = replace(state)
        silence(state, limits)
        become(state, change(state, before))

    return around("silence", wrong)


FULL = BACKOFF_MS  # units of a whole back-off, at 1 Hz

UNSAFE = {
    "no lockout at boot": booting(lockout=(0, 0, 0)),
    "a coil forgotten at boot": booting(lockout=(FULL, FULL, 0)),
    "half a lockout at boot": booting(lockout=(FULL // 2,) * 3),
    "on at boot": booting(level=1, remaining=500),
    "back-off from the start of the pulse": locking_out(lambda pulse, backoff: backoff),
    "no back-off": locking_out(lambda pulse, backoff: pulse),
    "back-off a unit short": locking_out(lambda pulse, backoff: pulse + backoff - 1),
    "shared taken for per coil": locking_out(locks=lambda coil, asked, limits: coil == asked.coil),
    "another coil locked out": locking_out(locks=lambda coil, asked, limits: coil != asked.coil),
    "lockout not judged": judging(Reason.LOCKOUT),
    "lockout judged half a tick early": judging(
        Reason.LOCKOUT, lambda state, asked, limits: state.lockout[asked.coil] > 500
    ),
    "lockout of the wrong coil judged": judging(
        Reason.LOCKOUT, lambda state, asked, limits: state.lockout[asked.coil - 1] > 0
    ),
    "lockout runs twice as fast": elapsing(
        lambda after, before, units: replace(
            after, lockout=(after.lockout[0], max(0, before.lockout[1] - 2 * units), after.lockout[2])
        )
    ),
    "jumps count one tick more": around(
        "elapse", lambda elapse, state, ticks: elapse(state, ticks + (ticks > 1))
    ),
    "a pulse that is a unit too long": judging(
        Reason.BAD_DURATION,
        lambda state, asked, limits: not 1 <= asked.duration_ms <= limits.pulse_ms + 1,
    ),
    "a pulse that does not run down": elapsing(
        lambda after, before, units: replace(after, remaining=before.remaining)
    ),
    "a pulse that runs down slowly": elapsing(
        lambda after, before, units: replace(after, remaining=before.remaining * 7 // 8)
    ),
    "a coil that does not exist": judging(
        Reason.BAD_COIL, lambda state, asked, limits: not 0 <= asked.coil <= interlock.COILS
    ),
    "a level too high": judging(
        Reason.BAD_LEVEL,
        lambda state, asked, limits: not 1 <= abs(asked.level) <= interlock.MAX_LEVEL + 1,
    ),
    "level 0": judging(
        Reason.BAD_LEVEL, lambda state, asked, limits: not 0 <= abs(asked.level) <= interlock.MAX_LEVEL
    ),
    "no back-off after the dead-man": silencing(
        lambda after, before: replace(before, remaining=0, lockout=(0, 0, 0))
    ),
    "a coil forgotten by the dead-man": silencing(
        lambda after, before: replace(before, lockout=(*before.lockout[:2], 0))
    ),
    "the dead-man switches on": silencing(lambda after, before: replace(after, level=1, remaining=1)),
}

INEXACT = {
    "a dead-man that does nothing": silencing(lambda after, before: before),
    "a dead-man that leaves the coil on": silencing(
        lambda after, before: replace(after, remaining=before.remaining, seq=None)
    ),
    "a dead-man that only switches off": silencing(
        lambda after, before: replace(before, level=0, remaining=0)
    ),
    "a dead-man that forgets seq": silencing(lambda after, before: replace(after, seq=None)),
    "a second request while a coil is on": judging(Reason.COIL_ON),
    "a late request": judging(Reason.WRONG_TICK),
    "a repeated request": judging(Reason.REPEATED_SEQ),
    "seq forgotten": accepting(lambda after, before, asked, limits: replace(after, seq=before.seq)),
    "no duration": judging(
        Reason.BAD_DURATION, lambda state, asked, limits: not 0 <= asked.duration_ms <= limits.pulse_ms
    ),
    "per coil taken for shared": locking_out(locks=lambda coil, asked, limits: True),
    "lockout never over": elapsing(
        lambda after, before, units: replace(after, lockout=(*after.lockout[:2], max(1, after.lockout[2])))
    ),
    "lockout a unit long": locking_out(lambda pulse, backoff: pulse + backoff + 1),
    "sign lost": accepting(lambda after, before, asked, limits: replace(after, level=abs(after.level))),
    "pulse a unit short": accepting(
        lambda after, before, asked, limits: replace(after, remaining=after.remaining - 1)
    ),
}


ONE_KIND = {
    "shared taken for per coil": (True,),
    "another coil locked out": (False,),
    "lockout of the wrong coil judged": (False,),
    "lockout runs twice as fast": (False,),
    "a second request while a coil is on": (False,),
    "per coil taken for shared": (False,),
}
"""What is a bug with one kind of back-off alone."""


def cases(bugs: dict[str, Planting]) -> list:
    return [
        pytest.param(plant, shared, id=f"{name}, {'shared' if shared else 'per coil'}")
        for name, plant in bugs.items()
        for shared in ONE_KIND.get(name, BOTH)
    ]


@pytest.mark.interpreted
@pytest.mark.parametrize(("plant", "shared"), cases(UNSAFE))
def test_a_planted_danger_is_seen_in_what_is_driven(plant, shared, monkeypatch):
    plant(monkeypatch)
    with pytest.raises((AssertionError, IndexError)):
        prove(shared, exact=False)


@pytest.mark.interpreted
@pytest.mark.parametrize(("plant", "shared"), cases(UNSAFE | INEXACT))
def test_a_planted_bug_is_seen(plant, shared, monkeypatch):
    plant(monkeypatch)
    with pytest.raises((AssertionError, IndexError)):
        prove(shared)


@pytest.mark.interpreted
def test_a_planting_that_changes_nothing_passes(monkeypatch):
    """What is found is the bug, not the planting."""
    for plant in (
        booting(lockout=(FULL, FULL, FULL)),
        locking_out(),
        elapsing(lambda after, before, units: after),
        silencing(lambda after, before: after),
    ):
        plant(monkeypatch)
    assert prove(shared=True).states > 100
