"""The checksum of the flight state: whatever bit of the state changes, it shows on the bus."""

from copy import deepcopy
from enum import Enum
from math import nextafter

import numpy as np
import pytest

from fsw.core.laws.table import LAWS
from fsw.core.orbit.elements import Elements, Upload
from fsw.core.state import FlightState, checksum
from fsw.core.step import boot
from fsw.wire.messages import Element

ELEMENTS = Elements(
    16521.0, 0.11593543, 98.6946, 36.4208, 0.0008932, 173.8349, 186.2944, 14.30166407, 1.1414e-4
)


@pytest.fixture(scope="module")
def flown(make_world):
    """A state in which everything has happened: ephemeris, estimate, a pulse, a law that remembers."""
    world = make_world(control={"law": "pd"})
    world.fly(230)
    state = world.state._replace(orbit=ELEMENTS, upload=Upload().with_element(Element.BSTAR, 1e-5))
    assert state.estimator.estimate.trace is not None
    assert state.coil.fired_tick >= 0
    assert any(state.pulses.owed_impulse_body_nms)
    assert state.memory
    return state


def nearest_other(leaf):
    """The value that differs least: the last bit of a float, the next integer, the other truth."""
    if isinstance(leaf, bool):
        return not leaf
    if isinstance(leaf, str):
        return next(law for law in LAWS if law != leaf)
    if isinstance(leaf, Enum):
        return next(member for member in type(leaf) if member is not leaf)
    return nextafter(leaf, 1e300) if isinstance(leaf, float) else leaf + 1


def test_every_number_of_the_state_counts(flown, leaves):
    before = checksum(flown)
    blind = [
        path for path, leaf, rebuild in leaves(flown) if checksum(rebuild(nearest_other(leaf))) == before
    ]
    assert blind == []


def test_the_walk_reaches_every_field(flown, leaves):
    """So that a field added to the state is in the test above by itself."""
    paths = [path for path, *_ in leaves(flown)]
    assert {path.split(".")[1] for path in paths} == set(FlightState._fields)
    assert len(paths) == len(set(paths)) > 250


def test_every_number_of_a_boot_state_counts_too(make_world, leaves):
    state = boot(make_world().config)
    before = checksum(state)
    known = [(path, leaf, rebuild) for path, leaf, rebuild in leaves(state) if leaf is not None]
    assert [path for path, leaf, rebuild in known if checksum(rebuild(nearest_other(leaf))) == before] == []


def test_what_is_not_there_differs_from_what_is(flown):
    without_estimate = flown._replace(estimator=flown.estimator._replace(estimate=None))
    without_ephemeris = flown._replace(ephemeris=None)
    without_orbit = flown._replace(orbit=None)
    sums = {checksum(state) for state in (flown, without_estimate, without_ephemeris, without_orbit)}
    assert len(sums) == 4


def test_numbers_that_change_places_are_noticed(flown):
    """A sum over the numbers would not notice."""
    one, other = ({"rejected": 7, "missed": 3}, {"rejected": 3, "missed": 7})
    assert len({checksum(flown._replace(gate=flown.gate._replace(**counts))) for counts in (one, other)}) == 2


def test_equal_states_have_equal_checksums(flown):
    assert checksum(deepcopy(flown)) == checksum(flown)


def test_the_layout_of_an_array_in_memory_does_not_count(flown):
    known = flown.estimator.estimate
    turned = known._replace(covariance=np.asfortranarray(known.covariance))
    assert checksum(flown._replace(estimator=flown.estimator._replace(estimate=turned))) == checksum(flown)


def test_it_has_32_bits(flown):
    assert 0 <= checksum(flown) < 2**32


def test_a_state_cannot_be_changed_in_place(flown):
    with pytest.raises(AttributeError):
        flown.tick = 5
