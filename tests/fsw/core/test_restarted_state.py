"""What of the flight state stays and what begins anew when the plant has restarted, field by field."""

from dataclasses import replace

import pytest
from flight_states import altered

from fsw.core.actuation.actuator import LOCKOUT_UNKNOWN, CoilView
from fsw.core.actuation.pulses import boot
from fsw.core.actuation.wheel import WheelView
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.events import Event, Happening, LastReport, Throttle, throttle_events
from fsw.core.gate.second_sender import SecondSenderWatch
from fsw.core.laws.interface import FieldSample
from fsw.core.modes import ModeState
from fsw.core.packing import copy_state
from fsw.core.restart import begin_count
from fsw.wire.messages import Mode

REACHED, NEW = 5000, 3
"""Tick that was reached, and the first of the new count."""
SPACING = 10


@pytest.fixture(scope="module")
def world(make_world):
    return make_world()


@pytest.fixture(scope="module")
def after(world):
    before = altered(
        world.state,
        tick=REACHED,
        attitude=Attitude((0.8, 0.36, -0.288, 0.384), (0.01, -0.02, 0.03), 0.02, 3e-4, True),
        sample=FieldSample((2e-5, -7e-6, 3e-5), REACHED - 1),
        memory=(1.0, -2.0, 3.0),
        pulses=replace(world.state.pulses, pending_impulse_body_nms=(1e-4, -2e-4, 3e-4)),
        coil=CoilView((17, 18, 19), seq=201, refusals=4, past_am2=((1.0, -2.0, 3.0),)),
        events=Throttle([LastReport(Event.REQUEST_REFUSED, 8, REACHED - 4)], held_back=9),
        modes=ModeState(Mode.POINT, REACHED - 70, trips=2),
        wheel=WheelView(refused=5),
    )
    begin_count(before, NEW, world.config)
    return before


def test_nothing_is_known_of_attitude_and_field_and_no_law_remembers(after):
    assert after.tick == -1
    assert after.attitude == UNKNOWN
    assert after.sample == FieldSample()
    assert after.memory == ()
    assert after.ephemeris is None


def test_every_timer_starts_in_full_and_no_impulse_is_owed(after, world):
    assert after.pulses == boot(NEW, world.config.coils.pulses)
    assert after.coil.lockout_ms == LOCKOUT_UNKNOWN
    assert after.modes == ModeState(Mode.SAFE, NEW, trips=2)


def test_requests_go_on_to_be_counted(after):
    assert after.coil == CoilView(seq=201, refusals=4)
    assert after.wheel == WheelView(refused=5)


def test_without_a_sign_there_is_no_second_sender(after):
    assert after.second_sender == SecondSenderWatch()


def test_an_event_is_held_back_for_the_rest_of_its_time(after):
    refused = Happening(Event.REQUEST_REFUSED, 8)
    for tick in range(NEW, NEW + SPACING - 4):
        assert throttle_events(copy_state(after.events), [refused], tick, SPACING) == []
    throttle = copy_state(after.events)
    assert throttle_events(throttle, [refused], NEW + SPACING - 4, SPACING) == [refused]
    assert throttle.held_back == 9
