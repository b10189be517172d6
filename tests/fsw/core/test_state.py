"""The checksum of the flight state: whatever bit of the state changes, it shows on the bus."""

from dataclasses import replace

import numpy as np
import pytest
from batch_samples import search_under_way
from flight_states import altered

from fsw.core.actuation.wheel import WheelView
from fsw.core.fdir.sensors.standstill import Displacement, ReadingMotion
from fsw.core.orbit.elements import Elements, Upload
from fsw.core.packing import checksum, copy_state, field_names
from fsw.core.state import FlightState
from fsw.core.step import boot
from fsw.wire.messages import Element

ELEMENTS = Elements(
    16521.0, 0.11593543, 98.6946, 36.4208, 0.0008932, 173.8349, 186.2944, 14.30166407, 1.1414e-4
)


def with_motion(health, motion):
    """The health with this motion behind readings that stand still, None: of continuous sensors."""
    health = copy_state(health)
    health.sensors.memory.motion = motion
    return health


@pytest.fixture(scope="module")
def run(make_world):
    """A state in which everything has happened: ephemeris, estimate, search, pulse, a law that remembers."""
    world = make_world(control={"law": "pd"})
    world.fly(230)
    state = altered(world.state, orbit=ELEMENTS, upload=Upload().with_element(Element.BSTAR, 1e-5))
    assert state.estimator.estimate.trace is not None
    first, batch = state.estimator.estimate.parameters, search_under_way()
    state = altered(state, estimator=replace(state.estimator, first=first, batch=batch))
    state = altered(state, wheel=WheelView(123.5, 229, 2e-4, -3e-4, 2, known=True))
    by_field, by_sun = Displacement((3e-7, -2e-7, 1e-7), 4e-9), Displacement((0.002, 0.003, -0.001), 5e-5)
    motion = ReadingMotion(by_field, by_sun)
    state = altered(state, health=with_motion(state.health, motion))
    assert state.coil.fired_tick >= 0
    assert any(state.pulses.owed_impulse_body_nms)
    assert state.memory
    return state


def test_every_number_of_the_state_counts(run, blind_places):
    assert blind_places(run) == []


def test_the_walk_reaches_every_field(run, leaves):
    """So that a field added to the state is in the test above by itself."""
    paths = [path for path, *_ in leaves(run)]
    assert {path.split(".")[1] for path in paths} == set(field_names(FlightState))
    assert len(paths) == len(set(paths)) > 250


def test_every_number_of_a_boot_state_counts_too(make_world, blind_places):
    assert blind_places(boot(make_world().config)) == []


def test_what_is_not_there_differs_from_what_is(run):
    without_estimate = altered(run, estimator=replace(run.estimator, estimate=None))
    without_first = altered(run, estimator=replace(run.estimator, first=None))
    without_ephemeris = altered(run, ephemeris=None)
    motions = (None, ReadingMotion())
    without_motion, at_rest = (altered(run, health=with_motion(run.health, motion)) for motion in motions)
    without_orbit = altered(run, orbit=None)
    without = (without_estimate, without_first, without_ephemeris, without_motion, without_orbit)
    sums = {checksum(state) for state in (run, at_rest, *without)}
    assert len(sums) == 7


def test_numbers_that_change_places_are_noticed(run):
    """A sum over the numbers would not notice."""
    one, other = ({"rejected": 7, "missed": 3}, {"rejected": 3, "missed": 7})
    assert len({checksum(altered(run, gate=replace(run.gate, **counts))) for counts in (one, other)}) == 2


def test_equal_states_have_equal_checksums(run):
    assert checksum(copy_state(run)) == checksum(run)


def test_the_layout_of_an_array_in_memory_does_not_count(run):
    known = run.estimator.estimate
    turned = replace(known, covariance=np.asfortranarray(known.covariance))
    assert checksum(altered(run, estimator=replace(run.estimator, estimate=turned))) == checksum(run)


def test_it_has_32_bits(run):
    assert 0 <= checksum(run) < 2**32
