"""Claims on regulators: without what they claim they are missed."""

from dataclasses import replace

import numpy as np
import pytest

from sim.plant.rotation import ZERO
from sim.validate.review.flown import regulators


def claims_of(study, found):
    return [outcome.verdict.value for outcome in study.conclude(found)]


def test_a_regulator_that_learns_nothing_misses_its_claim():
    learned = regulators.learned_deg(learning=0.0)
    assert claims_of(regulators.disturbed(), (learned, learned)) == ["FAIL", "FAIL"]


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
