"""The error dynamics of the filter: transition over a tick, process noise, errors of a sample's age."""

from math import radians, sqrt
from typing import final

import numpy as np

from fsw.core.algebra.vector import ZERO, Vec3, add, cross, scale, skew, transform
from fsw.core.estimation.dynamics.motion import BodyFields, BodyMotion, outer
from fsw.core.estimation.dynamics.torque_maps import torque_rows
from fsw.core.estimation.kalman import Matrix, combine, product
from fsw.core.estimation.mekf_config import FilterStep, MekfConfig
from fsw.core.estimation.parameters import Parameters, Rotor, estimated_rotor

_IDENTITY = np.eye(6)


@final
class Driven:
    """The dipole that the coils drove over a tick, and the standard deviation of its error.

    Both in body axes, A m^2; the error of a coil is along its axis.
    """

    __slots__ = ("doubted_am2", "m_body_am2")

    def __init__(self, m_body_am2: Vec3, doubted_am2: Vec3 = ZERO) -> None:
        self.m_body_am2 = m_body_am2
        self.doubted_am2 = doubted_am2

    @property
    def nothing(self) -> bool:
        """Whether it is certain that no coil was driven."""
        return self.m_body_am2 == ZERO and self.doubted_am2 == ZERO


def process_noise(driven: Driven, b_body_t: Vec3, config: MekfConfig, step: FilterStep) -> Matrix:
    """The noise of a step; while a coil is driven also that of its dipole, known only to ``dipole_sigma``.

    Its error is constant over a tick, of which the step may be a piece, and independent of those of the other
    ticks.
    """
    if driven.nothing:
        return step.process_noise
    noise = step.process_noise.copy()
    for sigma_am2 in (scale(config.dipole_sigma, driven.m_body_am2), driven.doubted_am2):
        turn = scale(step.tick_s * sqrt(step.pieces), cross(sigma_am2, b_body_t))
        kick = np.array(transform(config.rotor.inertia_inverse, turn))
        noise[3:6, 3:6] += np.outer(kick, kick)
    return noise


NOT_DRIVEN = Driven(ZERO)


FAST_RADPS, SLOW_RADPS = radians(0.5), radians(0.3)
"""Above the first a turn is fast: products of the errors of rate, inertia and age matter. Below the second it
has ended."""
KNOWN_RADPS = 0.05 * FAST_RADPS
"""The rate of a fast turn is known when its standard deviation is below this."""


def transition_matrix(
    motion: BodyMotion, around: BodyFields, m_driven: Vec3, rotor: Rotor, config: MekfConfig, step: FilterStep
) -> Matrix:
    """The rows of attitude and rate of I + A h + (A h)^2 / 2, A being the system matrix, (6, n).

    Accurate to second order with A from the middle of the tick; all other rows are those of the identity. For
    a piece of a tick two more terms are taken, since a fast turn carries errors around for long.

    Args:
        motion: in the middle of the tick.
        around: radius direction and field there.
        m_driven: dipole that the coils are driven to, A m^2.
        rotor: inertia as estimated.
        config: the filter.
        step: the tick, or a piece of it.
    """
    linear = step.constant.copy()
    moving = linear[:, 0:6]
    if config.torque_map is None:
        change = combine((*motion.omega, *around.pull()), step.moving)
        if motion.m_am2 != ZERO:
            change += combine(outer(motion.m_am2, around.b_t), step.driven)
        moving += change.reshape(6, 6)
    else:
        moving[0:3, 0:3] = skew(scale(-step.tick_s, motion.omega))
        inverse_h = step.tick_s * np.array(rotor.inertia_inverse)
        by_error = torque_rows(motion, around, m_driven, rotor, config.torque_map)
        linear[3:6, : by_error.shape[1]] = product(inverse_h, by_error)
        moving += _IDENTITY
    if step.pieces > 1:
        return _to_fourth_order(linear)
    transition = product(moving, linear)  # (1 + A h)^2: the mean of it and 1 is the series
    moving[:] = _IDENTITY
    transition += linear
    transition *= 0.5
    return transition


def _to_fourth_order(step: Matrix) -> Matrix:
    """The rows of exp(A h), by its series, from those of I + A h."""
    change = step.copy()
    change[:, 0:6] -= _IDENTITY
    total = change
    for order in (4.0, 3.0, 2.0):
        total = change + product(change[:, 0:6], total) / order
    total[:, 0:6] += _IDENTITY
    return total


def free_motion(omega: Vec3, parameters: Parameters, nominal: Rotor) -> Matrix:
    """How attitude and rate of a torque-free body evolve: omega, and its derivative; (6)."""
    rotor = estimated_rotor(nominal, parameters)
    gyroscopic = cross(add(transform(rotor.inertia_kgm2, omega), rotor.wheel_body_nms), omega)
    return np.array((*omega, *transform(rotor.inertia_inverse, gyroscopic)))


def with_age_along(change: Matrix, covariance: Matrix, delay: slice) -> Matrix:
    """The covariance of the error state, (n, n), where a correction has changed the ``free_motion``.

    Samples that are all older by dtau, of a satellite that is ahead by dtau on its motion, look the same: no
    sample shows this error. Were it left along the motion as estimated before, samples would seem to show it,
    and the filter would be surer of age and attitude than it may be (Huang, Mourikis, Roumeliotis 2010,
    Observability-based rules for designing consistent EKF SLAM estimators).

    Args:
        change: of the free motion, (6).
        covariance: before.
        delay: place of the two ages in the error state.
    """
    age = 0.5 * (covariance[delay.start] + covariance[delay.start + 1])
    variance = 0.5 * (age[delay.start] + age[delay.start + 1])
    added = np.outer(change, age)
    block = added[:, 0:6] + 0.5 * variance * np.outer(change, change)
    turned = covariance.copy()
    turned[0:6, 0:6] += block + block.T
    turned[0:6, 6:] += added[:, 6:]
    turned[6:, 0:6] += added[:, 6:].T
    return turned
