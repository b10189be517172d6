"""H-infinity: norms of periodic loops, PD gains by their worst torque, control from the measured field."""

from math import radians

import numpy as np
import pytest

from fsw.core.laws.h_infinity import price
from fsw.core.laws.lqr import LqrGains, orbit_problem
from fsw.core.laws.plan.game import game_periodic
from fsw.core.laws.plan.riccati import NotHeldError, periodic, skews
from sim.design.h_infinity import (
    Measured,
    UnstableLoopError,
    best_pd,
    central_controller,
    least_gamma,
    measured_norm,
    norms,
    pd_tabulated,
)

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


# --- PD gains by their worst torque: better than the start, than their neighbours, worse than the free law

PRINCIPAL = ((1.02, 0.0, 0.0), (0.0, 1.85, 0.0), (0.0, 0.0, 1.95))
PRINCIPAL_UNIT_NM = W0**2 * float(np.trace(PRINCIPAL)) / 3.0
START = (6.2694e6, 1614.9)


@pytest.fixture(scope="module")
def pd_case():
    return orbit_problem(PRINCIPAL, (0.0, 0.0, 0.0), W0, radians(98.6), B0, LqrGains())


def test_the_table_is_the_pd_law():
    """For a small angle, at one field."""
    b, omega, theta = (
        np.array([2e-5, -1e-5, 3e-5]),
        np.array([1e-4, 2e-4, -3e-4]),
        np.array([1e-3, -2e-3, 3e-3]),
    )
    gain = pd_tabulated(b[None], 5e6, 1500.0)[0]
    expected = -np.cross(b, 5e6 * omega + 1500.0 * 2.0 * theta)
    assert gain @ np.concatenate([omega, theta]) == pytest.approx(expected)


@pytest.mark.long
@pytest.mark.slow
def test_the_gains_found_bear_the_worst_torque_better(pd_case):
    found = best_pd(*pd_case, PRINCIPAL_UNIT_NM, START)
    before = norms(*pd_case, pd_tabulated(pd_case[1], *START), PRINCIPAL_UNIT_NM).h_infinity
    assert found.norms.h_infinity < 0.9 * before
    for factor in (0.6, 1.7):
        for k_w, k_a in ((factor * found.k_w, found.k_a), (found.k_w, factor * found.k_a)):
            near = norms(*pd_case, pd_tabulated(pd_case[1], k_w, k_a), PRINCIPAL_UNIT_NM).h_infinity
            assert near > 0.999 * found.norms.h_infinity


# --- H-infinity control from the measured field: its bound holds and is nearly met, LQG is the limit


@pytest.fixture(scope="module")
def measured_case():
    problem = orbit_problem(INERTIA, WHEEL, W0, radians(98.6), B0, LqrGains(rate=0.2, effort=0.3))
    return Measured(*problem, UNIT_NM, 0.02 * B0)


@pytest.fixture(scope="module")
def lqg(measured_case):
    return central_controller(measured_case, np.inf)


@pytest.mark.long
@pytest.mark.parametrize("share", [0.8, 0.9, 1.5])
def test_the_bound_holds_beside_the_norm_of_the_loop(measured_case, lqg, share):
    """By lifting, which knows nothing of the game; of LQG's norm."""
    gamma = share * measured_norm(measured_case, lqg, 5)
    assert measured_norm(measured_case, central_controller(measured_case, gamma), 5) <= gamma


@pytest.mark.long
def test_the_least_bound_is_met_and_less_than_what_lqg_leaves(measured_case, lqg):
    plain = measured_norm(measured_case, lqg, 5)
    gamma, found = least_gamma(measured_case, 0.3 * plain, 1.1 * plain)
    assert 0.95 * gamma < measured_norm(measured_case, found, 5) <= gamma < 0.9 * plain


@pytest.mark.long
def test_below_a_bound_that_its_controller_meets_exactly_there_is_none(measured_case, lqg):
    """Of all controllers the norm is at least that: what is refused is what cannot be."""
    gamma, _ = least_gamma(
        measured_case, 0.3 * measured_norm(measured_case, lqg, 5), measured_norm(measured_case, lqg, 5)
    )
    closest, found = least_gamma(measured_case, 0.98 * gamma, gamma)
    assert 0.999 * closest < measured_norm(measured_case, found, 5) <= closest


def test_a_large_gamma_leaves_lqg(measured_case, lqg):
    for found, expected in zip(central_controller(measured_case, 1e5), lqg, strict=True):
        assert found == pytest.approx(expected, rel=1e-5, abs=1e-6 * np.abs(expected).max())


def test_lqg_is_the_kalman_filter(measured_case, lqg):
    """The gain of its last step beside that of 30 orbits by the textbook's form, predicted to predicted."""
    f, g = measured_case.problem.free[:, :6], UNIT_NM * measured_case.problem.free[:, 6:]
    sigma = np.diag(np.repeat([1e-6, 1.0], 3))
    for _ in range(30):
        for b in measured_case.b_orbit_t:
            h = np.hstack([np.zeros((3, 3)), skews(b)])
            gain = f @ sigma @ h.T @ np.linalg.inv(h @ sigma @ h.T + measured_case.error_t**2 * np.eye(3))
            sigma = (f - gain @ h) @ sigma @ f.T + g @ g.T
    assert lqg.feedback[-1] == pytest.approx(gain, rel=1e-3, abs=1e-4 * np.abs(gain).max())


@pytest.mark.long
def test_the_norm_is_that_of_the_motion(measured_case, lqg):
    """White torques and errors over 30 orbits leave less than it, and more than a twentieth of it."""
    rng, x, xi = np.random.default_rng(3), np.zeros(6), np.zeros(6)
    problem, paid, left = measured_case.problem, 0.0, 0.0
    for k in range(30 * 48):
        w, v, b = *rng.standard_normal((2, 3)), measured_case.b_orbit_t[k % 48]
        m = lqg.gains[k % 48] @ xi
        left += x @ (problem.cost * x) + problem.effort * m @ m
        paid += w @ w + v @ v
        y = skews(b) @ x[3:] + measured_case.error_t * v
        xi = lqg.motion[k % 48] @ xi + lqg.feedback[k % 48] @ y
        x = problem.free @ np.concatenate([x, UNIT_NM * w - skews(b) @ m])
    assert (
        0.05 * measured_norm(measured_case, lqg, 5)
        < np.sqrt(left / paid)
        < measured_norm(measured_case, lqg, 5)
    )


def test_a_loop_that_does_not_hold_has_no_norm(measured_case, lqg):
    with pytest.raises(UnstableLoopError):
        measured_norm(measured_case, lqg._replace(gains=-lqg.gains))


def test_too_small_a_bound_is_refused(measured_case):
    with pytest.raises(NotHeldError):
        central_controller(measured_case, 1.0)
