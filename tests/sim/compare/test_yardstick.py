"""What the laws of a body are judged by."""

import pytest

from sim.compare.command import yardstick
from sim.scenario.schema import load, parse_settings


@pytest.mark.parametrize(
    ("name", "settings", "what", "unit", "threshold"),
    [
        ("microsat", (), "attitude", "deg", 5.0),
        ("posat1", (), "axis", "deg", 5.0),
        ("posat1-spin", (), "axis", "deg", 5.0),
        ("microsat", ("control.law=bdot",), "rate", "deg/s", 0.3),
        ("spinner", (), "spin", "deg/s", 0.1),
    ],
)
def test_it_is_what_the_laws_meant_for_the_body_control(name, settings, what, unit, threshold):
    found = yardstick(load(name, parse_settings(settings)))
    assert (found.what, found.unit, found.threshold) == (what, unit, threshold)
