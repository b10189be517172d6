"""A board with a clock of its own keeps invariant I under a random attack, and planted faults are found.

Twenty thousand requests as a rule; ``make attack`` makes a million.
"""

import os

import pytest
from coil_attack import SETUPS, attack
from compiled_guard import interpreted_alone

from hil_stub.bench import Bench, CoilBoard
from hil_stub.coils import guard
from hil_stub.coils.coil_driver import CoilDriver, CoilLimits
from hil_stub.coils.interlock import boot

pytestmark = interpreted_alone()

REQUESTS = int(os.environ.get("TORQUER_ATTACK_REQUESTS", "20000"))
SEED = int(os.environ.get("TORQUER_ATTACK_SEED", "20150327"))


def bench_of(setup):
    limits = CoilLimits(setup.tick_hz, setup.pulse_ms, setup.backoff_ms, setup.shared)
    return Bench(lambda: CoilBoard(limits), setup.deadman_ms, has_clock=True)


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("setup", SETUPS.values(), ids=SETUPS)
def test_no_attack_breaks_a_limit(setup, record_property):
    attacker, judge = attack(setup, bench_of(setup), REQUESTS // len(SETUPS), SEED)
    reports = {
        "requests": attacker.requests,
        "pulses": judge.pulses,
        "longest pulse ms": judge.longest_ms,
        "least gap ms": judge.least_gap_ms,
        "violations": len(judge.violations),
    }
    record_property("attack", reports)
    print(f"\n{setup}: {reports}")
    assert judge.violations == []
    assert judge.pulses >= attacker.requests // 25, "it was let fire: no proof by doing nothing"
    assert judge.longest_ms == setup.pulse_ms, "the longest pulse that is allowed was driven"
    assert judge.least_gap_ms == setup.backoff_ms, (
        "and the next began in the very millisecond in which it may"
    )


class DeafClock(guard.Guard):
    """Its clock goes on only when a tick begins."""

    def __init__(self, limits):
        super().__init__(limits)
        self._told_ms = None

    def pass_time(self, clock_ms):
        if self._by_clock is None:
            super().pass_time(clock_ms)
        self._told_ms = clock_ms

    def elapse(self, ticks):
        super().pass_time(self._told_ms)
        super().elapse(ticks)


class NoClock(guard.Guard):
    """It has ticks alone."""

    def pass_time(self, clock_ms):
        pass


class ClockUnasked(guard.Guard):
    """Its clock ends pulses, and refuses nothing."""

    def ask(self, request, tick):
        self._by_clock.remaining, self._by_clock.lockout = 0, (0, 0, 0)
        return super().ask(request, tick)


class LateSilence(guard.Guard):
    """The dead-man only switches off."""

    def silence(self):
        lockout = self._by_ticks.lockout
        super().silence()
        self._by_ticks.lockout, self._by_clock.lockout = lockout, (0, 0, 0)


class EarlyBoot(guard.Guard):
    """A board that restarts is soon free again."""

    def __init__(self, limits):
        super().__init__(limits)
        self._by_ticks = boot(guard.replace(limits, backoff_ms=limits.backoff_ms // 2))

    def pass_time(self, clock_ms):
        fresh = self._by_clock is None
        super().pass_time(clock_ms)
        if fresh:
            self._by_clock = boot(
                guard.replace(self._clock_limits, backoff_ms=self._clock_limits.backoff_ms // 2)
            )


PLANTED = {fault.__doc__: fault for fault in (DeafClock, NoClock, ClockUnasked, LateSilence, EarlyBoot)}


@pytest.mark.parametrize("fault", PLANTED.values(), ids=PLANTED)
def test_a_board_that_can_be_deceived_is_found(monkeypatch, fault):
    class Faulty(CoilDriver):
        def __init__(self, limits, read_back=None):
            super().__init__(limits, read_back)
            self._guard = fault(limits)

    monkeypatch.setattr("hil_stub.bench.CoilDriver", Faulty)
    setup = SETUPS["fast"]
    _, judge = attack(setup, bench_of(setup), 20_000, SEED, enough=lambda judge: judge.violations)
    assert judge.violations
