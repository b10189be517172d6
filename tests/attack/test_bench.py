"""A board with a clock of its own keeps invariant I under a random attack, and planted faults are found.

Twenty thousand requests as a rule; ``make attack`` makes a million.
"""

import os
from random import Random

import pytest
from compiled_guard import interpreted_alone

from hil_stub.bench import Bench, CoilBoard
from hil_stub.coils import guard
from hil_stub.coils.coil_driver import CoilDriver, CoilLimits
from hil_stub.coils.interlock import boot

pytestmark = interpreted_alone()

REQUESTS = int(os.environ.get("TORQUER_ATTACK_REQUESTS", "20000"))
SEED = int(os.environ.get("TORQUER_ATTACK_SEED", "20150327"))

SETUPS = {
    "as it flies": (1, 3000, 100_000, True, 5000),
    "per coil": (1, 3000, 100_000, False, 5000),
    "fast": (10, 300, 2000, True, 500),
    "fast, per coil": (10, 300, 2000, False, 500),
    "pulses that are no whole ticks": (8, 437, 1999, True, 700),
    "ticks longer than a pulse": (2, 333, 1111, False, 1700),
    "no dead-man to speak of": (4, 1000, 3000, True, 3_600_000),
    "a dead-man quicker than a pulse": (20, 900, 1500, True, 300),
}


class SimulatedTarget:
    """A bench in simulated time. The judge looks at its pin at each event and around the ends of pulses."""

    def __init__(self, setup, judge):
        self._setup, self._judge = setup, judge
        self._now_ms = 0
        self._on_ms = self._off_ms = None
        self._last = None
        limits = CoilLimits(setup.tick_hz, setup.pulse_ms, setup.backoff_ms, setup.shared)
        self._bench = Bench(lambda: CoilBoard(limits), setup.deadman_ms, has_clock=True)
        self.restart()

    def now_ms(self):
        return self._now_ms

    def off_at_ms(self):
        return self._off_ms

    def send(self, frame):
        self._bench.receive(frame, self._now_ms)
        self._look()

    def restart(self):
        self._bench.switch_on(now_ms=self._now_ms)
        self._look()

    def wait(self, milliseconds):
        end_ms = self._now_ms + milliseconds
        while self._now_ms < end_ms:
            self._now_ms = min([end_ms, *(at for at in self._sights_ms() if at > self._now_ms)])
            self._bench.watch(self._now_ms)
            self._look()

    def _sights_ms(self):
        """When a pin that is on is worth a look: when its timer ends it, and when it must be off."""
        pin = self._bench.pin
        if pin is None:
            return ()
        over_ms = self._on_ms + self._setup.pulse_ms
        timer_ms = () if pin.until_ms is None else (pin.until_ms - 1, pin.until_ms)
        return (*timer_ms, over_ms - 1, over_ms)

    def _look(self):
        pin = self._bench.pin
        on = None if pin is None else (pin.coil, pin.level)
        if on is not None and self._last is None:
            self._on_ms = self._now_ms
        if on is not None:
            self._off_ms = pin.until_ms
        elif self._last is not None:
            self._off_ms = self._now_ms
        self._last = on
        self._judge.see(self._now_ms, on)


def attack(tools, values, requests, seed, enough=lambda judge: False):
    """Until so many requests have been made: attacker and judge."""
    attacker_of, judge_of, setup_of = tools
    setup = setup_of(*values)
    judge = judge_of(setup)
    attacker = attacker_of(SimulatedTarget(setup, judge), setup, Random(f"{seed}/{values}"))
    while attacker.requests < requests and not enough(judge):
        attacker.move()
    return attacker, judge


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("values", SETUPS.values(), ids=SETUPS)
def test_no_attack_breaks_a_limit(tools, values, record_property):
    attacker, judge = attack(tools, values, REQUESTS // len(SETUPS), SEED)
    reports = {
        "requests": attacker.requests,
        "pulses": judge.pulses,
        "longest pulse ms": judge.longest_ms,
        "least gap ms": judge.least_gap_ms,
        "violations": len(judge.violations),
    }
    record_property("attack", reports)
    print(f"\n{values}: {reports}")
    assert judge.violations == []
    assert judge.pulses >= attacker.requests // 25, "it was let fire: no proof by doing nothing"
    assert judge.longest_ms == values[1], "the longest pulse that is allowed was driven"
    assert judge.least_gap_ms == values[2], "and the next began in the very millisecond in which it may"


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
def test_a_board_that_can_be_deceived_is_found(tools, monkeypatch, fault):
    class Faulty(CoilDriver):
        def __init__(self, limits, read_back=None):
            super().__init__(limits, read_back)
            self._guard = fault(limits)

    monkeypatch.setattr("hil_stub.bench.CoilDriver", Faulty)
    _, judge = attack(tools, SETUPS["fast"], 20_000, SEED, enough=lambda judge: judge.violations)
    assert judge.violations
