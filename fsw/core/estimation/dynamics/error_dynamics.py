"""The error dynamics of the filter: transition over a tick, process noise, errors of a sample's age."""

from math import radians, sqrt
from typing import Final, final

from fsw.core.algebra.vector import ZERO, Vec3, add, cross, is_zero, scale, transform
from fsw.core.estimation.dynamics.motion import BodyFields, BodyMotion, outer
from fsw.core.estimation.dynamics.torque_maps import torque_rows
from fsw.core.estimation.kalman import Matrix, Numbers, bilinear, linear, move_along, series, system_rows
from fsw.core.estimation.mekf_config import FilterStep, MekfConfig
from fsw.core.estimation.parameters import Parameters, Rotor, estimated_rotor


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
        return is_zero(self.m_body_am2) and is_zero(self.doubted_am2)


def kicks(driven: Driven, b_body_t: Vec3, config: MekfConfig, step: FilterStep) -> Numbers:
    """Standard deviations of what a driven dipole adds to the rate in a step, rad/s, body axes.

    The dipole is known only to ``dipole_sigma``, and as far as it is not doubted. Its error is constant over
    a tick, of which the step may be a piece, and independent of those of the other ticks. Before them, that
    of a driven wheel.
    """
    if driven.nothing:
        return () if is_zero(step.wheel_kick_radps) else (step.wheel_kick_radps,)
    h, inverse = step.tick_s * sqrt(step.pieces), config.rotor.inertia_inverse
    by_all = scale(h, cross(scale(config.dipole_sigma, driven.m_body_am2), b_body_t))
    by_doubt = scale(h, cross(driven.doubted_am2, b_body_t))
    return (step.wheel_kick_radps, transform(inverse, by_all), transform(inverse, by_doubt))


NOT_DRIVEN = Driven(ZERO)


FAST_RADPS: Final = radians(0.5)
"""Above it a turn is fast: products of the errors of rate, inertia and age matter."""
SLOW_RADPS: Final = radians(0.3)
"""Below it a fast turn has ended."""
KNOWN_RADPS: Final = 0.05 * FAST_RADPS
"""The rate of a fast turn is known when its standard deviation is below this."""
FAST_SQUARE: Final = FAST_RADPS**2
SLOW_SQUARE: Final = SLOW_RADPS**2
KNOWN_VARIANCE: Final = KNOWN_RADPS**2


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
    h = step.tick_s
    if config.torque_map is not None:
        (j11, j12, j13), (j21, j22, j23), (j31, j32, j33) = rotor.inertia_inverse
        inverse_h = (h * j11, h * j12, h * j13, h * j21, h * j22, h * j23, h * j31, h * j32, h * j33)
        torque = torque_rows(motion, around, m_driven, rotor, config.torque_map)
        rows = system_rows(step.constant, scale(-h, motion.omega), inverse_h, torque)
    elif is_zero(motion.m_am2):
        rows = linear(step.constant, (motion.omega, around.pull()), step.moving)
    else:
        turning, acting = (motion.omega, around.pull()), outer(motion.m_am2, around.b_t)
        rows = bilinear(step.constant, turning, step.moving, acting, step.driven)
    return series(rows, 2 if step.pieces == 1 else 4)


def free_acceleration(omega: Vec3, parameters: Parameters, nominal: Rotor) -> Vec3:
    """The derivative of the rate of a torque-free body."""
    rotor = estimated_rotor(nominal, parameters)
    gyroscopic = cross(add(transform(rotor.inertia_kgm2, omega), rotor.wheel_body_nms), omega)
    return transform(rotor.inertia_inverse, gyroscopic)


def with_age_along(change: Numbers, covariance: Matrix, delay: slice) -> Matrix:
    """The covariance of the error state, (n, n), where a correction has changed how a free body moves.

    Samples that are all older by dtau, of a satellite that is ahead by dtau on its motion, look the same: no
    sample shows this error. Were it left along the motion as estimated before, samples would seem to show it,
    and the filter would be surer of age and attitude than it may be (Huang, Mourikis, Roumeliotis 2010,
    Observability-based rules for designing consistent EKF SLAM estimators).

    Args:
        change: of the rate and of its derivative without torque, (6).
        covariance: before.
        delay: place of the two ages in the error state.
    """
    return move_along(covariance, change, delay.start)
