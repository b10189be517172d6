"""A search of every state that the scheduler and the coil driver can reach together.

The scheduler (``update_view`` and ``actuate``, unchanged) and the interlock are run beside a judge that sees
only what is driven and keeps its own stopwatches. In each reachable world every demand is made (each coil, or
none), COIL_STATUS is heard or lost, COIL_FIRE is lost, comes once or twice, either side restarts, and the
board's dead-man wakes.

Only the choice of a pulse hangs on floats. What is owed is set anew in each tick so that each coil in its
turn, or none, is the best: that makes every choice there is. Timers are compared with the present tick alone,
so they are kept relative to it, and for how long one has run out is forgotten; of a lockout that the board
has told, only whether it is zero is kept. The constants are small, so that the search ends; no rule depends
on them.
"""

from collections import Counter, deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache, lru_cache
from itertools import product
from math import inf
from typing import NamedTuple

import pytest
from gate_samples import measured
from interlocks import Numbers, after_request, after_silence, after_ticks, numbers_of

from fsw.core.actuation import actuator, pulses
from fsw.core.algebra.vector import ZERO
from fsw.core.laws.interface import Demand
from fsw.wire.messages import CoilBoot, CoilFire, CoilStatus
from hil_stub.coils import interlock
from hil_stub.coils.interlock import Interlock

EPOCH = 768
"""A tick that is a multiple of three coils and of the 256 that a request can tell apart."""

LEVEL_OF = (1, -2, 3)
"""The level that is demanded of each coil."""

DEMANDS = {
    None: (ZERO, (0.0, 0.0, 1.0)),
    0: ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    1: ((0.0, 0.0, 2.0), (1.0, 0.0, 0.0)),
    2: ((-3.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
}
"""Impulse owed and field, body axes: one pulse of that coil pays all of it, and no other coil helps."""


Heard = tuple[CoilStatus | None, CoilBoot | None]
Planting = Callable[[pytest.MonkeyPatch], None]
"""Plants a bug in the scheduler or in the interlock."""


class Setup(NamedTuple):
    """What is proven: for which limits, with which bugs, and what may go wrong."""

    shared: bool
    pulse_ticks: int
    backoff_ticks: int
    bugs: tuple[Planting, ...] = ()
    faults: bool = True
    board_restarts: bool = True
    restart_in_pulse: bool = True


class Own(NamedTuple):
    """The scheduler: ticks to run of its timers, and the board's word on each coil (-1: none yet)."""

    ready: tuple[int, int, int]
    busy: int
    word: tuple[int, int, int]


class Judge(NamedTuple):
    """Stopwatches of an onlooker, in ticks, stopped at the limit. What was before boot is not known to it."""

    on: int | None = None
    length: int = 0
    since_end: tuple[int, ...] = (0, 0, 0)

    def watch(self, coil: int, level: int, driven_units: int, setup: Setup) -> "Judge":
        """Invariant I over the tick that begins."""
        on, length, since_end = self.on, self.length, list(self.since_end)
        if on is not None and (driven_units == 0 or on != coil):
            since_end[on] = 0
            on = None
        if driven_units:
            assert driven_units == interlock.UNITS_PER_TICK, "here a pulse is whole ticks"
            assert level == LEVEL_OF[coil]
            if on is None:
                waited = min(since_end) if setup.shared else since_end[coil]
                assert waited >= setup.backoff_ticks, f"only {waited} ticks between two pulses"
                on, length = coil, 0
            length += 1
            assert length <= setup.pulse_ticks, f"a pulse of {length} ticks"
        aged = tuple(min(time + 1, setup.backoff_ticks) for time in since_end)
        return Judge(on, length if on is not None else 0, aged)


class World(NamedTuple):
    """A state of everything, the present tick being zero; ``phase`` is the tick modulo three.

    ``new``: the board has restarted and not said so yet.
    """

    own: Own
    board: Numbers
    judge: Judge
    phase: int
    new: bool = False


class Step(NamedTuple):
    """What one tick does under one demand when every message arrives: for liveness."""

    fired: int | None
    then: World


@dataclass
class Proof:
    """What the search has seen."""

    worlds: set[World] = field(default_factory=set)
    accepted: Counter = field(default_factory=Counter)
    refused: Counter = field(default_factory=Counter)
    restarts_in_pulse: int = 0
    clean: dict[tuple[World, int], Step] = field(default_factory=dict)

    def wait(self, coil: int) -> float:
        """The longest time from any world until ``coil``, if demanded on and on, fires."""
        known: dict[World, float] = {}
        for start, demand in self.clean:
            if demand != coil:
                continue
            world, path = start, []
            while world not in known and self.clean[world, coil].fired != coil:
                known[world] = inf  # until it is known: who goes in a circle never fires
                path.append(world)
                world = self.clean[world, coil].then
            ticks = known.get(world, 0)
            for earlier in reversed(path):
                ticks += 1
                known[earlier] = ticks
        return max(known.values())


def relative(state: pulses.PulseState, view: actuator.CoilView, now: int) -> Own:
    first, second, third = (max(0, ready - now) for ready in state.ready_tick)
    word = tuple(min(lockout_ms, 1) for lockout_ms in view.lockout_ms)
    return Own((first, second, third), max(0, state.busy_until - now), word)


class Search:
    """The search. Each part of a tick sees little of the world, and is done once for many worlds."""

    def __init__(self, setup: Setup) -> None:
        self.setup = setup
        duration_ms = 1000 * setup.pulse_ticks
        identity = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        self.config = pulses.PulseConfig(
            pulse_ticks=setup.pulse_ticks,
            backoff_ticks=setup.backoff_ticks,
            duration_ms=duration_ms,
            shared=setup.shared,
            levels_am2=(1.0, 2.0, 3.0),
            pulse_s=1.0,
            tick_s=1.0,
            leak_s=inf,
            rate_metric=identity,
            energy_metric=identity,
        )
        self.coils = actuator.ActuatorConfig(self.config, dipoles=None)
        self.limits = interlock.CoilLimits(1, duration_ms, 1000 * setup.backoff_ticks, setup.shared)
        self.words, self.decide, self.ask = cache(self._words), cache(self._decide), cache(self._ask)
        self.drive = cache(self._drive)
        self.proof = Proof()

    def run(self) -> Proof:
        """Everything that can be reached from boot; AssertionError at the first world that breaks a limit."""
        first = World(self._boot(0), self._booted(), Judge(), 0, new=True)
        seen = {first}
        queue = deque(seen)
        while queue:
            for world in self._reached_from(queue.popleft()):
                if world not in seen:
                    seen.add(world)
                    queue.append(world)
            assert len(seen) < 200_000, "the worlds do not end"
        self.proof.worlds = seen
        return self.proof

    def _reached_from(self, world: World) -> Iterator[World]:
        """Restarts, the dead-man, which take no time, and a tick with every demand and fate of messages."""
        own, board, judge, phase, new = world
        faults, proof = self.setup.faults, self.proof
        if self.setup.board_restarts:
            yield world._replace(board=self._booted(), new=True)
        if faults:
            yield world._replace(board=numbers_of(after_silence(Interlock(*board), self.limits)))
            if self.setup.restart_in_pulse or judge.on is None:
                proof.restarts_in_pulse += judge.on is not None
                yield world._replace(own=self._boot(phase))
        for status, boot in self.words(board, phase, new):
            for (then, request), demands in self.decide(own, phase, status, boot):
                fired, asked = None, board
                if request is not None:
                    asked, reason = self.ask(board, request, phase)
                    if reason is None:
                        fired = request.coil
                        proof.accepted[fired] += 1
                    else:
                        proof.refused[reason] += 1
                    if faults:
                        yield self._next(world, then, board)
                        yield self._next(world, then, self.ask(asked, request, phase)[0])
                after = self._next(world, then, asked)
                yield after
                if status is not None and (boot is not None) == new:
                    proof.clean.update({(world, demand): Step(fired, after) for demand in demands})

    def _next(self, world: World, own: Own, board: Numbers) -> World:
        board_then, judge = self.drive(board, world.judge)
        return World(own, board_then, judge, (world.phase + 1) % 3)

    def _boot(self, phase: int) -> Own:
        tick = EPOCH + phase
        return relative(pulses.boot(tick, self.config), actuator.CoilView(), tick)

    def _booted(self) -> Numbers:
        return numbers_of(interlock.boot(self.limits))

    def _words(self, board: Numbers, phase: int, new: bool) -> list[Heard]:
        """What the scheduler may receive in this tick; None where it is lost."""
        coil = board.coil if board.level else phase
        remaining_ms = self.limits.milliseconds(board.remaining)
        lockout_ms = self.limits.milliseconds(board.lockout[coil], 10)
        said = CoilStatus(board.level, coil, remaining_ms, 0, lockout_ms, board.seq or 0)
        boot = CoilBoot(0, 1, 0) if new else None
        if not self.setup.faults:
            return [(said, boot)]
        return list(product((said, None), (boot, None) if new else (None,)))

    def _decide(self, own: Own, phase: int, status: CoilStatus | None, boot: CoilBoot | None) -> list[tuple]:
        """Each outcome, the scheduler afterwards and what it asks, with the demands that lead to it."""
        tick = EPOCH + phase
        ready_tick, busy_until = tuple(tick + left for left in own.ready), tick + own.busy
        readings = measured(coil=status, coil_boot=boot)
        outcomes: dict[tuple[Own, CoilFire | None], list[int | None]] = {}
        for demand, (owed, b_body_t) in DEMANDS.items():
            state = pulses.PulseState(ready_tick, busy_until, owed)
            view = actuator.CoilView(lockout_ms=own.word)
            actuator.update_view(view, readings, tick, self.coils)
            request = actuator.actuate(state, view, Demand(), b_body_t, readings, tick, self.coils)
            outcomes.setdefault((relative(state, view, tick + 1), request), []).append(demand)
        return list(outcomes.items())

    def _ask(self, board: Numbers, request: CoilFire, phase: int) -> tuple:
        """The board after the request, as it comes off the bus, and why it was refused."""
        fire = CoilFire.decode(request.encode().data)
        after, reason = after_request(Interlock(*board), fire, EPOCH + phase, self.limits)
        assert reason is not None or board.remaining == 0, "two coils on: a pulse into another"
        return numbers_of(after), reason

    def _drive(self, board: Numbers, judge: Judge) -> tuple[Numbers, Judge]:
        """One tick on, watched by the judge; nothing is kept that no rule can see."""
        driven = min(board.remaining, interlock.UNITS_PER_TICK)
        judge = judge.watch(board.coil, board.level, driven, self.setup)
        after = numbers_of(after_ticks(Interlock(*board), 1))
        coil, seq = after.coil if after.level else 0, None if after.seq is None else 0
        return after._replace(coil=coil, seq=seq), judge


@pytest.fixture(scope="session")
def search():
    """Searches everything that can be reached under a setup, and returns what it has seen.

    The last two are kept: what follows may ask for more of the same.
    """

    def searched(setup):
        with pytest.MonkeyPatch.context() as patch:
            for plant in setup.bugs:
                plant(patch)
            return Search(setup).run()

    return lru_cache(maxsize=2)(searched)


@pytest.fixture
def small():
    """The setup that is searched for a kind of back-off (True: shared): as large as time allows."""
    return {True: Setup(True, 3, 7), False: Setup(False, 2, 4)}
