"""A dotted key reads and sets a value, also one element of a list."""

import pytest

from sim.campaign.definition.keys import nominal_values, value_at, with_value
from sim.scenario.schema import load

NOMINAL = {"a": {"b": [1.0, 2.0, 3.0], "c": 4.0}, "list": [{"x": 1.0, "y": 2.0}]}


def test_values_are_found_by_name_and_number():
    assert value_at(NOMINAL, "a.c") == 4.0
    assert value_at(NOMINAL, "a.b.2") == 3.0
    assert value_at(NOMINAL, "list.0.y") == 2.0
    assert [value_at(NOMINAL, key) for key in ("a.d", "a.b.3", "a.c.0", "b")] == [None] * 4


def test_an_element_keeps_its_neighbours_and_those_set_before():
    first = with_value({}, NOMINAL, "a.b.0", 7.0)
    assert first == {"a": {"b": [7.0, 2.0, 3.0]}}
    both = with_value(first, NOMINAL, "a.b.2", 9.0)
    assert both == {"a": {"b": [7.0, 2.0, 9.0]}}
    assert with_value(both, NOMINAL, "list.0.y", 5.0)["list"] == [{"x": 1.0, "y": 5.0}]
    assert NOMINAL["a"]["b"] == [1.0, 2.0, 3.0]


def test_a_key_without_a_value_can_be_set_but_no_element_of_it():
    assert with_value({}, NOMINAL, "new.key", 1.0) == {"new": {"key": 1.0}}
    for key in ("new.0", "a.b.3", "list.1.x", "list.0.z"):
        with pytest.raises(ValueError, match=f"no element {key}"):
            with_value({}, NOMINAL, key, 1.0)
    with pytest.raises(ValueError, match="is not a key"):
        with_value({}, NOMINAL, "a..b", 1.0)


def test_the_onboard_table_is_whole():
    values = nominal_values(load("realsat"))
    assert value_at(values, "flight.body.inertia_kgm2") == [1.02, 1.85, 1.95]
    assert value_at(values, "flight.estimator.sun_sigma_deg") > 0.5
    assert value_at(values, "body.inertia_kgm2.0.1") == -0.029
    assert value_at(values, "orbit.altitude_km") is None
