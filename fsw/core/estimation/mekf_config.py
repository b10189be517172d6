"""The filter's tuning, and what is derived from it once."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import ceil, sqrt
from typing import Any, final

import numpy as np

from fsw.core.algebra.vector import ZERO, Mat3, Vec3, add, dot, inverse, transform
from fsw.core.estimation.cells.cell_set import CellSet
from fsw.core.estimation.dynamics.torque_maps import cross_matrix, system_maps, torque_map
from fsw.core.estimation.kalman import Algebra, Matrix, available
from fsw.core.estimation.parameters import (
    OF_CELLS,
    Layout,
    Parameters,
    Prior,
    Rotor,
    layout,
)
from fsw.core.estimation.sensitivity_map import sensitivity_map
from fsw.core.estimation.unobservable import Unobservable, unobservable

OPEN_T = 1e-3
"""Noise of an axis that shows nothing: many times the Earth's field."""


@final
@dataclass(frozen=True, slots=True)
class MekfConfig:
    """The filter's tuning and what is derived from it once.

    ``process_noise`` is the covariance added per tick, (n, n). A being the system matrix and h the tick,
    ``constant`` is the constant part of the first six rows of 1 + A h, the others being the identity's;
    ``moving`` (12, 36) is what the upper left 6x6 gains by each component of the rate and of
    3 mu/r^3 e1 e1^T, ``driven`` (9, 36) by each of m b^T.

    ``torque_map`` replaces both if the derivative by some estimated parameter varies.

    By measurement, field, Sun or both at once: ``..._sensitivity`` is the constant part of H, (3, n),
    ``..._map`` what it gains, as in ``sensitivity_map``, and ``..._noise`` the covariance, (3, 3) or (6, 6).
    ``cells``: Sun cells in place of a Sun sensor.
    ``unobservable``: what no sample shows, if anything.
    ``reaction_body_nm``: torque of a driven wheel on the body over this tick, N m.
    ``algebra``: what computes predictions and updates.
    """

    rotor: Rotor
    tick_s: float
    layout: Layout
    initial_parameters: Parameters
    initial_covariance: Matrix
    process_noise: Matrix
    constant: Matrix
    moving: Matrix
    driven: Matrix
    torque_map: tuple[Matrix, Matrix] | None
    field_sensitivity: Matrix
    sun_sensitivity: Matrix
    field_map: Matrix
    sun_map: Matrix
    field_noise: Matrix
    sun_noise: Matrix
    both_noise: Matrix
    dipole_sigma: float
    gate_nis: float
    cells: CellSet | None = None
    unobservable: Unobservable | None = None
    reaction_body_nm: Vec3 = ZERO
    algebra: Algebra = Algebra.FILTERPY


WHOLE_RAD = 0.3
"""Up to this rotation a tick is predicted in one step."""
PIECE_RAD, MOST_PIECES = 0.1, 32
"""Beyond it, in pieces of at most this rotation; the most make half a revolution, beyond which the sampled
rate is aliased."""


def pieces_of_tick(omega_radps: Vec3, tick_s: float) -> int:
    """The number of pieces in which a tick is predicted at this rate; one if the rate is not a number."""
    square = dot(omega_radps, omega_radps)
    if not square * tick_s * tick_s > WHOLE_RAD**2:
        return 1
    return ceil(min(sqrt(square) * tick_s / PIECE_RAD, MOST_PIECES))


@final
class FilterStep:
    """What the filter predicts by: a tick, or one of so many equal ``pieces`` of it.

    As in ``MekfConfig``, for a step of this length. The pieces together add the tick's noise.
    """

    __slots__ = ("constant", "driven", "moving", "pieces", "process_noise", "tick_s")

    def __init__(self, config: MekfConfig, pieces: int) -> None:
        self.pieces = pieces
        if pieces == 1:
            self.tick_s = config.tick_s
            self.process_noise = config.process_noise
            self.constant = config.constant
            self.moving = config.moving
            self.driven = config.driven
            return
        part = 1.0 / pieces
        noise = part * config.process_noise
        noise[0:3, 0:3] *= part * part
        noise[0:3, 3:6] *= part
        noise[3:6, 0:3] *= part
        identity = np.eye(6, config.layout.size)
        self.tick_s = part * config.tick_s
        self.process_noise = noise
        self.constant = identity + part * (config.constant - identity)
        self.moving = part * config.moving
        self.driven = part * config.driven


def open_noise(direction_body: Vec3) -> Matrix:
    """The noise of a magnetometer that shows nothing of the field along this direction, (3, 3)."""
    noise: Matrix = OPEN_T**2 * np.outer(direction_body, direction_body)
    return noise


def with_wheel(
    config: MekfConfig, momentum_body_nms: Vec3, reaction_body_nm: Vec3, doubted_body_nms: Vec3
) -> MekfConfig:
    """The filter of a satellite with a driven wheel, in a tick in which its momentum was measured.

    J omega and the torques are those of the whole satellite, wheel included: with the momentum h relative to
    the body, J domega/dt = T - omega x (J omega + h) - dh/dt holds exactly.

    Args:
        config: without the wheel.
        momentum_body_nms: h, its mean over the tick, without any constant momentum; body axes.
        reaction_body_nm: -dh/dt, the mean over the tick, body axes.
        doubted_body_nms: standard deviation of the change of h over the tick, along the wheel's axis.
    """
    rotor, h = config.rotor, config.tick_s
    momentum_nms = add(rotor.wheel_body_nms, momentum_body_nms)
    constant = config.constant.copy()
    constant[3:6, 3:6] += h * np.array(rotor.inertia_inverse) @ cross_matrix(np.array(momentum_body_nms))
    noise = config.process_noise.copy()
    kick = np.array(transform(rotor.inertia_inverse, doubted_body_nms))
    noise[3:6, 3:6] += np.outer(kick, kick)
    return replace(
        config,
        rotor=Rotor(rotor.inertia_kgm2, rotor.inertia_inverse, momentum_nms),
        constant=constant,
        process_noise=noise,
        reaction_body_nm=reaction_body_nm,
        unobservable=None,
    )


def mekf_config(
    inertia_kgm2: Mat3,
    tick_s: float,
    priors: Mapping[str, Prior],
    *,
    wheel_body_nms: Vec3 = ZERO,
    magnetometer_sigma_t: float,
    sun_sigma_rad: float,
    attitude_sigma_rad: float,
    rate_sigma_radps: float,
    torque_noise_nm_rts: float,
    dipole_sigma: float = 0.0,
    gate_nis: float,
    cells: CellSet | None = None,
    algebra: Algebra = Algebra.KERNEL,
) -> MekfConfig:
    """Prepare the filter.

    Args:
        inertia_kgm2: inertia tensor, body axes.
        tick_s: length of a tick, s.
        priors: by name in ``Parameters``, of those that the filter estimates.
        wheel_body_nms: constant momentum of a wheel, body axes.
        magnetometer_sigma_t: standard deviation of a field component, T.
        sun_sigma_rad: standard deviation of the Sun direction per tangential axis, rad.
        attitude_sigma_rad: initial standard deviation, as is the next.
        rate_sigma_radps: rad/s.
        torque_noise_nm_rts: white torque noise, N m sqrt(s).
        dipole_sigma: relative error of a driven dipole in a tick, independent of those in other ticks.
        gate_nis: largest normalised innovation squared that is accepted.
        cells: Sun cells, which take the place of a Sun sensor.
        algebra: what computes predictions and updates; without a kernel filterpy does.
    """
    parts = layout(set(priors))
    rotor = Rotor(inertia_kgm2, inverse(inertia_kgm2), wheel_body_nms)
    j, j_inverse = np.array(inertia_kgm2), np.array(rotor.inertia_inverse)
    rate_noise = torque_noise_nm_rts**2 * (j_inverse @ j_inverse.T)
    noise = np.zeros((parts.size, parts.size))
    noise[0:3, 0:3] = rate_noise * tick_s**3 / 3.0
    noise[0:3, 3:6] = noise[3:6, 0:3] = rate_noise * tick_s**2 / 2.0
    noise[3:6, 3:6] = rate_noise * tick_s
    variances = [attitude_sigma_rad**2] * 3 + [rate_sigma_radps**2] * 3
    for name, place in parts.carried:
        prior = priors[name]
        noise[place, place] = np.diag([walk**2 * tick_s for walk in prior.walk])
        variances += [sigma**2 for sigma in prior.sigma]
    system = np.zeros((6, parts.size))
    system[0:3, 3:6] = np.eye(3)
    system[3:6, 3:6] = j_inverse @ cross_matrix(np.array(wheel_body_nms))
    if parts.torque is not None:
        system[3:6, parts.torque] = j_inverse
    field_sensitivity, sun_sensitivity = np.zeros((3, parts.size)), np.zeros((3, parts.size))
    if parts.mag_bias is not None:
        field_sensitivity[:, parts.mag_bias] = np.eye(3)
    field_variances, sun_variances = [magnetometer_sigma_t**2] * 3, [sun_sigma_rad**2] * 3
    moving, driven = np.split(tick_s * system_maps(j, j_inverse), [12])
    return MekfConfig(
        rotor=rotor,
        tick_s=tick_s,
        layout=parts,
        initial_parameters=_means(priors, cells is not None),
        initial_covariance=np.diag(variances),
        process_noise=noise,
        constant=np.eye(6, parts.size) + tick_s * system,
        moving=moving,
        driven=driven,
        torque_map=torque_map(parts),
        field_sensitivity=field_sensitivity,
        sun_sensitivity=sun_sensitivity,
        field_map=sensitivity_map(parts, 0, parts.mag_turn, parts.mag_scale),
        sun_map=sensitivity_map(parts, 1, parts.sun_turn, None),
        field_noise=np.diag(field_variances),
        sun_noise=np.diag(sun_variances),
        both_noise=np.diag(field_variances + sun_variances),
        dipole_sigma=dipole_sigma,
        gate_nis=gate_nis,
        cells=cells,
        unobservable=unobservable(parts, variances, rotor),
        algebra=available(algebra),
    )


def _means(priors: Mapping[str, Prior], with_cells: bool) -> Parameters:
    means: dict[str, Any] = {
        name: (0.0,) * size for name, size in OF_CELLS.items() if with_cells or name in priors
    }
    for name, prior in priors.items():
        if prior.mean and name not in OF_CELLS:
            means[name] = prior.mean
    return Parameters(**means)
