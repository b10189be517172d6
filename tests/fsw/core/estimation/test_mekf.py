"""The filter: its linearisation against the nonlinear flow, its update against the textbook, its gate.

The numbers are chosen so that no term can hide behind another: an inertia tensor with products, rates about
all axes, and, for the linearisation, a field, dipole and gravity gradient of order one.
"""

import csv
from math import cos, inf, nan, radians, sin
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from fsw.core.algebra.quaternion import conjugate, multiply, normalise, rotate
from fsw.core.algebra.vector import ZERO, norm, unit
from fsw.core.estimation import mekf
from fsw.core.estimation.mekf import Estimate, predict, start, update_both, update_field, update_sun
from fsw.core.estimation.mekf_config import layout, mekf_config
from sim.plant.dynamics import torques
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.environment.surroundings import Surroundings

INERTIA = ((1.02, 0.07, -0.05), (0.07, 1.85, 0.11), (-0.05, 0.11, 1.45))
J = np.array(INERTIA)
J_INVERSE = np.linalg.inv(J)
LAYOUTS = [(False, False), (True, False), (False, True), (True, True)]
EVERY_LAYOUT = pytest.mark.parametrize(("bias", "torque"), LAYOUTS, ids=["6", "9 bias", "9 torque", "12"])

Q = normalise((0.6, -0.4, 0.5, 0.3))
OMEGA = (0.021, -0.034, 0.027)
BIAS_T = (3e-7, -5e-7, 2e-7)
TORQUE_NM = (4e-8, -2e-8, 3e-8)
E1_ECI = unit((0.3, 0.7, -0.5))
B_ECI_T = (1.7e-5, -2.3e-5, 3.1e-5)
S_ECI = unit((-0.8, 0.35, 0.4))
GRAVITY_PS2 = 3.3e-6
DIPOLE_AM2 = (0.0, -8.0, 2.0)


def make_config(bias=True, torque=True, **changes):
    values = {
        "tick_s": 1.0,
        "magnetometer_sigma_t": 2e-7,
        "sun_sigma_rad": radians(0.5),
        "attitude_sigma_rad": radians(5.0),
        "rate_sigma_radps": radians(2.0),
        "bias_sigma_t": 3e-7,
        "torque_sigma_nm": 1e-7,
        "torque_noise_nm_rts": 1e-7,
        "bias_walk_t_prts": 1e-10,
        "torque_walk_nm_prts": 3e-10,
        "gate_nis": 16.27,
    }
    return mekf_config(INERTIA, estimate_bias=bias, estimate_torque=torque, **(values | changes))


def make_estimate(config, covariance=None):
    """An estimate with everything nonzero; what the layout leaves out is known and constant."""
    if covariance is None:
        covariance = random_covariance(config.layout.size)
    return Estimate(Q, OMEGA, BIAS_T, TORQUE_NM, covariance)


def random_covariance(size):
    """Full, positive definite, in the units of each state."""
    random = np.random.default_rng(size)
    root = random.normal(size=(size, size))
    sigma = scales(size, layout_of(size))
    return np.outer(sigma, sigma) * (root @ root.T / size + 0.1 * np.eye(size))


def layout_of(size):
    return {6: layout(False, False), 9: layout(True, False), 12: layout(True, True)}[size]


def scales(size, parts):
    """A typical deviation of each state: rad, rad/s, T, N m."""
    sigma = np.full(size, 1e-3)
    sigma[3:6] = 1e-4
    if parts.bias is not None:
        sigma[parts.bias : parts.bias + 3] = 2e-7
    if parts.torque is not None:
        sigma[parts.torque : parts.torque + 3] = 5e-8
    return sigma


def matrix_of(q):
    """C(q), written out once more."""
    q0, v = q[0], np.array(q[1:])
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return (q0**2 - v @ v) * np.eye(3) + 2 * np.outer(v, v) - 2 * q0 * cross


def product(p, q):
    p0, pv, q0, qv = p[0], np.array(p[1:]), q[0], np.array(q[1:])
    return np.array([p0 * q0 - pv @ qv, *(p0 * qv + q0 * pv + np.cross(pv, qv))])


def flow(q, omega, torque, e1_eci, b_eci, gravity, dipole, duration_s):
    """The nonlinear motion, integrated to 1e-13: J dw/dt = m x b + g e x J e + T - w x J w."""

    def rates(_, state):
        quaternion, w = state[:4], state[4:]
        c = matrix_of(quaternion / np.linalg.norm(quaternion))
        e, b = c @ e1_eci, c @ b_eci
        moment = np.cross(dipole, b) + gravity * np.cross(e, J @ e) + torque - np.cross(w, J @ w)
        return np.concatenate((0.5 * product(quaternion, (0.0, *w)), J_INVERSE @ moment))

    solved = solve_ivp(rates, (0.0, duration_s), (*q, *omega), method="DOP853", rtol=1e-13, atol=1e-15)
    end = solved.y[:, -1]
    return end[:4] / np.linalg.norm(end[:4]), end[4:]


def error_between(q_from, q_to):
    """dtheta with q_to = q_from (x) (1, dtheta / 2), to first order."""
    turn = product((q_from[0], *(-np.array(q_from[1:]))), q_to)
    return 2.0 * turn[1:] * np.sign(turn[0])


def angle_rad(p, q):
    turn = multiply(conjugate(tuple(p)), tuple(q))
    return 2.0 * np.arctan2(norm(turn[1:]), abs(turn[0]))


@EVERY_LAYOUT
def test_a_start_knows_the_attitude_and_nothing_else(bias, torque):
    config = make_config(bias, torque)
    begun = start(Q, ZERO, config)
    assert (begun.q_body_from_eci, begun.omega_body_radps) == (Q, ZERO)
    assert (begun.mag_bias_t, begun.torque_body_nm) == (ZERO, ZERO)
    np.testing.assert_array_equal(begun.covariance, config.initial_covariance)


class TestTransition:
    """One error direction e as covariance e e^T comes out of a noiseless prediction as (F e)(F e)^T."""

    TICK_S = 0.01
    STRONG = (np.array([0.5, -0.7, 0.3]), np.array([0.3, -0.2, 0.5]), 0.4)
    """Dipole, field and gravity gradient of order one: their terms weigh as much as the rates'."""
    RATE = (0.21, -0.34, 0.27)
    TORQUE = (0.05, -0.03, 0.04)

    def transition(self, config):
        m, b, gravity = self.STRONG
        columns = []
        for index in range(config.layout.size):
            direction = np.zeros(config.layout.size)
            direction[index] = 1.0
            before = Estimate(Q, self.RATE, ZERO, self.TORQUE, np.outer(direction, direction))
            after = predict(before, E1_ECI, tuple(b), gravity, tuple(m), config).covariance
            columns.append(after[:, index] / np.sqrt(after[index, index]))
        return np.array(columns).T

    def by_differences(self, config, step=1e-4):
        parts = config.layout
        m, b, gravity = self.STRONG

        def moved(error):
            q = product(Q, (1.0, *(0.5 * error[0:3])))
            bias = error[parts.bias : parts.bias + 3] if parts.bias is not None else np.zeros(0)
            torque = np.array(self.TORQUE)
            push = error[parts.torque : parts.torque + 3] if parts.torque is not None else np.zeros(0)
            torque = torque + push if len(push) else torque
            rate = np.array(self.RATE) + error[3:6]
            q, omega = flow(q / np.linalg.norm(q), rate, torque, E1_ECI, b, gravity, m, self.TICK_S)
            return q, np.concatenate((omega, bias, push))

        nominal, _ = moved(np.zeros(parts.size))
        columns = []
        for index in range(parts.size):
            error = np.zeros(parts.size)
            error[index] = step
            (q_up, rest_up), (q_down, rest_down) = moved(error), moved(-error)
            turn = (error_between(nominal, q_up) - error_between(nominal, q_down)) / (2.0 * step)
            columns.append(np.concatenate((turn, (rest_up - rest_down) / (2.0 * step))))
        return np.array(columns).T

    @EVERY_LAYOUT
    def test_is_the_derivative_of_the_flow(self, bias, torque):
        noiseless = {"torque_noise_nm_rts": 0.0, "bias_walk_t_prts": 0.0, "torque_walk_nm_prts": 0.0}
        config = make_config(bias, torque, tick_s=self.TICK_S, **noiseless)
        np.testing.assert_allclose(self.transition(config), self.by_differences(config), rtol=0.0, atol=1e-7)

    def test_every_block_that_should_be_there_is(self):
        """Terms of first order are 1e-3 and more: far above the tolerance that they are held to."""
        config = make_config(
            tick_s=self.TICK_S, torque_noise_nm_rts=0.0, bias_walk_t_prts=0.0, torque_walk_nm_prts=0.0
        )
        f = self.transition(config) - np.eye(12)
        for rows, columns in ((0, 0), (0, 3), (3, 0), (3, 3), (3, 9)):
            assert np.abs(f[rows : rows + 3, columns : columns + 3]).max() > 5e-4
        for rows, columns in ((0, 6), (3, 6), (6, 0), (6, 3), (6, 6), (6, 9), (9, 0), (9, 3), (9, 6), (9, 9)):
            assert np.abs(f[rows : rows + 3, columns : columns + 3]).max() == 0.0


class TestProcessNoise:
    def test_is_white_torque_through_the_inertia_and_two_random_walks(self):
        """Q = N [[h^3/3, h^2/2], [h^2/2, h]] with N = sigma^2 J^-1 J^-T."""
        h, config = 0.5, make_config(tick_s=0.5)
        still = Estimate((1.0, 0.0, 0.0, 0.0), ZERO, ZERO, ZERO, np.zeros((12, 12)))
        noise = predict(still, E1_ECI, ZERO, 0.0, ZERO, config).covariance
        rate = 1e-7**2 * J_INVERSE @ J_INVERSE.T
        expected = np.zeros((12, 12))
        expected[0:3, 0:3] = rate * h**3 / 3.0
        expected[0:3, 3:6] = expected[3:6, 0:3] = rate * h**2 / 2.0
        expected[3:6, 3:6] = rate * h
        expected[6:9, 6:9] = np.eye(3) * 1e-10**2 * h
        expected[9:12, 9:12] = np.eye(3) * 3e-10**2 * h
        np.testing.assert_allclose(noise, expected, rtol=1e-12, atol=0.0)

    def test_a_driven_dipole_adds_its_own_along_the_kick_it_gives(self):
        """Q_rate += (J^-1 (m x b) sigma h)(...)^T, at the attitude of the middle of the tick."""
        sigma, h = 0.05, 0.5
        exact, unsure = (make_config(tick_s=h, dipole_sigma=given) for given in (0.0, sigma))
        still = Estimate((1.0, 0.0, 0.0, 0.0), ZERO, ZERO, ZERO, np.zeros((12, 12)))
        added = (
            predict(still, E1_ECI, B_ECI_T, 0.0, DIPOLE_AM2, unsure).covariance
            - predict(still, E1_ECI, B_ECI_T, 0.0, DIPOLE_AM2, exact).covariance
        )
        kick = sigma * h * J_INVERSE @ np.cross(DIPOLE_AM2, B_ECI_T)
        expected = np.zeros((12, 12))
        expected[3:6, 3:6] = np.outer(kick, kick)
        np.testing.assert_allclose(added, expected, rtol=0.0, atol=1e-6 * kick @ kick)

    def test_an_unsure_dipole_that_is_not_driven_adds_nothing(self):
        still = make_estimate(make_config())
        unsure = predict(still, E1_ECI, B_ECI_T, GRAVITY_PS2, ZERO, make_config(dipole_sigma=0.05))
        exact = predict(still, E1_ECI, B_ECI_T, GRAVITY_PS2, ZERO, make_config())
        assert np.array_equal(unsure.covariance, exact.covariance)


class TestPropagation:
    def flown(self, tick_s, seconds, omega=OMEGA, dipole=DIPOLE_AM2):
        config = make_config(tick_s=tick_s)
        estimate = make_estimate(config)._replace(omega_body_radps=omega)
        for _ in range(round(seconds / tick_s)):
            estimate = predict(estimate, E1_ECI, B_ECI_T, GRAVITY_PS2, dipole, config)
        return estimate

    def by_plant(self, seconds, omega=OMEGA, dipole=DIPOLE_AM2):
        body, motion = RigidBody(INERTIA), Motion(Q, omega)
        place = Surroundings(E1_ECI, GRAVITY_PS2, B_ECI_T)
        for _ in range(seconds * 20):
            motion = body.step(
                motion, lambda q, _, at: torques.total(INERTIA, q, at, dipole, TORQUE_NM), [place] * 3, 0.05
            )
        return motion

    def test_sixty_seconds_beside_the_plant(self):
        ours, plant = self.flown(1.0, 60), self.by_plant(60)
        assert angle_rad(ours.q_body_from_eci, plant.q_body_from_eci) < 2e-4
        np.testing.assert_allclose(ours.omega_body_radps, plant.omega_body_radps, atol=5e-6)
        assert angle_rad(ours.q_body_from_eci, Q) > 0.5

    def test_sixty_seconds_of_coasting_at_a_flight_rate(self):
        """0.1 deg/s and no coil on: what the filter adds in a minute is far below what it measures."""
        slow = (0.0011, -0.0009, 0.0013)
        ours, plant = self.flown(1.0, 60, slow, ZERO), self.by_plant(60, slow, ZERO)
        assert angle_rad(ours.q_body_from_eci, plant.q_body_from_eci) < 1e-7
        np.testing.assert_allclose(ours.omega_body_radps, plant.omega_body_radps, atol=1e-9)

    def test_the_error_falls_with_the_square_of_the_tick(self):
        plant = self.by_plant(20)
        coarse, fine = (
            angle_rad(self.flown(tick_s, 20).q_body_from_eci, plant.q_body_from_eci) for tick_s in (1.0, 0.5)
        )
        assert coarse / fine == pytest.approx(4.0, rel=0.15)

    def test_bias_and_torque_stay_and_the_quaternion_stays_unit(self):
        ours = self.flown(1.0, 60)
        assert (ours.mag_bias_t, ours.torque_body_nm) == (BIAS_T, TORQUE_NM)
        assert sum(c * c for c in ours.q_body_from_eci) == pytest.approx(1.0, abs=1e-14)

    @EVERY_LAYOUT
    def test_an_hour_without_measurement_keeps_the_covariance_sound(self, bias, torque):
        config = make_config(bias, torque)
        estimate = start(Q, (0.0011, -0.0009, 0.0013), config)
        for _ in range(3600):
            estimate = predict(estimate, E1_ECI, B_ECI_T, GRAVITY_PS2, ZERO, config)
        p = estimate.covariance
        sigma = np.sqrt(p.diagonal())
        np.testing.assert_allclose(p, p.T, rtol=0.0, atol=1e-9 * np.outer(sigma, sigma).max())
        assert np.linalg.eigvalsh(p / np.outer(sigma, sigma)).min() > -1e-9
        assert mekf.healthy(estimate)


SIGMA = {"field": np.full(3, 2e-7), "sun": np.full(3, radians(0.5))}
SIGMA["both"] = np.concatenate((SIGMA["field"], SIGMA["sun"]))
VECTOR = {"field": B_ECI_T, "sun": S_ECI}


def measure(kind, q, mag_bias):
    """What ideal sensors say: the field with the magnetometer's bias, the Sun, or both."""
    said = {"field": matrix_of(q) @ B_ECI_T + mag_bias, "sun": matrix_of(q) @ S_ECI}
    return np.concatenate((said["field"], said["sun"])) if kind == "both" else said[kind]


def update(kind, estimate, measured, config):
    """The filter's update with what was measured, (3,) or (6,)."""
    values = tuple(map(float, measured))
    if kind == "both":
        return update_both(estimate, values[:3], B_ECI_T, values[3:], S_ECI, config)
    return (update_field if kind == "field" else update_sun)(estimate, values, VECTOR[kind], config)


def textbook(estimate, innovation, sensitivity, sigma):
    """Information form: P+ = (P^-1 + H^T R^-1 H)^-1, dx = P+ H^T R^-1 z, in scaled states."""
    scale = np.sqrt(estimate.covariance.diagonal())
    p, h = estimate.covariance / np.outer(scale, scale), sensitivity * scale / sigma[:, None]
    covariance = np.linalg.inv(np.linalg.inv(p) + h.T @ h)
    return scale * (covariance @ h.T @ (innovation / sigma)), covariance * np.outer(scale, scale)


def sensitivity_by_differences(kind, estimate, parts, steps):
    """d(measured) / d(error), by central differences."""
    columns = []
    for index in range(parts.size):
        values = []
        for sign in (1.0, -1.0):
            error = np.zeros(parts.size)
            error[index] = sign * steps[index]
            q = product(estimate.q_body_from_eci, (1.0, *(0.5 * error[0:3])))
            bias = np.array(estimate.mag_bias_t)
            if parts.bias is not None:
                bias = bias + error[parts.bias : parts.bias + 3]
            values.append(measure(kind, q / np.linalg.norm(q), bias))
        columns.append((values[0] - values[1]) / (2.0 * steps[index]))
    return np.array(columns).T


@EVERY_LAYOUT
@pytest.mark.parametrize("kind", ["field", "sun", "both"])
class TestUpdate:
    def updated(self, kind, bias, torque):
        """(before, after, innovation, H by differences)."""
        config = make_config(bias, torque)
        parts = config.layout
        scale = scales(parts.size, parts)
        random = np.random.default_rng(parts.size + bias)
        root = random.normal(size=(parts.size, parts.size))
        covariance = np.outer(scale, scale) * (root @ root.T / parts.size + 0.1 * np.eye(parts.size))
        before = make_estimate(config, covariance)
        innovation = SIGMA[kind] * np.array([0.7, -1.1, 0.9, -0.8, 0.6, -1.2])[: len(SIGMA[kind])]
        after = update(kind, before, measure(kind, Q, BIAS_T) + innovation, config)
        h = sensitivity_by_differences(kind, before, parts, 1e-2 * scale)
        return config, before, after, innovation, h

    def test_is_the_textbook_s_with_the_model_s_derivative(self, kind, bias, torque):
        config, before, after, innovation, h = self.updated(kind, bias, torque)
        parts = config.layout
        dx, covariance = textbook(before, innovation, h, SIGMA[kind])
        scale = np.sqrt(before.covariance.diagonal())
        np.testing.assert_allclose(
            after.covariance / np.outer(scale, scale), covariance / np.outer(scale, scale), atol=1e-7
        )

        moved = np.zeros(parts.size)
        moved[0:3] = error_between(before.q_body_from_eci, after.q_body_from_eci)
        moved[3:6] = np.subtract(after.omega_body_radps, before.omega_body_radps)
        if parts.bias is not None:
            moved[parts.bias : parts.bias + 3] = np.subtract(after.mag_bias_t, before.mag_bias_t)
        if parts.torque is not None:
            moved[parts.torque : parts.torque + 3] = np.subtract(after.torque_body_nm, before.torque_body_nm)
        np.testing.assert_allclose(moved / scale, dx / scale, atol=1e-6)
        assert np.abs(moved / scale).max() > 1e-3

    def test_what_the_layout_leaves_out_is_left_alone(self, kind, bias, torque):
        _, before, after, *_ = self.updated(kind, bias, torque)
        assert (after.mag_bias_t != before.mag_bias_t) is bias
        assert (after.torque_body_nm != before.torque_body_nm) is torque

    def test_the_covariance_is_exactly_symmetric_and_shrinks(self, kind, bias, torque):
        _, before, after, *_ = self.updated(kind, bias, torque)
        np.testing.assert_array_equal(after.covariance, after.covariance.T)
        assert (after.covariance.diagonal() < before.covariance.diagonal()).all()

    def test_the_estimate_before_is_not_touched(self, kind, bias, torque):
        config = make_config(bias, torque)
        before = make_estimate(config, np.diag(scales(config.layout.size, config.layout) ** 2))
        kept, prior = before.covariance.copy(), config.initial_covariance.copy()
        assert update(kind, before, measure(kind, Q, BIAS_T) + 1e-9, config) is not None
        predict(before, E1_ECI, B_ECI_T, GRAVITY_PS2, DIPOLE_AM2, config)
        np.testing.assert_array_equal(before.covariance, kept)
        np.testing.assert_array_equal(config.initial_covariance, prior)
        assert not config.zero.any()
        np.testing.assert_array_equal(config.identity, np.eye(config.layout.size))


REFERENCE = Path(__file__).parents[3] / "reference" / "triad_mekf.csv"


def reference_cases():
    lines = [line for line in REFERENCE.read_text().splitlines() if not line.startswith("#")]
    return [pytest.param(row, id=f"{row['case']}-{row['kind']}") for row in csv.DictReader(lines)]


@pytest.mark.parametrize("row", reference_cases())
def test_from_no_knowledge_both_vectors_give_the_covariance_of_the_q_method(row):
    """With a prior P0 I, the inverse of P is that of the reference's p_dav plus I / P0.

    Linearised where the reference is, at its optimal attitude: measured as predicted there, so that the
    estimate stays.
    """
    p = {key: float(row[f"p_dav_{key}"]) for key in ("xx", "yy", "zz", "xy", "xz", "yz")}
    expected = np.array(
        [[p["xx"], p["xy"], p["xz"]], [p["xy"], p["yy"], p["yz"]], [p["xz"], p["yz"], p["zz"]]]
    )
    prior_rad2 = 1e3 * max(p.values())
    config = make_config(
        False,
        False,
        magnetometer_sigma_t=float(row["sigma1_rad"]),
        sun_sigma_rad=float(row["sigma2_rad"]),
        attitude_sigma_rad=prior_rad2**0.5,
    )
    q = normalise(tuple(float(row[f"q_dav_{index}"]) for index in range(4)))
    r1, r2 = (tuple(float(row[f"{name}_{axis}"]) for axis in "xyz") for name in ("r1", "r2"))
    estimate = start(q, ZERO, config)
    estimate = update_field(estimate, rotate(q, r1), r1, config)
    estimate = update_sun(estimate, rotate(q, r2), r2, config)
    assert angle_rad(estimate.q_body_from_eci, q) < 1e-12
    information = np.linalg.inv(estimate.covariance[0:3, 0:3]) - np.eye(3) / prior_rad2
    scale = np.sqrt(expected.diagonal())
    ours = np.linalg.inv(information * np.outer(scale, scale))
    np.testing.assert_allclose(ours, expected / np.outer(scale, scale), rtol=1e-6, atol=1e-6)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # overflow is what is tried
class TestGate:
    DIRECTIONS = (
        (1, 0, 0, 0, 0, 0),
        (0, 1, 0, 0, 0, 1),
        (0, 0, 1, 0, 1, 0),
        (0.5, -0.7, 0.4, -0.6, 0.8, 0.3),
    )

    def on_the_boundary(self, kind, before, parts, direction):
        """The innovation along ``direction`` whose NIS is exactly one."""
        h = sensitivity_by_differences(kind, before, parts, 1e-2 * scales(parts.size, parts))
        s = h @ before.covariance @ h.T + np.diag(SIGMA[kind] ** 2)
        along = SIGMA[kind] * np.array(direction[: len(s)], dtype=float)
        return along / np.sqrt(along @ np.linalg.solve(s, along))

    @pytest.mark.parametrize("direction", DIRECTIONS)
    @pytest.mark.parametrize(("nis", "taken"), [(0.0, True), (16.2, True), (16.35, False), (1e6, False)])
    @pytest.mark.parametrize("kind", ["field", "sun", "both"])
    def test_by_the_normalised_innovation(self, kind, nis, taken, direction):
        config = make_config()
        before = make_estimate(config)
        innovation = nis**0.5 * self.on_the_boundary(kind, before, config.layout, direction)
        after = update(kind, before, measure(kind, Q, BIAS_T) + innovation, config)
        assert (after is not None) is taken

    def test_an_outlier_is_refused_where_the_filter_is_sure_and_taken_where_it_is_not(self):
        config = make_config()
        off = tuple(c + 5e-6 for c in rotate(Q, B_ECI_T))
        sure = make_estimate(config)._replace(covariance=np.diag(scales(12, config.layout) ** 2))
        unsure = sure._replace(covariance=config.initial_covariance * 100.0)
        assert update_field(sure, off, B_ECI_T, config) is None
        assert update_field(unsure, off, B_ECI_T, config) is not None

    BAD = (nan, inf, -inf)

    @pytest.mark.parametrize("bad", BAD)
    @pytest.mark.parametrize(
        ("kind", "axis"), [(kind, axis) for kind, sigma in SIGMA.items() for axis in range(len(sigma))]
    )
    def test_what_is_no_number_never_gets_through(self, kind, axis, bad):
        config = make_config()
        measured = measure(kind, Q, BIAS_T)
        measured[axis] = bad
        for covariance in (random_covariance(12), config.initial_covariance * 1e12):
            assert update(kind, make_estimate(config, covariance), measured, config) is None

    @given(
        st.tuples(*[st.floats(-1e300, 1e300) | st.sampled_from(BAD)] * 6),
        st.sampled_from(list(SIGMA)),
        st.floats(1e-6, 1e6),
    )
    @example((0.0, 8.59e86, -1.275e209, 0.0, 0.0, 1.0), "field", 1.0)  # overflows to a NIS of -inf
    @settings(max_examples=300)
    def test_whatever_is_measured_what_comes_out_is_sound(self, measured, kind, widen):
        config = make_config()
        before = make_estimate(config, config.initial_covariance * widen)
        after = update(kind, before, measured[: len(SIGMA[kind])], config)
        if after is not None:
            assert mekf.healthy(after)
            assert np.isfinite(after.covariance).all()


class TestHealthy:
    def test_a_sound_estimate_is(self):
        assert mekf.healthy(make_estimate(make_config()))

    @pytest.mark.parametrize("bad", [nan, inf, -inf])
    @pytest.mark.parametrize("field", ["q_body_from_eci", "omega_body_radps", "mag_bias_t", "torque_body_nm"])
    def test_a_number_that_is_none_is_not(self, field, bad):
        sound = make_estimate(make_config())
        values = list(getattr(sound, field))
        for index in range(len(values)):
            broken = values.copy()
            broken[index] = bad
            assert not mekf.healthy(sound._replace(**{field: tuple(broken)}))

    @pytest.mark.parametrize("bad", [nan, inf, 0.0, -1e-12, 2e6, 1e300])
    def test_a_variance_that_is_none_is_not(self, bad):
        for index in range(12):
            covariance = random_covariance(12)
            covariance[index, index] = bad
            assert not mekf.healthy(make_estimate(make_config(), covariance))

    @pytest.mark.filterwarnings("ignore::RuntimeWarning")
    def test_what_is_broken_off_the_diagonal_shows_after_one_prediction(self):
        config = make_config()
        for row, column in ((0, 1), (2, 7), (11, 3)):
            covariance = random_covariance(12)
            covariance[row, column] = nan
            after = predict(make_estimate(config, covariance), E1_ECI, B_ECI_T, GRAVITY_PS2, ZERO, config)
            assert not mekf.healthy(after)


class TestObservability:
    """Twenty minutes of a slow tumble under a field that turns: every state is found, within its sigma."""

    SECONDS = 1200
    BIAS_T = (4e-7, -3e-7, 5e-7)
    TORQUE_NM = (9e-8, -6e-8, 7e-8)

    def flown(self, bias, torque):
        random = np.random.default_rng(20000)
        config = make_config(bias, torque)
        true_bias = np.array(self.BIAS_T if bias else ZERO)
        push = self.TORQUE_NM if torque else ZERO
        body, motion = RigidBody(INERTIA), Motion(Q, (0.003, -0.005, 0.004))
        estimate = start(multiply(Q, normalise((1.0, 0.02, -0.015, 0.01))), ZERO, config)
        for second in range(1, self.SECONDS + 1):
            u = 0.00104 * second
            e1 = (cos(u), sin(u), 0.0)
            b = tuple(2.2e-5 * c for c in (-2.0 * sin(u), 0.3 + cos(u), 0.4 - 0.5 * sin(u)))
            place = Surroundings(e1, GRAVITY_PS2, b)
            motion = body.step(
                motion, lambda q, _, at: torques.total(INERTIA, q, at, ZERO, push), [place] * 3, 1.0
            )
            estimate = predict(estimate, e1, b, GRAVITY_PS2, ZERO, config)
            measured_b = np.array(rotate(motion.q_body_from_eci, b)) + true_bias + random.normal(0.0, 2e-7, 3)
            measured_s = np.array(rotate(motion.q_body_from_eci, S_ECI)) + random.normal(0.0, radians(0.5), 3)
            after = update_field(estimate, tuple(measured_b.tolist()), b, config)
            estimate = after or estimate
            after = update_sun(estimate, tuple(measured_s.tolist()), S_ECI, config)
            estimate = after or estimate
        return config, motion, estimate

    @EVERY_LAYOUT
    def test_all_states_are_found(self, bias, torque):
        config, motion, estimate = self.flown(bias, torque)
        parts = config.layout
        error = np.zeros(parts.size)
        error[0:3] = error_between(estimate.q_body_from_eci, motion.q_body_from_eci)
        error[3:6] = np.subtract(motion.omega_body_radps, estimate.omega_body_radps)
        if bias:
            error[parts.bias : parts.bias + 3] = np.subtract(self.BIAS_T, estimate.mag_bias_t)
        if torque:
            error[parts.torque : parts.torque + 3] = np.subtract(self.TORQUE_NM, estimate.torque_body_nm)
        sigma = np.sqrt(estimate.covariance.diagonal())
        prior = np.sqrt(config.initial_covariance.diagonal())
        assert (np.abs(error) < 4.0 * sigma).all()
        assert (sigma < 0.3 * prior).all()
        assert np.linalg.norm(error[0:3]) < radians(0.2)
        assert error @ np.linalg.solve(estimate.covariance, error) < 40.0

    def test_a_bias_that_is_not_modelled_spoils_the_attitude(self):
        """With 6 states the filter is sure and wrong: this is what the bias states are for."""
        config = make_config(False, False)
        biased = tuple(b + 3.0 * e for b, e in zip(rotate(Q, B_ECI_T), self.BIAS_T, strict=True))
        estimate = start(Q, ZERO, config)
        for _ in range(50):
            estimate = update_field(estimate, biased, B_ECI_T, config) or estimate
        error = error_between(estimate.q_body_from_eci, Q)
        assert np.linalg.norm(error) > radians(0.5)
        along = error / np.linalg.norm(error)
        assert np.linalg.norm(error) > 5.0 * np.sqrt(along @ estimate.covariance[0:3, 0:3] @ along)


class TestBothAtOnce:
    """Field and Sun in one update: what the two give one after the other, behind no laxer gate."""

    @settings(max_examples=50)
    @given(st.tuples(*[st.floats(-1.0, 1.0)] * 6))
    def test_equals_one_after_the_other_to_first_order(self, offsets):
        config = make_config()
        estimate = start(Q, OMEGA, config)
        b = np.array(rotate(Q, B_ECI_T)) + 2e-8 * np.array(offsets[:3])
        s = np.array(rotate(Q, S_ECI)) + 1e-3 * np.array(offsets[3:])
        both = update_both(estimate, tuple(b.tolist()), B_ECI_T, tuple(s.tolist()), S_ECI, config)
        sooner = update_field(estimate, tuple(b.tolist()), B_ECI_T, config)
        later = update_sun(sooner, tuple(s.tolist()), S_ECI, config)
        turn = multiply(conjugate(both.q_body_from_eci), later.q_body_from_eci)
        assert 2.0 * max(map(abs, turn[1:])) < 1e-5
        np.testing.assert_allclose(both.mag_bias_t, later.mag_bias_t, atol=1e-3 * 3e-7)
        sigma = np.sqrt(both.covariance.diagonal())
        np.testing.assert_allclose(
            both.covariance / np.outer(sigma, sigma), later.covariance / np.outer(sigma, sigma), atol=5e-3
        )

    @pytest.mark.parametrize("kind", ["neither", "field", "sun"])
    def test_takes_neither_when_one_alone_is_far_off(self, kind):
        config = make_config(attitude_sigma_rad=1e-4, rate_sigma_radps=1e-6)
        estimate = start(Q, OMEGA, config)
        b, s = rotate(Q, B_ECI_T), rotate(Q, S_ECI)
        b = (b[0] + 5e-6, b[1], b[2]) if kind == "field" else b
        s = (s[0], s[1] + 0.2, s[2]) if kind == "sun" else s
        assert (update_both(estimate, b, B_ECI_T, s, S_ECI, config) is None) == (kind != "neither")
