"""Events of one kind no more often than once a time, and none lost without being counted."""

import pytest

from fsw.core.events import MOST_KINDS, Event, Happening, Throttle, throttle_events
from fsw.core.packing import pack
from fsw.wire.messages import FswEvent

REFUSED, OTHER = Happening(Event.REQUEST_REFUSED, 8), Happening(Event.REQUEST_REFUSED, 3)


def reports(happenings_by_tick, spacing=10):
    state, passed = Throttle(), []
    for tick, happenings in enumerate(happenings_by_tick):
        passed += [(tick, one) for one in throttle_events(state, happenings, tick, spacing)]
    return state, passed


@pytest.mark.requirement("REQ-EVENT-01")
def test_one_kind_once_a_time_and_the_others_are_counted():
    state, passed = reports([[REFUSED]] * 35)
    assert [tick for tick, _ in passed] == [0, 10, 20, 30]
    assert state.held_back == 31


def test_kinds_do_not_hide_each_other():
    state, passed = reports([[REFUSED, OTHER, Happening(Event.MODE_CHANGED, 0)]])
    assert [happening for _, happening in passed] == [REFUSED, OTHER, Happening(Event.MODE_CHANGED, 0)]
    assert state.held_back == 0


@pytest.mark.requirement("REQ-EVENT-01")
def test_a_quantity_that_jitters_is_one_kind():
    _, passed = reports([[Happening(Event.TIME_MISMATCH, tick)] for tick in range(20)])
    assert [happening.argument for _, happening in passed] == [0, 10]


def test_twice_in_one_tick_is_once():
    state, passed = reports([[REFUSED, REFUSED]])
    assert (len(passed), state.held_back) == (1, 1)


def test_without_a_spacing_everything_is_told_tick_by_tick():
    state, passed = reports([[REFUSED]] * 5, spacing=0)
    assert (len(passed), state.held_back) == (5, 0)


def test_what_is_remembered_is_bounded():
    state, passed = reports([[Happening(Event.SENSOR_ISOLATED, n) for n in range(1000)]] * 3)
    assert len(passed) == len(state.reported) == MOST_KINDS
    assert state.held_back == 3000 - MOST_KINDS


def test_a_quiet_tick_changes_nothing():
    state, _ = reports([[REFUSED]])
    before = pack(state)
    assert throttle_events(state, [], 99, 10) == []
    assert pack(state) == before


@pytest.mark.requirement("REQ-EVENT-01")
def test_a_clock_that_jitters_does_not_flood_the_bus(make_world):
    world = make_world()
    world.fly(20)
    events = []
    for tick in range(40):
        replies = world.step(lambda inbox, k=tick: inbox.replace(unix_time_s=inbox.unix_time_s + k))
        events += [m for m in replies if isinstance(m, FswEvent) and m.event == Event.TIME_MISMATCH]
    assert len(events) == 4
    assert world.state.events.held_back == 35
