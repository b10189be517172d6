"""What is told of the first ticks, of an orbit without a position, and of a second sender."""

import pytest
from cell_samples import REFERENCE
from flight_states import altered
from gate_samples import measured

from fsw.core import telemetry
from fsw.core.estimation.estimator import Used
from fsw.core.events import Event, Happening
from fsw.core.gate.second_sender import SIGNS, SecondSenderWatch
from fsw.core.rates import RateGroup, RateTable
from fsw.core.step import boot
from fsw.wire.messages import CoilFire, NavQuality, NavRate, PlantEnd

EVERY = RateGroup(1)
RATES = RateTable(attitude=EVERY, quality=EVERY, parameter=EVERY, heartbeat=EVERY)
LEAP_TICKS = 60


@pytest.fixture(scope="module")
def state(make_world):
    return boot(make_world().config)


NOTHING = measured()


def told(before, after, readings=NOTHING):
    return telemetry.happenings(telemetry.Before(before), after, readings, None, LEAP_TICKS)


@pytest.mark.parametrize(("tick", "events"), [(-1, []), (0, [Happening(Event.FALSE_END, 7)])])
def test_an_end_is_false_from_the_second_tick_on(state, tick, events):
    ended = measured(end=PlantEnd(7, counter=3))
    assert told(altered(state, tick=tick), altered(state, tick=tick + 1), ended) == events


@pytest.mark.parametrize(("tick", "events"), [(-1, []), (0, [Happening(Event.PLANT_RESTARTED, 0)])])
def test_so_is_a_restart(state, tick, events):
    assert told(altered(state, tick=tick), altered(state, tick=10**9)) == events


def test_a_second_sender_is_told_once_with_the_identifier_that_named_it(state):
    suspected = altered(state, second_sender=SecondSenderWatch(SIGNS - 1, 8, NavRate.ID), tick=8)
    named = altered(state, second_sender=SecondSenderWatch(SIGNS, 9, CoilFire.ID), tick=9)
    assert told(suspected, named) == [Happening(Event.SECOND_SENDER, CoilFire.ID)]
    assert told(named, altered(named, tick=10)) == []
    assert told(named, altered(state, tick=10)) == []


@pytest.mark.parametrize(
    ("reference", "eclipse"),
    [(None, 1), (REFERENCE.replace(lit=False), 1), (REFERENCE.replace(lit=True), 0)],
)
def test_where_the_orbit_has_no_position_no_light_is_claimed(state, reference, eclipse):
    used = Used(field=True, sun=False, blanked=False)
    messages = telemetry.navigation_messages(state, used, reference, RATES)
    (quality,) = [message for message in messages if isinstance(message, NavQuality)]
    assert quality.eclipse == eclipse
