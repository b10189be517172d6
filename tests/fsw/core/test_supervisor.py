"""Monitors and modes joined: what is watched comes from where it should, and its trip is carried out."""

from typing import NamedTuple

import pytest

from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.fdir.coils.health import CoilHealth
from fsw.core.fdir.fdir import Health
from fsw.core.gate.second_sender import SIGNS, SecondSenderWatch
from fsw.core.modes import ModeState
from fsw.core.monitors import Monitor
from fsw.core.supervisor import supervise
from fsw.wire.messages import Mode

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

    def judge(attitude=WELL, **changes):
        state = world.state._replace(modes=ModeState(Mode.POINT), attitude=attitude, **changes)
        after, violated = supervise(state, world.config)
        return Supervision(after.modes, violated)

    return judge


def test_a_sound_state_stays_where_it_is(supervised):
    assert supervised().violated is None
    assert supervised().modes.mode is Mode.POINT
    assert supervised(UNKNOWN).violated is None


def test_the_attitude_is_the_one_of_this_tick(supervised):
    spinning = WELL._replace(omega_body_orbit_radps=(0.0, 0.6, 0.0))
    assert supervised(spinning).violated is Monitor.RATE_BOUNDED


@pytest.mark.parametrize(
    ("name", "monitor"), [("field_tick", Monitor.FIELD_FRESH), ("status_tick", Monitor.COIL_STATUS_FRESH)]
)
def test_freshness_is_counted_from_the_last_message(world, supervised, name, monitor):
    stale = world.config.stale_after_ticks
    assert supervised(**{name: TICK - stale + 1}).violated is None
    assert supervised(**{name: TICK - stale}).violated is monitor


def test_an_impulse_that_is_no_number_trips(world, supervised):
    pulses = world.state.pulses._replace(owed_impulse_body_nms=(0.0, float("nan"), 0.0))
    assert supervised(pulses=pulses).violated is Monitor.OWED_FINITE


def test_a_coil_that_was_not_requested_trips(supervised):
    stuck, strange = CoilHealth(stuck=True), CoilHealth(faults=(4, 1, 2), strange_ticks=1)
    assert supervised(health=Health(coils=stuck)).violated is Monitor.COIL_AS_COMMANDED
    assert supervised(health=Health(coils=strange)).violated is None


def test_an_orbit_that_is_not_known_trips(supervised):
    assert supervised(ephemeris=None).violated is Monitor.ORBIT_KNOWN


def test_a_second_sender_trips_once_it_is_named(supervised):
    signs = SecondSenderWatch(SIGNS, TICK, 0x080)
    assert supervised(second_sender=signs).violated is Monitor.NO_SECOND_SENDER
    assert supervised(second_sender=signs._replace(signs=SIGNS - 1)).violated is None


def test_a_trip_leads_to_safe_in_the_same_tick_and_is_counted(supervised):
    modes = supervised(ephemeris=None).modes
    assert (modes.mode, modes.trips, modes.since_tick) == (Mode.SAFE, 1, TICK)
