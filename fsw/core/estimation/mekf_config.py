"""The filter's tuning, and what is derived from it once."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil, sqrt
from typing import Any, final

import numpy as np

from fsw.core.algebra.vector import ZERO, Mat3, Vec3, dot, inverse, product, scale, skew, transform
from fsw.core.estimation.cells.cell_set import CellSet
from fsw.core.estimation.dynamics.torque_maps import cross_matrix, system_maps, torque_map
from fsw.core.estimation.kalman import Algebra, Matrix, available, linear
from fsw.core.estimation.parameters import (
    OF_CELLS,
    Layout,
    Parameters,
    Prior,
    Rotor,
    layout,
    with_momentum,
)
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

    By measurement, field, Sun or both at once: ``..._sensitivity`` is the constant part of H, (3, n) or
    (6, n), ``..._places`` those of each sensor's age, misalignment and scale errors in the error state (-1:
    it has none), and ``..._noise`` the covariance, (3, 3) or (6, 6).
    ``cells``: Sun cells in place of a Sun sensor.
    ``unobservable``: what no sample shows, if anything.
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
    both_sensitivity: Matrix
    field_places: tuple[int, int, int]
    sun_places: tuple[int, int, int]
    both_places: tuple[int, int, int, int, int, int]
    field_noise: Matrix
    sun_noise: Matrix
    both_noise: Matrix
    dipole_sigma: float
    gate_nis: float
    cells: CellSet | None = None
    unobservable: Unobservable | None = None
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
class WheelMotion:
    """How a driven wheel moves over the ticks that end now, by its measured momentum; body axes.

    J omega and the torques are those of the whole satellite, wheel included: with the momentum h relative to
    the body, J domega/dt = T - omega x (J omega + h) - dh/dt holds exactly.

    Attributes:
        momentum_nms: h, its mean over a tick, without any constant momentum.
        reaction_nm: -dh/dt, the mean over a tick.
        doubted_nms: standard deviation of the change of h over a tick, along the wheel's axis.
    """

    __slots__ = ("doubted_nms", "momentum_nms", "reaction_nm")

    def __init__(self, momentum_nms: Vec3, reaction_nm: Vec3 = ZERO, doubted_nms: Vec3 = ZERO) -> None:
        self.momentum_nms = momentum_nms
        self.reaction_nm = reaction_nm
        self.doubted_nms = doubted_nms


@final
class FilterStep:
    """What the filter predicts by: a tick, or one of so many equal ``pieces`` of it.

    As in ``MekfConfig``, for a step of this length. The pieces together add the tick's noise. With a driven
    wheel, its torque on the body, and the standard deviation of what its change adds to the rate, rad/s.
    """

    __slots__ = (
        *("constant", "driven", "moving", "pieces", "process_noise", "tick_s"),
        *("reaction_body_nm", "rotor", "wheel_kick_radps"),
    )

    def __init__(self, config: MekfConfig, pieces: int, wheel: WheelMotion | None = None) -> None:
        self.pieces = pieces
        self.tick_s = config.tick_s
        self.process_noise = config.process_noise
        self.constant = config.constant
        self.moving = config.moving
        self.driven = config.driven
        self.rotor = config.rotor
        self.reaction_body_nm = ZERO
        self.wheel_kick_radps = ZERO
        if wheel is not None:
            self.rotor = with_momentum(config.rotor, wheel.momentum_nms)
            self.reaction_body_nm = wheel.reaction_nm
            kick_radps = transform(config.rotor.inertia_inverse, wheel.doubted_nms)
            self.wheel_kick_radps = scale(sqrt(1.0 / pieces), kick_radps)
            self.constant = _with_gyroscopic(config, wheel.momentum_nms)
        if pieces == 1:
            return
        part = 1.0 / pieces
        noise = part * config.process_noise
        noise[0:3, 0:3] *= part * part
        noise[0:3, 3:6] *= part
        noise[3:6, 0:3] *= part
        identity = np.eye(6, config.layout.size)
        self.tick_s = part * config.tick_s
        self.process_noise = noise
        self.constant = identity + part * (self.constant - identity)
        self.moving = part * config.moving
        self.driven = part * config.driven


def _with_gyroscopic(config: MekfConfig, momentum_body_nms: Vec3) -> Matrix:
    """The constant part of 1 + A h with h J^-1 [momentum x], of the rate by the rate."""
    h, (row_1, row_2, row_3) = config.tick_s, config.rotor.inertia_inverse
    r1, r2, r3 = product((scale(h, row_1), scale(h, row_2), scale(h, row_3)), skew(momentum_body_nms))
    return linear(config.constant, (r1, r2, r3), _BY_RATE)


_BY_RATE: Matrix = np.pad(np.eye(9).reshape(9, 3, 3), ((0, 0), (3, 0), (3, 0))).reshape(9, 36)
"""From the derivative of the rate by the rate, by rows, (9), to the upper left 6x6 of the system matrix."""


def open_noise(direction_body: Vec3) -> Matrix:
    """The noise of a magnetometer that shows nothing of the field along this direction, (3, 3)."""
    noise: Matrix = OPEN_T**2 * np.outer(direction_body, direction_body)
    return noise


def mekf_config(
    inertia_kgm2: Mat3,
    tick_s: float,
    priors: Mapping[str, Prior],
    *,
    wheel_body_nms: Vec3 = ZERO,
    driven_wheel: bool = False,
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
        driven_wheel: whether there is one whose momentum is measured.
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
    of_field, of_sun = _sensor_places(parts, 0, parts.mag_turn), _sensor_places(parts, 1, parts.sun_turn)
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
        both_sensitivity=np.concatenate((field_sensitivity, sun_sensitivity)),
        field_places=of_field,
        sun_places=of_sun,
        both_places=of_field + of_sun,
        field_noise=np.diag(field_variances),
        sun_noise=np.diag(sun_variances),
        both_noise=np.diag(field_variances + sun_variances),
        dipole_sigma=dipole_sigma,
        gate_nis=gate_nis,
        cells=cells,
        unobservable=None if driven_wheel else unobservable(parts, variances, rotor),
        algebra=available(algebra),
    )


def _sensor_places(parts: Layout, sensor: int, turn: slice | None) -> tuple[int, int, int]:
    """Where age, misalignment and scale errors of a sensor stand in the error state; -1: not there."""
    scale = parts.mag_scale if sensor == 0 else None
    return (
        -1 if parts.delay is None else parts.delay.start + sensor,
        -1 if turn is None else turn.start,
        -1 if scale is None else scale.start,
    )


def _means(priors: Mapping[str, Prior], with_cells: bool) -> Parameters:
    means: dict[str, Any] = {
        name: (0.0,) * size for name, size in OF_CELLS.items() if with_cells or name in priors
    }
    for name, prior in priors.items():
        if prior.mean:
            means[name] = prior.mean
    return Parameters(**means)
