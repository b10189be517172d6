"""The checksum of the flight state: whatever bit of the state changes, it shows on the bus."""

from dataclasses import is_dataclass, replace
from math import inf, nan
from types import NoneType
from typing import get_args, get_type_hints

import numpy as np
import pytest
from batch_samples import search_under_way
from flight_states import altered

from fsw.core.actuation.wheel import WheelView
from fsw.core.fdir.sensors.standstill import Displacement, ReadingMotion
from fsw.core.orbit.elements import Elements, Upload
from fsw.core.packing import copy_state, field_names
from fsw.core.state import FlightState
from fsw.core.state_bytes import checksum, state_bytes
from fsw.core.step import boot
from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.messages import Element
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import flight_table, load

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
    state = altered(state, wheel=WheelView(123.5, 229, 2e-4, -3e-4, 2, has_speed=True))
    by_field, by_sun = Displacement((3e-7, -2e-7, 1e-7), 4e-9), Displacement((0.002, 0.003, -0.001), 5e-5)
    motion = ReadingMotion(by_field, by_sun)
    state = altered(state, health=with_motion(state.health, motion))
    assert state.coil.fired_tick >= 0
    assert any(state.pulses.pending_impulse_body_nms)
    assert state.memory
    return state


def test_every_number_of_the_state_counts(run, blind_places):
    assert blind_places(run, state_bytes) == []


def test_the_walk_reaches_every_field(run, leaves):
    """So that a field added to the state is in the test above by itself."""
    paths = [path for path, *_ in leaves(run)]
    assert {path.split(".")[1] for path in paths} == set(field_names(FlightState))
    assert len(paths) == len(set(paths)) > 250


def test_every_number_of_a_boot_state_counts_too(make_world, blind_places):
    assert blind_places(boot(make_world().config), state_bytes) == []


@pytest.mark.long
@pytest.mark.parametrize("name", ["microsat", "cubesat-cells", "microsat-wheel", "realsat", "kalman-50kg"])
def test_every_number_counts_in_the_middle_of_a_flight(name, blind_places):
    """Of filters with few and with many parameters, a batch of samples, a wheel, a law that remembers."""
    scenario = load(name)
    plant, node = Plant(plant_config(scenario, 3)), FlightNode(flight_config(flight_table(scenario)))
    for _ in range(220):
        for frame in plant.begin_tick():
            for answer in node.receive(frame):
                plant.receive(answer)
        plant.end_tick()
    assert blind_places(node.state, state_bytes) == []


def fields_of(value, path=""):
    """(path, object, field) for every field of the objects in a state, but for those in lists and tuples."""
    for field in field_names(type(value)) if is_dataclass(value) else ():
        yield f"{path}.{field}", value, field
        yield from fields_of(getattr(value, field), f"{path}.{field}")


def may_be_none(value, field):
    return NoneType in get_args(get_type_hints(type(value))[field])


@pytest.mark.interpreted
def test_what_is_not_there_differs_from_what_is(run):
    state, before = copy_state(run), state_bytes(run)
    optional = [(path, value, field) for path, value, field in fields_of(state) if may_be_none(value, field)]
    assert len(optional) >= 7
    for path, value, field in optional:
        part = getattr(value, field)
        assert part is not None, path
        setattr(value, field, None)
        assert state_bytes(state) != before, path
        setattr(value, field, part)
    assert state_bytes(state) == before


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


def test_what_is_one_item_longer_differs(run):
    """Also where the item is zero, and what follows is zero too."""
    for field, item in (("memory", 0.0), ("sent", 0)):
        shorter = type(getattr(run, field))([item])
        sums = {checksum(altered(run, **{field: shorter * length})) for length in range(4)}
        assert len(sums) == 4


def test_zero_counts_by_its_sign_and_no_number_is_a_value(run):
    sums = {checksum(altered(run, memory=(number,))) for number in (0.0, -0.0, inf, -inf, nan, 5e-324)}
    assert len(sums) == 6


def test_a_number_counts_by_its_value_whether_it_is_whole(run):
    assert checksum(altered(run, memory=(1,))) == checksum(altered(run, memory=(1.0,)))


def test_an_integer_that_has_no_place_in_64_bits_is_refused(run):
    assert checksum(altered(run, tick=2**63 - 1)) != checksum(altered(run, tick=-(2**63)))
    with pytest.raises((OverflowError, ValueError), match="too large"):
        checksum(altered(run, tick=2**63))


def test_it_has_32_bits(run):
    assert 0 <= checksum(run) < 2**32
