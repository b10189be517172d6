"""The game of dipole and torque: a saddle, bounded by gamma, the regulator where gamma is large."""

from math import radians

import numpy as np
import pytest

from fsw.core.laws.h_infinity import price
from fsw.core.laws.lqr import LqrGains, orbit_problem
from fsw.core.laws.plan.game import game_backward, game_periodic
from fsw.core.laws.plan.riccati import NotHeldError, periodic, skews

INERTIA = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
W0, B0 = 1.038e-3, 2.112e-5
GAMMA = 4.0


@pytest.fixture(scope="module")
def case():
    return orbit_problem(INERTIA, (0.0, 0.0, 0.004), W0, radians(98.6), B0, LqrGains(rate=0.5, effort=0.3))


@pytest.fixture(scope="module")
def paid():
    return price(GAMMA, INERTIA, W0)


@pytest.fixture(scope="module")
def saddle(case, paid):
    return game_periodic(*case, paid)


def test_a_torque_that_costs_much_leaves_the_regulator(case):
    gains, costs = game_periodic(*case, price(1e5, INERTIA, W0))
    plain, plain_costs = periodic(*case)
    assert gains[:, :3] == pytest.approx(plain, rel=1e-6, abs=1e-7 * np.abs(plain).max(axis=(0, 1)).min())
    assert np.abs(costs[:, :, :6] - plain_costs[:, :, :6]).max() < 1e-6 * np.abs(plain_costs[:, :, :6]).max()


def test_the_saddle_comes_again_after_an_orbit(case, paid, saddle):
    _, costs = saddle
    _, again = game_backward(*case, costs[0], paid)
    assert np.abs(again[0] - costs[0]).max(axis=0) == pytest.approx(
        np.zeros(9), abs=1e-5 * np.abs(costs[0]).max()
    )


@pytest.fixture(scope="module")
def payoff(case, paid, saddle):
    """What an orbit costs from a state, less what its torque paid, when one step is played otherwise."""
    problem, field = case
    gains, costs = saddle
    f, g, n = problem.free[:, :6], problem.free[:, 6:], -problem.free[:, 6:] @ skews(field)

    def played(start, step, change_m, change_w):
        x, total = start, 0.0
        for k in range(len(field)):
            move = gains[k, :, :6] @ x
            m, w = move[:3] + change_m * (k == step), move[3:] + change_w * (k == step)
            total += x @ (problem.cost * x) + problem.effort * m @ m - paid * w @ w
            x = f @ x + n[k] @ m + g @ w
        return total + x @ costs[0, :, :6] @ x

    return played


@pytest.mark.parametrize(("times", "held"), [(1.05, True), (0.95, False)])
def test_a_torque_that_costs_too_little_about_any_axis_wins(case, times, held):
    """Less than the largest eigenvalue of G^T P G, though more than the others."""
    problem, field = case
    g = problem.free[:, 6:]
    last = np.hstack([np.diag([1.0, 4.0, 9.0, 1e-9, 1e-9, 1e-9]), np.zeros((6, 3))])
    values = np.linalg.eigvalsh(g.T @ last[:, :6] @ g)
    assert values[1] < 0.9 * values[2]
    if held:
        game_backward(problem, field[:1], last, times * values[2])
    else:
        with pytest.raises(NotHeldError, match="gamma is too small"):
            game_backward(problem, field[:1], last, times * values[2])


START = np.array([3e-4, -2e-4, 1e-4, 0.1, -0.2, 0.15])


def test_the_value_told_is_the_value_played(payoff, saddle):
    value = START @ saddle[1][0, :, :6] @ START
    assert payoff(START, 0, np.zeros(3), np.zeros(3)) == pytest.approx(value, rel=1e-6)


@pytest.mark.parametrize("step", [0, 17])
@pytest.mark.parametrize("axis", range(3))
def test_who_moves_otherwise_loses(payoff, step, axis):
    value = payoff(START, step, np.zeros(3), np.zeros(3))
    for sign in (1.0, -1.0):
        assert payoff(START, step, sign * 0.01 * np.eye(3)[axis], np.zeros(3)) > value
        assert payoff(START, step, np.zeros(3), sign * 1e-7 * np.eye(3)[axis]) < value


def test_no_torque_brings_more_error_than_gamma_allows(case, saddle):
    """From rest, under random torques of two orbits, in units of w0^2 J_mean."""
    problem, field = case
    gains, _ = saddle
    f, g, n = problem.free[:, :6], problem.free[:, 6:], -problem.free[:, 6:] @ skews(field)
    unit_nm, rng = W0**2 * np.trace(INERTIA) / 3.0, np.random.default_rng(5)
    for _ in range(5):
        x, error, paid_for = np.zeros(6), 0.0, 0.0
        for k in range(2 * len(field)):
            m, w = gains[k % len(field), :3, :6] @ x, unit_nm * rng.standard_normal(3)
            error += x @ (problem.cost * x) + problem.effort * m @ m
            paid_for += w @ w / unit_nm**2
            x = f @ x + n[k % len(field)] @ m + g @ w
        assert 0.0 < error < GAMMA**2 * paid_for


def test_a_gamma_that_cannot_be_had_is_refused(case):
    with pytest.raises(NotHeldError, match="gamma is too small"):
        game_periodic(*case, price(0.5, INERTIA, W0))
