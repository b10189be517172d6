"""Monitors and modes joined: what is watched comes from where it should, and its trip is carried out."""

from dataclasses import replace
from math import degrees
from typing import NamedTuple

import pytest
from flight_states import altered

from fsw.core.algebra.vector import norm
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.events import Event
from fsw.core.fdir.coils.health import CoilHealth
from fsw.core.fdir.faults import SensorFault
from fsw.core.fdir.fdir import Health
from fsw.core.fdir.sensors.health import SensorHealth, Watch
from fsw.core.gate.second_sender import SIGNS, SecondSenderWatch
from fsw.core.modes import ModeState
from fsw.core.monitors import Monitor
from fsw.core.supervisor import supervise
from fsw.wire.messages import FswEvent, Mode

WELL = Attitude((0.5, -0.5, 0.5, 0.5), (0.01, -0.02, 0.03), 0.01, 1e-4, True)
TICK = 159


@pytest.fixture(scope="module")
def world(make_world):
    world = make_world()
    world.fly(TICK + 1)
    return world


class Supervision(NamedTuple):
    modes: ModeState
    violated: Monitor | None


@pytest.fixture
def supervised(world):
    """The modes after the supervision of a state with changes, in POINT, and the monitor that is violated."""

    def judge(attitude=WELL, mode=Mode.POINT, **changes):
        state = altered(world.state, modes=ModeState(mode), attitude=attitude, **changes)
        violated = supervise(state, world.config)
        assert state.violated == (violated or 0)
        return Supervision(state.modes, violated)

    return judge


def test_a_sound_state_stays_where_it_is(supervised):
    assert supervised().violated is None
    assert supervised().modes.mode is Mode.POINT
    assert supervised(UNKNOWN).violated is None


def test_the_attitude_is_the_one_of_this_tick(supervised):
    spinning = WELL.replace(omega_body_orbit_radps=(0.0, 0.6, 0.0))
    assert supervised(spinning).violated is Monitor.RATE_BOUNDED


@pytest.mark.parametrize(
    ("name", "monitor"), [("field_tick", Monitor.FIELD_FRESH), ("status_tick", Monitor.COIL_STATUS_FRESH)]
)
def test_freshness_is_counted_from_the_last_message(world, supervised, name, monitor):
    stale = world.config.stale_after_ticks
    assert supervised(**{name: TICK - stale + 1}).violated is None
    assert supervised(**{name: TICK - stale}).violated is monitor


def test_another_time_than_the_table_s_is_borne_twice_as_long(world, supervised):
    stale = 2 * world.config.stale_after_ticks
    assert supervised(time_tick=TICK - stale + 1).violated is None
    assert supervised(time_tick=TICK - stale).violated is Monitor.TIME_AGREES


def test_an_impulse_that_is_no_number_trips(world, supervised):
    pulses = replace(world.state.pulses, pending_impulse_body_nms=(0.0, float("nan"), 0.0))
    assert supervised(pulses=pulses).violated is Monitor.OWED_FINITE


def test_a_coil_that_was_not_requested_trips(supervised):
    stuck, strange = CoilHealth(stuck=True), CoilHealth(faults=(4, 1, 2), unrequested_ticks=1)
    assert supervised(health=Health(coils=stuck)).violated is Monitor.COIL_AS_COMMANDED
    assert supervised(health=Health(coils=strange)).violated is None


@pytest.mark.parametrize(("law", "leaves"), [("bdot", False), ("phasing", True)])
def test_without_field_and_attitude_only_a_law_without_feedback_leaves_safe(world, supervised, law, leaves):
    blind = Health(SensorHealth(field=Watch(SensorFault.FROZEN)))
    setpoint = replace(world.state.setpoint, law=law)
    modes = supervised(UNKNOWN, Mode.SAFE, health=blind, setpoint=setpoint).modes
    assert max(modes.held_since) == (TICK if leaves else -1)
    assert max(supervised(WELL, Mode.SAFE, health=blind, setpoint=setpoint).modes.held_since) == TICK


def test_an_orbit_that_is_not_known_trips(supervised):
    assert supervised(ephemeris=None).violated is Monitor.ORBIT_KNOWN


def test_a_second_sender_trips_once_it_is_named(supervised):
    signs = SecondSenderWatch(SIGNS, TICK, 0x080)
    assert supervised(second_sender=signs).violated is Monitor.NO_SECOND_SENDER
    assert supervised(second_sender=SecondSenderWatch(SIGNS - 1, signs.tick, signs.can_id)).violated is None


def test_a_trip_leads_to_safe_in_the_same_tick_and_is_counted(supervised):
    modes = supervised(ephemeris=None).modes
    assert (modes.mode, modes.trips, modes.since_tick) == (Mode.SAFE, 1, TICK)


FAST = WELL.replace(omega_body_orbit_radps=(0.0, 0.6, 0.0))


@pytest.mark.parametrize("mode", [Mode.ACQUIRE, Mode.POINT])
def test_too_fast_a_turn_trips_a_law_that_points(supervised, mode):
    modes = supervised(FAST, mode).modes
    assert (modes.mode, modes.trips) == (Mode.SAFE, 1)


def test_too_fast_a_turn_is_left_to_detumbling(supervised):
    """Nothing but coils ends it, and they are off in SAFE."""
    modes = supervised(FAST, Mode.DETUMBLE).modes
    assert (modes.mode, modes.trips) == (Mode.DETUMBLE, 0)
    assert max(supervised(FAST, Mode.SAFE).modes.held_since) == TICK, "on its way out"
    assert max(supervised(FAST, Mode.SAFE, ephemeris=None).modes.held_since) == -1
    assert supervised(FAST, Mode.DETUMBLE, ephemeris=None).modes.mode is Mode.SAFE


def test_a_rate_that_is_no_number_is_not_braked(supervised):
    endless = WELL.replace(omega_body_orbit_radps=(0.0, float("inf"), 0.0))
    assert supervised(endless, Mode.DETUMBLE).modes.mode is Mode.SAFE
    assert max(supervised(endless, Mode.SAFE).modes.held_since) == -1


@pytest.mark.long
def test_a_satellite_that_turns_too_fast_is_braked(make_world):
    """From SAFE, where the violation is reported, by B-dot; no trip keeps it there."""
    world = make_world(
        time={"tick_hz": 4},
        initial={"rate_degps": [24.0, 25.6, 19.2]},
        coils={"driver": "continuous", "max_dipole_am2": 40.0},
        flight={"estimator": {"rate_sigma_degps": 20.0}},
    )
    said = [message for replies in world.fly(800) for message in replies]
    told = [(m.event, m.argument) for m in said if isinstance(m, FswEvent)]
    assert told.index((Event.MONITOR_TRIPPED, Monitor.RATE_BOUNDED)) < told.index((Event.MODE_CHANGED, 1))
    modes = world.state.modes
    assert (modes.mode, modes.trips) == (Mode.DETUMBLE, 0)
    assert degrees(norm(world.plant.truth().omega_body_orbit_radps)) < 38.0, "of 40"
