"""Multiplicative extended Kalman filter for attitude, rate, magnetometer bias and disturbance torque.

The attitude lives outside the filter as a unit quaternion. The filter carries the error state
(dtheta, domega, then magnetometer bias and disturbance torque where switched on); after each update the
error is folded into the estimate, q <- q (x) (1, dtheta / 2), and reset to zero. With e1 the radius
direction, m the dipole and b the field, all in body axes:

    d(dtheta)/dt = -omega x dtheta + domega
    J d(domega)/dt = ([J omega x] - [omega x] J) domega
                   + (3 mu/r^3 ([e1 x] J - [J e1 x]) [e1 x] + [m x][b x]) dtheta + dtorque

Source: Lefferts, Markley, Shuster 1982; the dynamics as in Ovchinnikov, Penkov, Roldugin 2015.
"""

from copy import copy
from dataclasses import dataclass
from math import isfinite

import numpy as np
from filterpy.kalman import ExtendedKalmanFilter
from numpy.typing import NDArray

from fsw.core.quaternion import Quaternion, from_small_rotation, multiply, normalise, rotate
from fsw.core.vector import ZERO, Mat3, Vec3, add, cross, inverse, product, scale, skew, sub, transform

Matrix = NDArray[np.float64]

MAX_VARIANCE = 1e6
"""Beyond it an estimate says nothing (1000 rad), and the algebra comes near the end of the numbers."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """Attitude, inertial rate, biases, and the covariance of the error state.

    Units: rad, rad/s, T, N m. The covariance is (n, n) with n = 6, 9 or 12, laid out as ``Layout`` says.
    """

    q_body_from_eci: Quaternion
    omega_body_radps: Vec3
    mag_bias_t: Vec3
    torque_body_nm: Vec3
    covariance: Matrix


@dataclass(frozen=True, slots=True)
class Layout:
    """Where the switchable parts of the error state begin; None where switched off."""

    size: int
    bias: int | None
    torque: int | None


@dataclass(frozen=True, slots=True)
class MekfConfig:
    """The filter's tuning and what is derived from it once.

    ``process_noise`` is the covariance added per tick and ``system`` the constant part of the system matrix,
    both (n, n); ``field_sensitivity`` and ``sun_sensitivity`` are the constant parts of H, (3, n), and
    ``field_noise`` and ``sun_noise`` the measurement covariances, (3, 3). ``blank`` is a filter to copy.
    """

    inertia_kgm2: Mat3
    inertia_inverse: Mat3
    tick_s: float
    layout: Layout
    initial_covariance: Matrix
    process_noise: Matrix
    system: Matrix
    field_sensitivity: Matrix
    sun_sensitivity: Matrix
    field_noise: Matrix
    sun_noise: Matrix
    gate_nis: float
    blank: ExtendedKalmanFilter


def layout(estimate_bias: bool, estimate_torque: bool) -> Layout:
    """The layout of the error state with the parts that are switched on."""
    bias = 6 if estimate_bias else None
    torque = (9 if estimate_bias else 6) if estimate_torque else None
    return Layout(size=6 + 3 * estimate_bias + 3 * estimate_torque, bias=bias, torque=torque)


def mekf_config(
    inertia_kgm2: Mat3,
    tick_s: float,
    *,
    estimate_bias: bool,
    estimate_torque: bool,
    magnetometer_sigma_t: float,
    sun_sigma_rad: float,
    attitude_sigma_rad: float,
    rate_sigma_radps: float,
    bias_sigma_t: float,
    torque_sigma_nm: float,
    torque_noise_nm_rts: float,
    bias_walk_t_prts: float,
    torque_walk_nm_prts: float,
    gate_nis: float,
) -> MekfConfig:
    """Prepare the filter.

    Args:
        inertia_kgm2: inertia tensor, body axes.
        tick_s: length of a tick, s.
        estimate_bias: carry the magnetometer bias.
        estimate_torque: carry the disturbance torque.
        magnetometer_sigma_t: standard deviation of a field component, T.
        sun_sigma_rad: standard deviation of the Sun direction per tangential axis, rad.
        attitude_sigma_rad: initial standard deviation, as are the next three.
        rate_sigma_radps: rad/s.
        bias_sigma_t: T.
        torque_sigma_nm: N m.
        torque_noise_nm_rts: white torque noise, N m sqrt(s).
        bias_walk_t_prts: random walk of the bias, T / sqrt(s).
        torque_walk_nm_prts: random walk of the torque, N m / sqrt(s).
        gate_nis: largest normalised innovation squared that is taken.
    """
    parts = layout(estimate_bias, estimate_torque)
    inverse_j = inverse(inertia_kgm2)
    j_inverse = np.array(inverse_j)
    rate_noise = torque_noise_nm_rts**2 * (j_inverse @ j_inverse.T)
    noise = np.zeros((parts.size, parts.size))
    noise[0:3, 0:3] = rate_noise * tick_s**3 / 3.0
    noise[0:3, 3:6] = noise[3:6, 0:3] = rate_noise * tick_s**2 / 2.0
    noise[3:6, 3:6] = rate_noise * tick_s
    system = np.zeros((parts.size, parts.size))
    system[0:3, 3:6] = np.eye(3)
    variances = [attitude_sigma_rad**2] * 3 + [rate_sigma_radps**2] * 3
    field_sensitivity = np.zeros((3, parts.size))
    if parts.bias is not None:
        here = slice(parts.bias, parts.bias + 3)
        field_sensitivity[:, here] = np.eye(3)
        noise[here, here] = np.eye(3) * bias_walk_t_prts**2 * tick_s
        variances += [bias_sigma_t**2] * 3
    if parts.torque is not None:
        here = slice(parts.torque, parts.torque + 3)
        noise[here, here] = np.eye(3) * torque_walk_nm_prts**2 * tick_s
        system[3:6, here] = j_inverse
        variances += [torque_sigma_nm**2] * 3
    return MekfConfig(
        inertia_kgm2=inertia_kgm2,
        inertia_inverse=inverse_j,
        tick_s=tick_s,
        layout=parts,
        initial_covariance=np.diag(variances),
        process_noise=noise,
        system=system,
        field_sensitivity=field_sensitivity,
        sun_sensitivity=np.zeros((3, parts.size)),
        field_noise=np.eye(3) * magnetometer_sigma_t**2,
        sun_noise=np.eye(3) * sun_sigma_rad**2,
        gate_nis=gate_nis,
        blank=_blank(parts.size),
    )


def start(q_body_from_eci: Quaternion, omega_body_radps: Vec3, config: MekfConfig) -> Estimate:
    """The estimate at start-up: a known attitude, everything else at its prior."""
    return Estimate(q_body_from_eci, omega_body_radps, ZERO, ZERO, config.initial_covariance)


def healthy(estimate: Estimate) -> bool:
    """Whether every number is finite and every variance positive and below ``MAX_VARIANCE``.

    Asked after a prediction, which brings a bad number off the diagonal of the covariance onto it.
    """
    variances: list[float] = estimate.covariance.diagonal().tolist()
    numbers = (
        *estimate.q_body_from_eci,
        *estimate.omega_body_radps,
        *estimate.mag_bias_t,
        *estimate.torque_body_nm,
    )
    return isfinite(sum(numbers)) and min(variances) > 0.0 and sum(variances) < MAX_VARIANCE


def predict(
    estimate: Estimate,
    e1_eci: Vec3,
    b_eci_t: Vec3,
    gravity_per_s2: float,
    m_body_am2: Vec3,
    config: MekfConfig,
) -> Estimate:
    """Carry estimate and covariance over one tick.

    Args:
        estimate: at the tick before.
        e1_eci: radius direction, inertial axes, unit.
        b_eci_t: field, inertial axes, T.
        gravity_per_s2: 3 mu / r^3, 1/s^2.
        m_body_am2: dipole driven over the tick, body axes, A m^2.
        config: the filter.
    """
    h = config.tick_s
    q, omega = estimate.q_body_from_eci, estimate.omega_body_radps
    e1, b = rotate(q, e1_eci), rotate(q, b_eci_t)
    torque = estimate.torque_body_nm
    alpha = _acceleration(omega, e1, b, gravity_per_s2, m_body_am2, torque, config)
    omega_mid = add(omega, scale(0.5 * h, alpha))
    q_mid = multiply(q, from_small_rotation(scale(0.5 * h, omega)))
    e1_mid, b_mid = rotate(q_mid, e1_eci), rotate(q_mid, b_eci_t)
    alpha_mid = _acceleration(omega_mid, e1_mid, b_mid, gravity_per_s2, m_body_am2, torque, config)
    transition = _transition(omega_mid, e1_mid, b_mid, gravity_per_s2, m_body_am2, config)

    ekf = copy(config.blank)
    ekf.P, ekf.F, ekf.Q = estimate.covariance, transition, config.process_noise
    ekf.predict()
    return Estimate(
        normalise(multiply(q, _turn(scale(h, omega_mid)))),
        add(omega, scale(h, alpha_mid)),
        estimate.mag_bias_t,
        torque,
        ekf.P,
    )


def update_field(estimate: Estimate, b_body_t: Vec3, b_eci_t: Vec3, config: MekfConfig) -> Estimate | None:
    """Take a magnetometer sample: z = b_measured - (C b_eci + bias). None when the gate rejects it."""
    predicted = rotate(estimate.q_body_from_eci, b_eci_t)
    innovation = sub(sub(b_body_t, predicted), estimate.mag_bias_t)
    return _update(estimate, innovation, predicted, config.field_sensitivity, config.field_noise, config)


def update_sun(estimate: Estimate, s_body: Vec3, s_eci: Vec3, config: MekfConfig) -> Estimate | None:
    """Take a Sun direction: z = s_measured - C s_eci. None when the gate rejects it."""
    predicted = rotate(estimate.q_body_from_eci, s_eci)
    innovation = sub(s_body, predicted)
    return _update(estimate, innovation, predicted, config.sun_sensitivity, config.sun_noise, config)


_NO_ERROR = np.zeros(3)


def _blank(size: int) -> ExtendedKalmanFilter:
    """A filter whose error state is zero. Its methods replace arrays and change none, so copies may share."""
    ekf = ExtendedKalmanFilter(dim_x=size, dim_z=3)
    ekf.x = np.zeros(size)  # filterpy's (n, 1) default would broadcast a flat z to (n, n)
    return ekf


def _update(
    estimate: Estimate, innovation: Vec3, predicted: Vec3, constant: Matrix, noise: Matrix, config: MekfConfig
) -> Estimate | None:
    """Take a vector measurement: H = [predicted x] in the attitude columns beside its constant part."""
    sensitivity = constant.copy()
    sensitivity[:, 0:3] = skew(predicted)
    ekf = copy(config.blank)
    ekf.P = estimate.covariance
    ekf.update(np.array(innovation), lambda _: sensitivity, lambda _: _NO_ERROR, R=noise)
    nis = float(ekf.y @ ekf.SI @ ekf.y)
    if not 0.0 <= nis <= config.gate_nis:  # overflow can make it -inf
        return None
    return _fold(estimate, ekf.x, 0.5 * (ekf.P + ekf.P.T), config.layout)


def _fold(estimate: Estimate, error: Matrix, covariance: Matrix, parts: Layout) -> Estimate:
    """Fold the error state into the estimate."""
    values: list[float] = error.tolist()
    bias, torque = estimate.mag_bias_t, estimate.torque_body_nm
    if parts.bias is not None:
        bias = add(bias, _three(values, parts.bias))
    if parts.torque is not None:
        torque = add(torque, _three(values, parts.torque))
    return Estimate(
        normalise(multiply(estimate.q_body_from_eci, from_small_rotation(_three(values, 0)))),
        add(estimate.omega_body_radps, _three(values, 3)),
        bias,
        torque,
        covariance,
    )


def _three(values: list[float], first: int) -> Vec3:
    return (values[first], values[first + 1], values[first + 2])


def _acceleration(
    omega: Vec3, e1: Vec3, b: Vec3, gravity_per_s2: float, m: Vec3, torque: Vec3, config: MekfConfig
) -> Vec3:
    """J domega/dt = m x b + 3 mu/r^3 e1 x J e1 - omega x J omega + torque, all in body axes."""
    j = config.inertia_kgm2
    gravity = scale(gravity_per_s2, cross(e1, transform(j, e1)))
    gyroscopic = cross(omega, transform(j, omega))
    return transform(config.inertia_inverse, sub(add(add(cross(m, b), gravity), torque), gyroscopic))


def _transition(omega: Vec3, e1: Vec3, b: Vec3, gravity_per_s2: float, m: Vec3, config: MekfConfig) -> Matrix:
    """I + A h + (A h)^2 / 2 of the error dynamics; with A of the middle of the tick good to second order."""
    j, j_inverse = config.inertia_kgm2, config.inertia_inverse
    gyroscopic = _minus(skew(transform(j, omega)), product(skew(omega), j))
    pull = scale(gravity_per_s2, e1)
    stiffness = product(_minus(product(skew(pull), j), skew(transform(j, pull))), skew(e1))
    if m != ZERO:
        stiffness = _plus(stiffness, product(skew(m), skew(b)))
    a = config.system.copy()
    a[0:3, 0:3] = skew(scale(-1.0, omega))
    a[3:6, 0:3] = product(j_inverse, stiffness)
    a[3:6, 3:6] = product(j_inverse, gyroscopic)
    a *= config.tick_s
    transition: Matrix = a + 0.5 * (a @ a)
    transition.flat[:: config.layout.size + 1] += 1.0
    return transition


def _plus(m: Mat3, n: Mat3) -> Mat3:
    return (add(m[0], n[0]), add(m[1], n[1]), add(m[2], n[2]))


def _minus(m: Mat3, n: Mat3) -> Mat3:
    return (sub(m[0], n[0]), sub(m[1], n[1]), sub(m[2], n[2]))


def _turn(rotation_rad: Vec3) -> Quaternion:
    """The quaternion of a rotation vector by the series of sine and cosine: 1e-9 rad off at 0.5 rad."""
    r1, r2, r3 = rotation_rad
    square = 0.25 * (r1 * r1 + r2 * r2 + r3 * r3)
    half_sinc = 0.5 - square * (1.0 / 12.0 - square / 240.0)
    cosine = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square / 720.0))
    return (cosine, half_sinc * r1, half_sinc * r2, half_sinc * r3)
