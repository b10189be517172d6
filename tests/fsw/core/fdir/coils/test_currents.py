"""Which reading of the current a coil is judged by: one at which it is certainly on."""

from dataclasses import replace
from math import copysign

import pytest
from gate_samples import measured

from fsw.core.actuation.actuator import CoilView
from fsw.core.fdir.coils.currents import judge_current
from fsw.core.fdir.coils.health import CoilHealth
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.wire.messages import CoilStatus

TICK = 700
FIRED = CoilView(fired_tick=TICK, fired=Pulse(1, -3))


@pytest.fixture
def judged_at(make_world):
    """The ticks after a request at which a reading without current speaks against the coil."""
    limits = make_world().config.fdir.coils

    def ticks(pulse_ticks, duration_ms, tick_s=1.0, remaining=lambda left_ms: max(0, left_ms)):
        pulses = replace(limits.pulses, pulse_ticks=pulse_ticks, duration_ms=duration_ms, tick_s=tick_s)
        config, found = replace(limits, pulses=pulses), []
        for after in range(1, pulse_ticks + 3):
            left_ms = remaining(duration_ms - round(1000.0 * after * tick_s))
            readings = measured(coil=CoilStatus(-3, 1, left_ms, 0, 0, 1))
            health = CoilHealth()
            judge_current(health, FIRED, readings, False, TICK + after, config)
            if health.nats != CoilHealth().nats:
                assert health.nats == (0.0, 0.5 * limits.weak.threshold, 0.0)
                found.append(after)
        return found

    return ticks


@pytest.mark.parametrize(
    ("pulse_ticks", "duration_ms", "tick_s"),
    [(3, 3000, 1.0), (4, 1333, 1 / 3), (29, 966, 1 / 30), (2, 20, 0.01)],
    ids=["whole ticks", "floored", "long and floored", "two ticks"],
)
def test_it_is_the_last_one_before_the_end(judged_at, pulse_ticks, duration_ms, tick_s):
    assert judged_at(pulse_ticks, duration_ms, tick_s) == [pulse_ticks - 1]


def test_none_where_the_pulse_has_ended_early(judged_at):
    assert judged_at(3, 3000, remaining=lambda left_ms: 0) == []


def test_of_one_whole_tick_that_at_its_end(judged_at):
    assert judged_at(1, 1000) == [1]


def test_of_one_that_ends_before_its_only_tick_none(judged_at):
    assert judged_at(1, 333, 1 / 3) == []


def test_a_sound_coil_whose_pulse_ends_just_before_the_tick_is_not_named(make_world):
    """At 3 Hz: 1333 ms of 1333.3 ms, and a current that is gone in a tenth of a ms."""
    coils = {"pulse_s": 1.4, "time_constant_s": 1e-4, "backoff_s": 20.0, "backoff": "shared"}
    world = make_world(time={"tick_hz": 3}, coils=coils)
    world.fly(450)
    assert world.state.coil.seq >= 3
    assert world.state.health.coils.faults == (0, 0, 0)


@pytest.mark.parametrize(
    ("level", "part", "speaks_against"),
    [(-3, 1.0, False), (-3, -1.0, True), (3, -1.0, True), (1, 1.0, False), (2, 1.0, False), (-2, 0.4, True)],
)
def test_it_is_judged_by_the_current_of_its_level_and_its_sign(make_world, level, part, speaks_against):
    limits = make_world().config.fdir.coils
    nominal_ma = copysign(limits.current_ma[abs(level) - 1], level)
    view = CoilView(fired_tick=TICK, fired=Pulse(1, level))
    said = measured(coil=CoilStatus(level, 1, 1000, round(part * nominal_ma), 0, 1))
    health = CoilHealth(nats=(0.0, 1.0, 0.0))
    judge_current(health, view, said, False, TICK + limits.pulses.pulse_ticks - 1, limits)
    assert health.nats[1] == (1.0 + 0.5 * limits.weak.threshold if speaks_against else 0.0)
