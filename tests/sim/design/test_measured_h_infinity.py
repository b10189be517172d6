"""H-infinity control from the measured field: its bound holds and is nearly met, LQG is the limit."""

from math import radians

import numpy as np
import pytest

from fsw.core.laws.lqr import LqrGains, orbit_problem
from fsw.core.laws.plan.riccati import NotHeldError, skews
from sim.design.measured_h_infinity import Measured, central, least, norm
from sim.design.periodic_norms import UnstableLoopError

INERTIA = ((1.02, 0.02, 0.01), (0.02, 1.85, -0.03), (0.01, -0.03, 1.95))
W0, B0, WHEEL = 1.038e-3, 2.112e-5, (0.0, 0.0, 0.003)
UNIT_NM = W0**2 * float(np.trace(INERTIA)) / 3.0


@pytest.fixture(scope="module")
def case():
    problem = orbit_problem(INERTIA, WHEEL, W0, radians(98.6), B0, LqrGains(rate=0.2, effort=0.3))
    return Measured(*problem, UNIT_NM, 0.02 * B0)


@pytest.fixture(scope="module")
def lqg(case):
    return central(case, np.inf)


@pytest.mark.long
@pytest.mark.parametrize("share", [0.8, 0.9, 1.5])
def test_the_bound_holds_beside_the_norm_of_the_loop(case, lqg, share):
    """By lifting, which knows nothing of the game; of LQG's norm."""
    gamma = share * norm(case, lqg, 5)
    assert norm(case, central(case, gamma), 5) <= gamma


@pytest.mark.long
def test_the_least_bound_is_met_and_less_than_what_lqg_leaves(case, lqg):
    plain = norm(case, lqg, 5)
    gamma, found = least(case, 0.3 * plain, 1.1 * plain)
    assert 0.95 * gamma < norm(case, found, 5) <= gamma < 0.9 * plain


@pytest.mark.long
def test_below_a_bound_that_its_controller_meets_exactly_there_is_none(case, lqg):
    """Of all controllers the norm is at least that: what is refused is what cannot be."""
    gamma, _ = least(case, 0.3 * norm(case, lqg, 5), norm(case, lqg, 5))
    closest, found = least(case, 0.98 * gamma, gamma)
    assert 0.999 * closest < norm(case, found, 5) <= closest


def test_a_large_gamma_leaves_lqg(case, lqg):
    for found, expected in zip(central(case, 1e5), lqg, strict=True):
        assert found == pytest.approx(expected, rel=1e-5, abs=1e-6 * np.abs(expected).max())


def test_lqg_is_the_kalman_filter(case, lqg):
    """The gain of its last step beside that of 30 orbits by the textbook's form, predicted to predicted."""
    f, g = case.problem.free[:, :6], UNIT_NM * case.problem.free[:, 6:]
    sigma = np.diag(np.repeat([1e-6, 1.0], 3))
    for _ in range(30):
        for b in case.b_orbit_t:
            h = np.hstack([np.zeros((3, 3)), skews(b)])
            gain = f @ sigma @ h.T @ np.linalg.inv(h @ sigma @ h.T + case.error_t**2 * np.eye(3))
            sigma = (f - gain @ h) @ sigma @ f.T + g @ g.T
    assert lqg.feedback[-1] == pytest.approx(gain, rel=1e-3, abs=1e-4 * np.abs(gain).max())


@pytest.mark.long
def test_the_norm_is_that_of_the_motion(case, lqg):
    """White torques and errors over 30 orbits leave less than it, and more than a twentieth of it."""
    rng, x, xi = np.random.default_rng(3), np.zeros(6), np.zeros(6)
    problem, paid, left = case.problem, 0.0, 0.0
    for k in range(30 * 48):
        w, v, b = *rng.standard_normal((2, 3)), case.b_orbit_t[k % 48]
        m = lqg.gains[k % 48] @ xi
        left += x @ (problem.cost * x) + problem.effort * m @ m
        paid += w @ w + v @ v
        y = skews(b) @ x[3:] + case.error_t * v
        xi = lqg.motion[k % 48] @ xi + lqg.feedback[k % 48] @ y
        x = problem.free @ np.concatenate([x, UNIT_NM * w - skews(b) @ m])
    assert 0.05 * norm(case, lqg, 5) < np.sqrt(left / paid) < norm(case, lqg, 5)


def test_a_loop_that_does_not_hold_has_no_norm(case, lqg):
    with pytest.raises(UnstableLoopError):
        norm(case, lqg._replace(gains=-lqg.gains))


def test_too_small_a_bound_is_refused(case):
    with pytest.raises(NotHeldError):
        central(case, 1.0)
