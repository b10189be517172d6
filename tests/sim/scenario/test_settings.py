"""Settings of a program, as sections."""

from pathlib import Path

import numpy as np
import pytest

from fsw.input.schema import TableError
from sim.scenario.settings import nested


@pytest.mark.parametrize(
    ("settings", "sections"),
    [
        (None, {}),
        ({}, {}),
        ({"time.tick_hz": 10}, {"time": {"tick_hz": 10}}),
        ({"time": {"tick_hz": 10}, "time.orbits": 2.0}, {"time": {"tick_hz": 10, "orbits": 2.0}}),
        ({"time.orbits": 1.0, "time": {"orbits": 2.0}}, {"time": {"orbits": 2.0}}),
        ({"a": np.float32(0.5), "b": np.arange(2), "c": (1, True)}, {"a": 0.5, "b": [0, 1], "c": [1, True]}),
        ({"flight.a.b": {"c": np.int8(3)}}, {"flight": {"a": {"b": {"c": 3}}}}),
        ({"path": Path("x")}, {"path": "x"}),
    ],
)  # fmt: skip
def test_dots_make_sections_and_numpy_makes_numbers(settings, sections):
    found = nested(settings)
    assert found == sections
    assert repr(found) == repr(sections)


def deep(levels):
    return [deep(levels - 1)] if levels else 1


@pytest.mark.parametrize(
    "settings", [3, ["a=1"], {1: 2}, {"": 1}, {"a..b": 1}, {".".join("a" * 40): 1}, {"a": deep(40)}], ids=repr
)
def test_what_is_none_is_refused(settings):
    with pytest.raises(TableError, match=r"^set"):
        nested(settings)
