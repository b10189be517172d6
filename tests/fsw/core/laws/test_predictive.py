"""The predictive law against an integration of the rigid body, and its impulse against a minimiser."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.laws.interface import ControlConfig, Demand, FieldSample, LawInput, Setpoint
from fsw.core.laws.predictive import best_impulse, free_rate_change, missing_impulse, predictive
from fsw.core.orbit.ephemeris import Reference

J = np.array([[1.02, 0.13, -0.09], [0.13, 1.85, 0.21], [-0.09, 0.21, 1.55]])
J_INVERSE = np.linalg.inv(J)
WHEEL_NMS = np.array([0.02, -0.05, 0.03])
MU, RADIUS_M = 3.986004418e14, 7.1e6
W0 = sqrt(MU / RADIUS_M**3)
PULSE_S = 3.0


def rows(matrix):
    return tuple(map(tuple, np.asarray(matrix).tolist()))


def vec(array):
    return tuple(np.asarray(array).tolist())


def random_motion(rng):
    """C body from orbit, and Omega."""
    return Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3) * 0.02


def integrated(c, omega_rel, seconds, torque=lambda c: np.zeros(3)):
    """Omega after some time: momentum and attitude seen from a frame at rest, by scipy.

    At the start the orbital frame is that frame; it turns about its axis 3.
    """

    def derivative(t, state):
        a, momentum = state[:9].reshape(3, 3), state[9:]  # body from rest; total momentum at rest
        radial = np.array([np.cos(W0 * t), np.sin(W0 * t), 0.0])
        omega = J_INVERSE @ (a @ momentum - WHEEL_NMS)
        e1 = a @ radial
        moment = 3.0 * MU / RADIUS_M**3 * np.cross(e1, J @ e1) + torque(a)
        return np.concatenate([-(np.cross(omega, a.T).T).ravel(), a.T @ moment])

    omega = omega_rel + W0 * c[:, 2]
    start = np.concatenate([c.ravel(), c.T @ (J @ omega + WHEEL_NMS)])
    end = solve_ivp(derivative, (0.0, seconds), start, rtol=1e-12, atol=1e-15, method="DOP853").y[:, -1]
    a, momentum = end[:9].reshape(3, 3), end[9:]
    return J_INVERSE @ (a @ momentum - WHEEL_NMS) - W0 * a[:, 2]


def change(c, omega_rel, wheel=WHEEL_NMS):
    return np.array(
        free_rate_change(vec(omega_rel), rows(c), W0, RADIUS_M, rows(J), rows(J_INVERSE), vec(wheel))
    )


class TestFreeRateChange:
    @pytest.mark.parametrize("seed", range(8))
    def test_is_the_derivative_of_an_independent_integration(self, seed):
        """By central differences; the body is not symmetric, a wheel turns in it, and so does the frame."""
        c, omega = random_motion(np.random.default_rng(seed))
        h = 0.05
        by_difference = (integrated(c, omega, h) - integrated(c, omega, -h)) / (2.0 * h)
        assert np.linalg.norm(by_difference) > 1e-5
        np.testing.assert_allclose(change(c, omega), by_difference, rtol=0.0, atol=2e-8)

    def test_each_of_its_terms_is_there(self):
        """What the tolerance above could not hide: each is more than a hundred times it."""
        c, omega = random_motion(np.random.default_rng(1))
        e1, e3 = c[:, 0], c[:, 2]
        full = change(c, omega)
        wheel = full - change(c, omega, wheel=np.zeros(3))
        gradient = J_INVERSE @ (3.0 * W0**2 * np.cross(e1, J @ e1))
        turning = W0 * np.cross(omega, e3)
        assert min(np.linalg.norm(term) for term in (wheel, gradient, turning)) > 2e-7

    def test_a_body_at_rest_in_the_orbital_frame_along_its_axes_stays_so(self):
        principal = np.diag([1.0, 1.8, 1.9])
        got = free_rate_change(
            (0.0, 0.0, 0.0),
            rows(np.eye(3)),
            W0,
            RADIUS_M,
            rows(principal),
            rows(np.linalg.inv(principal)),
            (0.0,) * 3,
        )
        assert got == pytest.approx((0.0, 0.0, 0.0), abs=1e-18)


class TestMissingImpulse:
    def test_the_equation(self):
        """r = J (Omega_ref - Omega - dt dOmega/dt)."""
        omega, free, wanted = (0.01, -0.02, 0.005), (1e-4, 2e-4, -3e-4), (0.02, 0.0, 0.0)
        expected = J @ (np.array(wanted) - np.array(omega) - 2.5 * np.array(free))
        assert missing_impulse(omega, free, wanted, 2.5, rows(J)) == pytest.approx(vec(expected), rel=1e-12)

    def test_given_in_full_the_body_has_the_rate_that_is_wanted(self):
        """By integration: up to the second order in the pulse."""
        c, omega = random_motion(np.random.default_rng(5))
        omega = 0.1 * omega
        wanted = np.array([0.001, 0.0, 0.0])
        lefts = []
        for seconds in (0.5, 1.0):
            impulse = np.array(
                missing_impulse(vec(omega), vec(change(c, omega)), vec(wanted), seconds, rows(J))
            )
            torque = impulse / seconds
            after = integrated(c, omega, seconds, lambda _, push=torque: push)
            lefts.append(np.linalg.norm(after - wanted))
            assert lefts[-1] < 0.05 * np.linalg.norm(omega - wanted)
        assert lefts[0] < 0.6 * lefts[1], "what is left falls with the length of the pulse"


class TestBestImpulse:
    @pytest.mark.parametrize("seed", range(20))
    def test_leaves_the_least_of_all_dipoles(self, seed):
        """Against scipy over three components of m; of those along b it does not matter."""
        rng = np.random.default_rng(seed)
        r, b = rng.normal(size=3), rng.normal(size=3)

        def left(m):
            rest = r - np.cross(m, b)
            return rest @ J_INVERSE @ rest

        p = np.array(best_impulse(vec(r), vec(b), rows(J)))
        found = minimize(left, np.zeros(3), tol=1e-12)
        ours = (r - p) @ J_INVERSE @ (r - p)
        assert ours == pytest.approx(found.fun, rel=1e-6, abs=1e-9)
        np.testing.assert_allclose(p, np.cross(found.x, b), atol=1e-4)

    @pytest.mark.parametrize("seed", range(5))
    def test_is_normal_to_the_field_and_leaves_what_no_coil_can_take(self, seed):
        """What is left is along J b: to it every impulse normal to b is orthogonal in the metric J^-1."""
        rng = np.random.default_rng(seed)
        r, b = rng.normal(size=3), rng.normal(size=3) * 3e-5
        p = np.array(best_impulse(vec(r), vec(b), rows(J)))
        assert abs(p @ b) < 1e-14 * np.linalg.norm(b) * 10
        np.testing.assert_allclose(np.cross(r - p, J @ b), 0.0, atol=1e-18)

    def test_a_smaller_impulse_along_the_field_is_left_whole(self):
        b = np.array([1e-5, -2e-5, 3e-5])
        assert best_impulse(vec(7.0 * J @ b), vec(b), rows(J)) == pytest.approx((0.0, 0.0, 0.0), abs=1e-18)


@pytest.mark.parametrize("seed", range(10))
def test_the_cost_of_the_paper_is_what_is_left_of_the_impulse_in_the_metric_of_the_inverse(seed):
    """1/2 (Omega+ - Omega_ref)^T J (Omega+ - Omega_ref), Omega+ predicted with m, for any m."""
    rng = np.random.default_rng(seed)
    c, omega = random_motion(rng)
    b, m, wanted = rng.normal(size=3) * 3e-5, rng.normal(size=3) * 20.0, np.array([0.02, 0.0, 0.0])
    free = change(c, omega)
    predicted = omega + PULSE_S * (free + J_INVERSE @ np.cross(m, b))
    paper = 0.5 * (predicted - wanted) @ J @ (predicted - wanted)
    r = np.array(missing_impulse(vec(omega), vec(free), vec(wanted), PULSE_S, rows(J)))
    left = r - PULSE_S * np.cross(m, b)
    assert 0.5 * left @ J_INVERSE @ left == pytest.approx(paper, rel=1e-9)


SETPOINT = Setpoint("predictive", k_w=1.0, k_a=2.0, k_i=3.0, spin_radps=0.02)
CONFIG = ControlConfig(
    setpoint=SETPOINT,
    gains={},
    inertia_kgm2=rows(J),
    inertia_inverse=rows(J_INVERSE),
    wheel_body_nms=vec(WHEEL_NMS),
    pulsed=True,
    tick_s=0.25,
    horizon_s=PULSE_S,
    mean_dipole_am2=0.2,
)
Q = (0.8, 0.36, -0.288, 0.384)
REFERENCE = Reference((RADIUS_M, 0.0, 0.0), RADIUS_M, (1e-5, 2e-5, 3e-5), (1.0, 0.0, 0.0), True, Q, W0)


def inputs(attitude, reference=REFERENCE):
    return LawInput(attitude, (1e-5, -2e-5, 3e-5), FieldSample(), FieldSample(), reference=reference)


KNOWN = Attitude(Q, (0.011, -0.007, 0.005), 0.01, 1e-4, True)


class TestLaw:
    def test_asks_for_the_impulse_that_brings_the_spin_that_is_wanted(self):
        """With scipy's rotation, whose matrix turns vectors: ours, transposed."""
        c = Rotation.from_quat([*Q[1:], Q[0]]).as_matrix().T
        omega = np.array(KNOWN.omega_body_orbit_radps)
        expected = J @ (np.array([0.02, 0.0, 0.0]) - omega - PULSE_S * change(c, omega))
        demand = predictive(inputs(KNOWN), (), SETPOINT, CONFIG)
        assert demand.impulse_body_nms == pytest.approx(vec(expected), rel=1e-9)
        assert demand.replace(impulse_body_nms=None) == Demand(), "no dipole besides, and no memory"

    def test_what_the_known_disturbances_do_over_a_pulse_is_missing_besides(self):
        """The impulses of the torque and of the residual dipole in the field, taken off."""
        torque, dipole, b = np.array([2e-7, -3e-7, 5e-7]), np.array([0.03, 0.01, -0.02]), (1e-5, -2e-5, 3e-5)
        given = inputs(KNOWN).replace(torque_body_nm=vec(torque), dipole_body_am2=vec(dipole))
        without, known = (
            np.array(predictive(case, (), SETPOINT, CONFIG).impulse_body_nms)
            for case in (inputs(KNOWN), given)
        )
        expected = -PULSE_S * (torque + np.cross(dipole, b))
        assert known - without == pytest.approx(expected, abs=1e-15)

    @pytest.mark.parametrize(
        ("attitude", "reference"),
        [(UNKNOWN, REFERENCE), (KNOWN.invalid(), REFERENCE), (KNOWN, None)],
    )
    def test_without_attitude_or_orbit_it_asks_for_nothing(self, attitude, reference):
        assert predictive(inputs(attitude, reference), (), SETPOINT, CONFIG) == Demand()

    def test_the_gains_do_not_matter(self):
        other = replace(SETPOINT, k_w=9.0, k_a=9.0, k_i=9.0)
        assert predictive(inputs(KNOWN), (), other, CONFIG) == predictive(inputs(KNOWN), (), SETPOINT, CONFIG)
