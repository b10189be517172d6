"""Claims on Gurwin's laws: without wheel or regulator they are missed."""

from dataclasses import replace

import pytest

from sim.validate.review import gurwin
from sim.validate.review.fifty_kg import last_orbit_deg
from sim.validate.review.law_flight import fly


@pytest.mark.long
def test_without_its_wheel_the_satellite_does_not_recover():
    bare = replace(gurwin.FAILED, wheel_body_nms=(0.0, 0.0, 0.0), orbits=3.0)
    assert last_orbit_deg(bare) > 10.0


def test_the_regulator_asks_for_nothing_without_its_schedule():
    flight = replace(gurwin.POINTED, orbits=0.2)
    assert not fly(flight).m_body_am2.any()


@pytest.mark.parametrize(("count", "low", "high"), [(1, 0.99, 1.0), (3, 0.14, 0.17), (5, 0.1, 0.14)])
def test_what_is_left_of_the_torque_of_a_dipole(count, low, high):
    assert low < gurwin.share_left(count) < high
