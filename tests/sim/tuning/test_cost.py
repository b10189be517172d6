"""The cost of a flight: how late it settles and what is left, by the error that the body and the law have."""

from dataclasses import replace
from math import log2, nan

import numpy as np
import pytest

from fsw.core.laws.entry import Aim
from sim.scenario.schema import load
from sim.tuning.cost import LOST, cost_of
from sim.tuning.flown import FlownMotion

ROWS, STEP_S = 400, 10.0
"""Four orbits of a hundred rows."""


def flight(angle_deg, axis=(0.0, 0.0, 1.0), rate_radps=0.0):
    """Turned about an axis by an angle a row, with a rate about axis 2."""
    half = 0.5 * np.radians(np.broadcast_to(angle_deg, (ROWS,)))
    q = np.column_stack([np.cos(half), *(np.sin(half) * part for part in axis)])
    rates = np.tile([0.0, 1.0, 0.0], (ROWS, 1)) * rate_radps
    return FlownMotion(100 * STEP_S, STEP_S * np.arange(ROWS), q, rates)


def test_settled_half_way_with_one_degree_left():
    angles = np.where(np.arange(ROWS) < 200, 30.0, 1.0)
    found = cost_of(flight(angles), load("microsat"), Aim.THREE_AXIS)
    assert found.settle_orbits == pytest.approx(2.0)
    assert found.rms == pytest.approx(1.0)
    assert found.total == pytest.approx(0.5 + log2(1.2))


def test_what_leaves_again_never_settled():
    angles = np.where(np.arange(ROWS) < ROWS - 1, 1.0, 6.0)
    found = cost_of(flight(angles), load("microsat"), Aim.THREE_AXIS)
    assert found.settle_orbits is None
    assert found.total > 1.0


@pytest.mark.parametrize(("rows", "settled"), [(60, None), (99, None), (100, 3.0)])
def test_what_is_small_for_less_than_the_last_orbit_has_not_been_seen_to_stay(rows, settled):
    angles = np.where(np.arange(ROWS) < ROWS - rows, 30.0, 1.0)
    found = cost_of(flight(angles), load("microsat"), Aim.THREE_AXIS)
    assert found.settle_orbits == (settled if settled is None else pytest.approx(settled))


def test_further_off_costs_more_however_far():
    costs = [cost_of(flight(angle), load("microsat"), Aim.THREE_AXIS).total for angle in (20.0, 60.0, 150.0)]
    assert costs == sorted(costs)
    assert len(set(costs)) == 3
    assert costs[-1] < LOST


def test_with_a_boom_a_turn_about_it_costs_nothing():
    about, across = flight(90.0, (1.0, 0.0, 0.0)), flight(90.0, (0.0, 1.0, 0.0))
    assert cost_of(about, load("posat1"), Aim.RATE).total == pytest.approx(0.0)
    assert cost_of(across, load("posat1"), Aim.RATE).rms == pytest.approx(90.0)


def test_a_law_that_does_not_point_is_judged_by_the_rate():
    scenario = load("spinner")
    found = cost_of(flight(90.0), scenario, Aim.SPIN)
    assert found.rms == pytest.approx(np.degrees(scenario.control.spin_radps))
    turning = cost_of(flight(0.0, rate_radps=0.001), load("microsat"), Aim.RATE)
    assert turning.rms == pytest.approx(np.degrees(0.001))


def test_a_flight_that_is_no_number_is_lost():
    assert cost_of(flight(nan), load("microsat"), Aim.THREE_AXIS).total == LOST


def test_where_a_spin_rate_is_required_the_turn_of_the_orbital_frame_costs_nothing():
    """A spin that is fixed in space turns against the orbital frame all the time."""
    scenario = load("spinner")
    spun = flight(90.0)
    rates = np.tile([scenario.control.spin_radps + np.radians(0.03), 0.0, -1.04e-3], (ROWS, 1))
    found = cost_of(replace(spun, relative_body_radps=rates), scenario, Aim.SPIN)
    assert (found.settle_orbits, found.rms) == (0.0, pytest.approx(0.03))
    assert found.total == pytest.approx(log2(1.0 + 0.03 / 0.1))
