"""Claims on regulators: without what they claim they are missed."""

from dataclasses import replace

import numpy as np
import pytest

from fsw.core.laws import lqr_disturbed
from sim.plant.rotation import ZERO
from sim.validate.review import regulators


def claims_of(study, found):
    return [outcome.verdict.value for outcome in study.conclude(found)]


@pytest.mark.long
def test_a_regulator_that_learns_nothing_misses_its_claim():
    learned = regulators.learned_deg(regulators.light, learning=0.0)
    assert claims_of(regulators.disturbed(), (learned,) * 4) == ["FAIL", "FAIL", "FAIL"]


@pytest.mark.interpreted
def test_without_its_functions_of_twice_the_latitude_a_torque_of_that_kind_is_not_learned(monkeypatch):
    """The torque of light has no such part: its claims do not notice."""
    whole = lqr_disturbed.functions
    monkeypatch.setattr(lqr_disturbed, "functions", lambda u_rad: (*whole(u_rad)[:3], 0.0, 0.0))
    found = [task() for task in regulators.disturbed().tasks]
    assert claims_of(regulators.disturbed(), found) == ["PASS", "PASS", "FAIL"]


def test_the_torque_that_comes_twice_an_orbit_has_no_other_part():
    u = 2.0 * np.pi * np.arange(24) / 24
    velocities = 7e3 * np.stack([-np.sin(u), 0.15 * np.cos(u), np.sqrt(1.0 - 0.15**2) * np.cos(u)], axis=1)
    found = np.array([regulators.twice_an_orbit(regulators.ZERO, v) for v in velocities])
    assert found == pytest.approx(np.outer(np.cos(2.0 * u), regulators.LEVER_NM), abs=1e-20)


def test_the_worst_of_the_wrong_moments_counts():
    verdicts = claims_of(regulators.averaged(), (0.1, 0.6, 0.1, 0.2))
    assert verdicts == ["FAIL", "PASS"]
    assert claims_of(regulators.averaged(), (0.1, 0.2, 11.0, 0.2)) == ["PASS", "FAIL"]


def test_without_its_schedule_the_averaged_regulator_asks_for_nothing():
    flight = replace(regulators.FLIGHT, law="lqr_averaged", orbits=0.1)
    assert not regulators.fly(flight).m_body_am2.any()


def test_light_turns_across_its_direction_and_is_as_large_as_is_said():
    axes = np.eye(3)[[1, 2, 0]]
    torque = np.array(regulators.light(tuple(map(tuple, axes.tolist())), ZERO))
    assert torque @ (axes @ regulators.SUN) == pytest.approx(0.0, abs=1e-20)
    assert 1e-7 < np.linalg.norm(torque) < 2.1e-7
