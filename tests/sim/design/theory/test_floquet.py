"""Multipliers and degree of stability against reference data and against an adaptive integrator."""

from math import log, pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sim.design.theory.floquet import (
    ROUGH_STEPS,
    degree_of_stability,
    monodromy,
    multipliers,
    product,
    settling_orbits,
)
from sim.design.theory.linear import Gains, closed_loop

REFERENCE_TOLERANCE = 1e-7


def unmatched(ours, theirs):
    """The greatest distance of the nearest pairs, relative to moduli above one: a cluster has no order."""
    left, worst = list(ours), 0.0
    for value in theirs:
        nearest = min(left, key=lambda other: abs(other - value))
        left.remove(nearest)
        worst = max(worst, abs(nearest - value) / max(1.0, abs(value)))
    return worst


def test_multipliers_are_those_of_the_reference(row, reference_body):
    loop = closed_loop(reference_body, Gains(row["k_omega"], row["k_a"]))
    theirs = [complex(row[f"mult_{k}_re"], row[f"mult_{k}_im"]) for k in range(1, 7)]
    whole = monodromy(loop)
    assert unmatched(multipliers(whole), theirs) < REFERENCE_TOLERANCE
    assert degree_of_stability(whole) == pytest.approx(row["degree_of_stability"], abs=REFERENCE_TOLERANCE)


def test_multipliers_come_by_their_size_and_of_a_pair_the_one_above_the_axis_first():
    turning = np.array([[0.3, -0.4, 0.0], [0.4, 0.3, 0.0], [0.0, 0.0, -2.0]])
    assert multipliers(turning) == pytest.approx([-2.0, 0.3 + 0.4j, 0.3 - 0.4j])


def test_the_orbit_of_the_reference(row, reference_body):
    assert reference_body.rate_radps == pytest.approx(row["w0_rad_s"], rel=1e-13)
    assert reference_body.field_t == pytest.approx(row["B0_T"], rel=1e-13)


def test_rough_steps_are_good_enough_for_pictures(row, reference_body):
    loop = closed_loop(reference_body, Gains(row["k_omega"], row["k_a"]))
    rough = degree_of_stability(monodromy(loop, ROUGH_STEPS))
    assert rough == pytest.approx(row["degree_of_stability"], abs=1e-6)


def test_an_adaptive_integrator_agrees_on_a_skewed_body(skewed):
    loop = closed_loop(skewed, Gains(6.0e6, 1200.0, 0.3))

    def derivative(u, columns):
        return (loop(np.array([u]))[0] @ columns.reshape(9, 9)).ravel()

    flown = solve_ivp(derivative, (0.0, 2.0 * pi), np.eye(9).ravel(), method="DOP853", rtol=1e-11, atol=1e-13)
    assert np.abs(monodromy(loop) - flown.y[:, -1].reshape(9, 9)).max() < 1e-9


def test_many_systems_at_once_are_the_same_one_by_one(skewed):
    k_w, k_a = np.array([[1e6], [5e6]]), np.array([300.0, 900.0, 2700.0])
    together = degree_of_stability(monodromy(closed_loop(skewed, Gains(k_w, k_a))))
    alone = [
        [degree_of_stability(monodromy(closed_loop(skewed, Gains(w, a)))) for a in k_a] for w in k_w[:, 0]
    ]
    assert together.shape == (2, 3)
    assert together == pytest.approx(np.array(alone), abs=1e-12)


def test_the_product_is_taken_from_right_to_left():
    matrices = np.random.default_rng(3).normal(size=(7, 2, 2))
    expected = np.eye(2)
    for matrix in matrices:
        expected = matrix @ expected
    assert product(matrices) == pytest.approx(expected, rel=1e-12)


def test_multipliers_fall_in_modulus(row, reference_body):
    moduli = np.abs(multipliers(monodromy(closed_loop(reference_body, Gains(row["k_omega"], row["k_a"])))))
    assert (np.diff(moduli) <= 0.0).all()


def test_a_mode_that_falls_by_e_each_radian_settles_in_half_an_orbit():
    assert settling_orbits(-1.0) == pytest.approx(log(20.0) / (2.0 * pi))
    assert settling_orbits(0.0) is None
    assert settling_orbits(0.3) is None
    assert settling_orbits(-1e-12) is None


def test_a_motion_beyond_all_numbers_is_infinitely_unstable():
    matrices = np.stack([np.diag([np.inf, 1.0]), np.diag([0.5, 0.25]), np.diag([np.nan, 1.0])])
    degrees = degree_of_stability(matrices)
    assert degrees[[0, 2]].tolist() == [np.inf, np.inf]
    assert degrees[1] == pytest.approx(log(0.5) / (2.0 * pi))
