"""The flight loop when the orbit has ended, or its ephemeris is spoiled."""

from math import acos, degrees, inf, nan

import pytest
from flight_states import altered, stepped
from replies import of

from fsw.core.fdir.sensors.pair import Standing
from fsw.core.orbit.ephemeris import advance
from fsw.core.state import Inbox
from fsw.core.state_bytes import checksum
from fsw.core.telemetry import Event
from fsw.wire.messages import (
    CoilFire,
    FswEvent,
    Mode,
    TickDone,
)


def test_an_orbit_that_has_decayed_leads_to_safe(make_world, decaying):
    """A month on, SGP4 has no position for these elements any more: reported, safe, and no exception."""
    world = make_world(orbit={"tle": list(decaying)})
    world.fly(40)
    assert world.state.modes.mode is not Mode.SAFE
    tick = 30 * 86400
    world.state = altered(world.state, tick=tick - 1, field_tick=tick - 1, status_tick=tick - 1)
    inbox = Inbox(tick, world.config.epoch_unix_s + tick, world.inbox().frames)
    state, outbox = stepped(world.state, inbox, world.config)
    assert state.modes.mode is Mode.SAFE
    assert state.ephemeris is None
    assert not state.attitude.valid
    assert outbox[-1] == TickDone(tick, checksum(state)).encode()
    reports = [FswEvent.decode(frame.data) for frame in outbox if frame.can_id == FswEvent.ID]
    assert (Event.MONITOR_TRIPPED, 8) in [(message.event, message.argument) for message in reports]


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("vector", ["r_eci_m", "v_eci_mps", "b_eci_t", "sun_eci"])
@pytest.mark.parametrize("broken", [nan, inf])
def test_an_ephemeris_of_what_is_no_number_is_made_anew(make_world, vector, broken):
    world = make_world()
    world.fly(205)
    assert world.state.attitude.valid
    whole = world.state.ephemeris
    spoiled = whole.nodes[1].replace(**{vector: (broken, 1.0, 1.0)})
    world.state = altered(
        world.state, ephemeris=whole.replace(nodes=(whole.nodes[0], spoiled, *whole.nodes[2:]))
    )
    replies = world.step()
    assert not world.state.attitude.valid
    assert not of(CoilFire, replies)
    world.fly(2)
    assert world.state.ephemeris.nodes[1] == whole.nodes[1]
    assert world.state.estimator.estimate is not None
    world.fly_until_valid()


@pytest.mark.interpreted
@pytest.mark.long
def test_after_a_time_without_a_position_the_old_estimate_is_not_the_present_one(make_world, monkeypatch):
    """Nothing has carried it on: it ends, and until a new one is proven no attitude is valid."""
    world, there = make_world(), advance
    world.fly(1200)
    assert world.state.attitude.valid
    monkeypatch.setattr("fsw.core.step.advance", lambda *given: None)
    world.step()
    assert world.state.estimator.estimate is None
    assert world.state.health.sensors.pair.standing is Standing.NEW
    world.fly(999)
    assert world.state.estimator.restarts == 1
    monkeypatch.setattr("fsw.core.step.advance", there)
    for _ in range(300):
        q = world.plant.truth().q_body_from_orbit
        world.step()
        known = world.state.attitude
        cosine = abs(sum(a * b for a, b in zip(q, known.q_body_from_orbit, strict=True)))
        assert not known.valid or 2.0 * degrees(acos(min(1.0, cosine))) < 5.0
    world.fly_until_valid(3000)  # the Earth's shadow is in between


@pytest.mark.interpreted
def test_a_tick_without_a_position_ends_the_estimate(make_world, monkeypatch):
    world, there = make_world(), advance
    world.fly(40)
    assert world.state.estimator.estimate is not None
    monkeypatch.setattr("fsw.core.step.advance", lambda *given: None)
    told = of(FswEvent, world.step()) + of(FswEvent, world.step())
    assert [message.argument for message in told if message.event == Event.FILTER_RESTARTED] == [1]
    assert world.state.estimator.estimate is None
    monkeypatch.setattr("fsw.core.step.advance", there)
    world.step()
    assert world.state.estimator.estimate is not None
