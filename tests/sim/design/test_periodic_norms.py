"""Norms of periodic loops: beside the motion itself, beside the bound of the game, and against each other."""

from math import radians

import numpy as np
import pytest

from fsw.core.laws.h_infinity import price
from fsw.core.laws.lqr import LqrGains, orbit_problem
from fsw.core.laws.plan.game import game_periodic
from fsw.core.laws.plan.riccati import periodic, skews
from sim.design.periodic_norms import UnstableLoopError, norms

INERTIA = ((1.02, 0.02, 0.01), (0.02, 1.85, -0.03), (0.01, -0.03, 1.95))
W0, B0, WHEEL = 1.038e-3, 2.112e-5, (0.0, 0.0, 0.003)
UNIT_NM = W0**2 * float(np.trace(INERTIA)) / 3.0


@pytest.fixture(scope="module")
def case():
    return orbit_problem(INERTIA, WHEEL, W0, radians(98.6), B0, LqrGains(rate=0.2, effort=0.3))


@pytest.fixture(scope="module")
def loops(case):
    return {
        "lqr": periodic(*case)[0][:, :, :6],
        "robust": game_periodic(*case, price(2.5, INERTIA, W0))[0][:, :3, :6],
    }


def errors(case, gains, torques):
    """z of each step, from rest."""
    problem, field = case
    x, found = np.zeros(6), []
    for k, torque in enumerate(torques):
        gain, b = gains[k % len(gains)], field[k % len(gains)]
        found.append(np.concatenate([np.sqrt(problem.cost) * x, np.sqrt(problem.effort) * gain @ x]))
        m = gain @ x
        x = problem.free @ np.concatenate([x, UNIT_NM * torque - skews(b) @ m])
    return np.array(found)


@pytest.mark.long
def test_white_torque_leaves_the_h2_norm(case, loops):
    """Mean square over 150 orbits, the first ten not counted."""
    rng = np.random.default_rng(1)
    found = errors(case, loops["lqr"], rng.standard_normal((150 * 48, 3)))[480:]
    expected = norms(*case, loops["lqr"], UNIT_NM).h2
    assert np.sqrt(np.mean(np.sum(found**2, axis=1))) == pytest.approx(expected, rel=0.1)


@pytest.mark.long
def test_the_h2_norm_of_a_loop_that_hardly_decays_is_that_of_its_settled_covariance(case, loops):
    """Which has come to itself after some hundred orbits only."""
    problem, field = case
    gains = 0.03 * loops["lqr"]
    free, g = problem.free[:, :6], UNIT_NM * problem.free[:, 6:]
    closed, covariance, means = free - problem.free[:, 6:] @ skews(field) @ gains, np.zeros((6, 6)), []
    for _ in range(600):
        left = 0.0
        for step, gain in zip(closed, gains, strict=True):
            weight = np.diag(problem.cost) + problem.effort * gain.T @ gain
            left += float(np.trace(weight @ covariance)) / len(gains)
            covariance = step @ covariance @ step.T + g @ g.T
        means.append(left)
    assert means[9] < 0.9 * means[-1]
    assert norms(*case, gains, UNIT_NM).h2 == pytest.approx(np.sqrt(means[-1]), rel=1e-6)


@pytest.mark.long
def test_no_torque_leaves_more_than_the_h_infinity_norm_and_some_nearly_as_much(case, loops):
    """Power iteration on the motion: each torque that of the errors of the one before, backwards in time."""
    problem, field = case
    gains, size = loops["lqr"], norms(*case, loops["lqr"], UNIT_NM).h_infinity
    steps = 12 * 48
    torques, ratio = np.random.default_rng(2).standard_normal((steps, 3)), 0.0
    closed = problem.free[:, :6] - problem.free[:, 6:] @ skews(field) @ gains
    for _ in range(12):
        z = errors(case, gains, torques)
        ratio = np.sqrt(np.sum(z**2) / np.sum(torques**2))
        back, costate = np.empty_like(torques), np.zeros(6)
        for k in range(steps - 1, -1, -1):
            back[k] = UNIT_NM * problem.free[:, 6:].T @ costate
            gain = gains[k % 48]
            sees = np.concatenate([np.diag(np.sqrt(problem.cost)), np.sqrt(problem.effort) * gain])
            costate = closed[k % 48].T @ costate + sees.T @ z[k]
        torques = back / np.sqrt(np.mean(back**2))
    assert 0.85 * size < ratio <= size * (1.0 + 1e-9)


@pytest.mark.long
def test_the_game_keeps_its_bound_and_betters_the_regulator(case, loops):
    plain, robust = (norms(*case, loops[name], UNIT_NM) for name in ("lqr", "robust"))
    assert robust.h_infinity <= 2.5
    assert robust.h_infinity < 0.95 * plain.h_infinity


@pytest.mark.long
def test_of_all_laws_the_regulator_has_the_least_h2_norm(case, loops):
    """It beats the robust one, and itself changed a little."""
    least = norms(*case, loops["lqr"], UNIT_NM).h2
    assert least < norms(*case, loops["robust"], UNIT_NM).h2
    rng = np.random.default_rng(3)
    for _ in range(5):
        changed = loops["lqr"] * (1.0 + 0.05 * rng.standard_normal(loops["lqr"].shape))
        assert least < norms(*case, changed, UNIT_NM).h2


def test_a_loop_that_does_not_decay_has_none(case, loops):
    with pytest.raises(UnstableLoopError, match="not stable"):
        norms(*case, -loops["lqr"], UNIT_NM)
