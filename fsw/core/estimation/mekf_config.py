"""The filter's tuning, and what follows from it once and for all."""

from dataclasses import dataclass

import numpy as np

from fsw.core.algebra.vector import ZERO, Mat3, Vec3, inverse
from fsw.core.estimation.kalman import Matrix


@dataclass(frozen=True, slots=True)
class Layout:
    """Where the switchable parts of the error state begin; None where switched off."""

    size: int
    bias: int | None
    torque: int | None


@dataclass(frozen=True, slots=True)
class MekfConfig:
    """The filter's tuning and what is derived from it once.

    ``process_noise`` is the covariance added per tick, (n, n). A being the system matrix and h the tick,
    ``constant`` is the constant part of 1 + A h, (n, n); ``moving`` (36, 12) is what its upper left 6x6 gains
    by each component of the rate and of 3 mu/r^3 e1 e1^T, ``driven`` (36, 9) by each of m b^T. By
    measurement, field, Sun or both at once: ``..._sensitivity`` is the constant part of H, (3 or 6, n), and
    ``..._noise`` the covariance, (3, 3) or (6, 6). ``zero`` is the error state between updates, (n).
    """

    inertia_kgm2: Mat3
    inertia_inverse: Mat3
    wheel_body_nms: Vec3
    tick_s: float
    layout: Layout
    initial_covariance: Matrix
    process_noise: Matrix
    constant: Matrix
    moving: Matrix
    driven: Matrix
    identity: Matrix
    zero: Matrix
    field_sensitivity: Matrix
    sun_sensitivity: Matrix
    both_sensitivity: Matrix
    field_noise: Matrix
    sun_noise: Matrix
    both_noise: Matrix
    dipole_sigma: float
    gate_nis: float


def layout(estimate_bias: bool, estimate_torque: bool) -> Layout:
    """The layout of the error state with the parts that are switched on."""
    bias = 6 if estimate_bias else None
    torque = (9 if estimate_bias else 6) if estimate_torque else None
    return Layout(size=6 + 3 * estimate_bias + 3 * estimate_torque, bias=bias, torque=torque)


def mekf_config(
    inertia_kgm2: Mat3,
    tick_s: float,
    *,
    wheel_body_nms: Vec3 = ZERO,
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
    dipole_sigma: float = 0.0,
    gate_nis: float,
) -> MekfConfig:
    """Prepare the filter.

    Args:
        inertia_kgm2: inertia tensor, body axes.
        tick_s: length of a tick, s.
        wheel_body_nms: constant momentum of a wheel, body axes.
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
        dipole_sigma: relative error of a driven dipole.
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
    system[3:6, 3:6] = j_inverse @ _cross(np.array(wheel_body_nms))
    variances = [attitude_sigma_rad**2] * 3 + [rate_sigma_radps**2] * 3
    field_sensitivity, sun_sensitivity = np.zeros((3, parts.size)), np.zeros((3, parts.size))
    field_variances, sun_variances = [magnetometer_sigma_t**2] * 3, [sun_sigma_rad**2] * 3
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
    moving, driven = np.split(tick_s * _varying(np.array(inertia_kgm2), j_inverse), [12], axis=1)
    return MekfConfig(
        inertia_kgm2=inertia_kgm2,
        inertia_inverse=inverse_j,
        wheel_body_nms=wheel_body_nms,
        tick_s=tick_s,
        layout=parts,
        initial_covariance=np.diag(variances),
        process_noise=noise,
        constant=np.eye(parts.size) + tick_s * system,
        moving=moving,
        driven=driven,
        identity=np.eye(parts.size),
        zero=np.zeros(parts.size),
        field_sensitivity=field_sensitivity,
        sun_sensitivity=sun_sensitivity,
        both_sensitivity=np.vstack((field_sensitivity, sun_sensitivity)),
        field_noise=np.diag(field_variances),
        sun_noise=np.diag(sun_variances),
        both_noise=np.diag(field_variances + sun_variances),
        dipole_sigma=dipole_sigma,
        gate_nis=gate_nis,
    )


def _varying(j: Matrix, j_inverse: Matrix) -> Matrix:
    """A column for each component that the upper left 6x6 of the system matrix is linear in."""
    axes = np.eye(3)
    columns = np.zeros((21, 6, 6))
    for k in range(3):
        columns[k, 0:3, 0:3] = -_cross(axes[k])
        columns[k, 3:6, 3:6] = j_inverse @ (_cross(j[k]) - _cross(axes[k]) @ j)
        for i in range(3):
            pull = _cross(axes[i]) @ j - _cross(j[i])
            columns[3 + 3 * i + k, 3:6, 0:3] = j_inverse @ pull @ _cross(axes[k])
            columns[12 + 3 * i + k, 3:6, 0:3] = j_inverse @ _cross(axes[i]) @ _cross(axes[k])
    return columns.reshape(21, 36).T.copy()


def _cross(a: Matrix) -> Matrix:
    """The matrix [a x]."""
    return np.cross(a, np.eye(3)).T
