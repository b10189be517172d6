"""Which reading of the current a coil is judged by: one at which it is certainly on."""

from dataclasses import replace
from math import copysign

import pytest
from gate_samples import measured

from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.dipoles import RequestedDipole
from fsw.core.events import Event
from fsw.core.fdir.coils.currents import judge_current
from fsw.core.fdir.coils.health import CoilHealth
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.core.monitors import Monitor
from fsw.wire.messages import CoilStatus, FswEvent, Mode
from sim.plant.coil_drive import CoilDrive
from sim.plant.interference import Interference

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


@pytest.mark.long
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


AMPERE = 0.3
"""Above the current of every level."""


class Stuck(Interference):
    """``AMPERE`` flow through one coil, whatever the board commands."""

    def __init__(self, coil):
        self.coil = coil

    def coil_drive(self, drive):
        flows = [AMPERE if coil == self.coil else drive.current_a[coil] for coil in range(3)]
        held = [AMPERE if coil == self.coil else drive.held_a[coil] for coil in range(3)]
        return CoilDrive(tuple(flows), drive.fraction, tuple(held))


@pytest.mark.requirement("REQ-TRIP-07")
class TestAContinuousDriverThatIsOnWhenTheCurrentIsRead:
    """Where the attitude is known without sensors the coils need not be off when those sample."""

    @pytest.fixture(
        params=[(1.0, 1), (0.99, 1), (0.8, 10), (0.8, 1)], ids=lambda case: "{} at {} Hz".format(*case)
    )
    def world(self, make_world, request):
        on_fraction, tick_hz = request.param
        coils = {"driver": "continuous", "max_dipole_am2": 12.0, "on_fraction": on_fraction}
        tumble = {"rate_degps": [1.5, -1.0, 1.2]}
        world = make_world(knowledge="perfect", coils=coils, time={"tick_hz": tick_hz}, initial=tumble)
        world.tick_hz = tick_hz
        return world

    def tripped(self, world, seconds):
        said = [message for tick in world.fly(seconds * world.tick_hz) for message in tick]
        events = [(m.event, m.argument) for m in said if isinstance(m, FswEvent)]
        return (Event.MONITOR_TRIPPED, Monitor.COIL_AS_COMMANDED) in events

    def test_its_requests_are_no_stray_current(self, world):
        assert not self.tripped(world, 120)
        assert world.state.modes.mode is not Mode.SAFE
        assert world.state.coil.requested.m_body_am2 != (0.0, 0.0, 0.0)

    @pytest.mark.parametrize("coil", [0, 1, 2])
    def test_a_coil_that_stays_on_is_named(self, world, coil):
        assert not self.tripped(world, 40)
        world.plant.interference = Stuck(coil)
        assert self.tripped(world, 120)


@pytest.mark.parametrize(
    ("asked_ma", "read_ma", "stray_ma"),
    [
        (100, 100, 0),
        (100, 37, 0),
        (100, 0, 0),
        (-100, -60, 0),
        (100, 150, 50),
        (100, -50, -50),
        (-100, 40, 40),
        (0, 40, 40),
    ],
)
def test_between_none_and_all_that_was_requested_any_current_may_flow(
    make_world, asked_ma, read_ma, stray_ma
):
    coils = {"driver": "continuous", "max_dipole_am2": 12.0, "on_fraction": 1.0}
    limits = make_world(knowledge="perfect", coils=coils).config.fdir.coils
    per_am2 = limits.left_ma_per_am2[0]
    view = CoilView(requested=RequestedDipole(TICK - 1, (asked_ma / per_am2, 0.0, 0.0)))
    health = CoilHealth()
    judge_current(health, view, measured(coil=CoilStatus(0, 1, 0, read_ma, 0, 0)), False, TICK, limits)
    assert health.stray_ma == (stray_ma if abs(stray_ma) > limits.stuck_ma else 0)
    late = CoilHealth()
    judge_current(late, view, measured(coil=CoilStatus(0, 1, 0, read_ma, 0, 0)), False, TICK + 1, limits)
    assert late.stray_ma == (read_ma if abs(read_ma) > limits.stuck_ma else 0), "a request is for one tick"
