"""The cost still to come, in sums of a stated order, against the recursion that uses BLAS."""

import numpy as np
import pytest

from fsw.core.laws.lqr import LqrGains, schedule
from fsw.core.laws.plan.cost_to_go import cost_to_go, rounded, rounded_schedule, times
from fsw.core.laws.plan.riccati import backward, regulator_problem

INERTIA = ((1.02, 0.03, -0.05), (0.03, 1.85, 0.02), (-0.05, 0.02, 1.95))
WHEEL = (0.001, -0.002, 0.003)
RATE, FIELD = 1.04e-3, 2.1e-5
PROBLEM = regulator_problem(INERTIA, WHEEL, RATE, FIELD, 103.0, 0.01, 0.001)
NO_DRIFT = np.zeros((9, 6))


def fields(seed, steps=9):
    return np.random.default_rng(seed).normal(size=(steps, 3)) * 3e-5


def end(seed):
    """(P S s) with a positive P."""
    random = np.random.default_rng(seed)
    root = random.normal(size=(6, 6)) * np.repeat([1e4, 3.0], 3)[:, None]
    return np.hstack([root @ root.T, random.normal(size=(6, 4)) * np.repeat([1e6, 1e3], 3)[:, None]])


@pytest.mark.parametrize("seed", range(8))
def test_is_that_of_the_other_recursion(seed):
    field, last = fields(seed), end(seed)
    _, expected = backward(PROBLEM, field, last[:, :9])
    for ours, theirs in zip(cost_to_go(PROBLEM, field, NO_DRIFT, last), expected, strict=True):
        sizes = np.abs(theirs).max(axis=1, keepdims=True) * np.abs(theirs).max(axis=0, keepdims=True)
        np.testing.assert_array_less(np.abs(ours[:, :9] - theirs), 1e-6 * sizes / np.abs(theirs).max())


@pytest.mark.parametrize("seed", range(8))
def test_a_torque_known_step_by_step_costs_what_the_same_constant_one_does(seed):
    """As S d, if it is as constant."""
    field, last, torque = fields(seed), end(seed), np.random.default_rng(seed).normal(size=3) * 1e-7
    last[:, 9] = last[:, 6:9] @ torque
    drifts = np.tile(PROBLEM.free[:, 6:] @ torque, (9, 1))
    for cost in cost_to_go(PROBLEM, field, drifts, last):
        np.testing.assert_allclose(cost[:, 9], cost[:, 6:9] @ torque, rtol=1e-6, atol=1e-9 * abs(cost).max())


def test_is_what_the_best_dipole_leaves():
    """Over one step: against the state at rest, for which the same constant is left out."""
    field, last, drift = fields(3, 1), end(3), np.full((1, 6), 1e-5)
    (cost,) = cost_to_go(PROBLEM, field, drift, last)
    random = np.random.default_rng(1)
    d = random.normal(size=3) * 1e-7
    f, g = PROBLEM.free[:, :6], PROBLEM.free[:, 6:]
    push = g @ np.cross(np.eye(3), field[0]).T

    def least(x):
        moved, slope = f @ x + g @ d + drift[0], last[:, 6:9] @ d + last[:, 9]
        curvature = push.T @ last[:, :6] @ push + PROBLEM.effort * np.eye(3)
        m = -np.linalg.solve(curvature, push.T @ (last[:, :6] @ moved + slope))
        after = moved + push @ m
        return (
            x @ (PROBLEM.cost * x) + PROBLEM.effort * m @ m + after @ last[:, :6] @ after + 2 * after @ slope
        )

    for _ in range(5):
        x = random.normal(size=6) * np.repeat([1e-4, 0.1], 3)
        ours = x @ cost[:, :6] @ x + 2.0 * x @ (cost[:, 6:9] @ d + cost[:, 9])
        assert ours == pytest.approx(least(x) - least(np.zeros(6)), rel=1e-6)


def test_each_step_has_its_own_field_and_drift():
    """Solved at once, or one step after the other from the last."""
    field, last, drifts = fields(4, 5), end(4), 1e-5 * np.random.default_rng(4).normal(size=(5, 6))
    whole = cost_to_go(PROBLEM, field, drifts, last)
    for k in range(4, -1, -1):
        (last,) = cost_to_go(PROBLEM, field[k : k + 1], drifts[k : k + 1], last)
        assert np.array_equal(whole[k], last)


def test_each_sum_is_in_the_order_of_its_terms():
    """To the last bit, unlike a product by BLAS."""
    random = np.random.default_rng(5)
    a, b = random.normal(size=(6, 6)), random.normal(size=(6, 50))
    expected = np.zeros((6, 50))
    for row in range(6):
        for column in range(50):
            total = a[row, 0] * b[0, column]
            for k in range(1, 6):
                total += a[row, k] * b[k, column]
            expected[row, column] = total
    assert np.array_equal(times(a, b), expected)


def test_what_differs_in_the_last_bits_becomes_equal():
    values = np.random.default_rng(6).normal(size=(6, 9))
    assert np.array_equal(rounded(values), rounded(values * (1.0 + 2.0**-50)))
    assert rounded(values) == pytest.approx(values, rel=6e-8)
    table = schedule(INERTIA, WHEEL, RATE, 1.72, FIELD, LqrGains())
    near = rounded_schedule(table)
    assert near.costs == pytest.approx(table.costs, rel=6e-8)
    assert near.problem.free == pytest.approx(table.problem.free, rel=6e-8)
    assert np.array_equal(near.gains, table.gains)
