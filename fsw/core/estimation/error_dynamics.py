"""The error dynamics of the filter: transition over a tick, process noise, acceleration, rotation."""

from math import radians
from typing import NamedTuple

import numpy as np

from fsw.core.algebra.quaternion import Quaternion, from_small_rotation, multiply, rotate
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, dot, scale, skew, sub, transform
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import Parameters, Rotor, estimated_rotor
from fsw.core.estimation.torque_maps import TorqueMaps

_IDENTITY = np.eye(6)


class Driven(NamedTuple):
    """The dipole that the coils drove over a tick, and the standard deviation of what it is in doubt by.

    Both in body axes, A m^2; a coil that is in doubt is so along its axis.
    """

    m_body_am2: Vec3
    doubted_am2: Vec3 = ZERO


def process_noise(driven: Driven, b_body_t: Vec3, config: MekfConfig) -> Matrix:
    """The noise of a tick; while a coil is driven also that of its dipole, known to ``dipole_sigma`` only."""
    if driven == NOT_DRIVEN:
        return config.process_noise
    noise = config.process_noise.copy()
    for sigma_am2 in (scale(config.dipole_sigma, driven.m_body_am2), driven.doubted_am2):
        turn = scale(config.tick_s, cross(sigma_am2, b_body_t))
        kick = np.array(transform(config.rotor.inertia_inverse, turn))
        noise[3:6, 3:6] += np.outer(kick, kick)
    return noise


NOT_DRIVEN = Driven(ZERO)


FAST_RADPS, SLOW_RADPS = radians(0.5), radians(0.3)
"""Above the first a turn is fast: products of the errors of rate, inertia and age count. Below the second it
has ended."""
KNOWN_RADPS = 0.05 * FAST_RADPS
"""The rate of a fast turn is known when its standard deviation is below this."""
MIDPOINT_RAD = 0.03
"""Up to this turn in a tick the motion in its middle carries the satellite: to 2e-6 rad, 3e-8 rad a tick."""


class BodyFields(NamedTuple):
    """What acts at one attitude, body axes: the radius direction e1, the field b, T, and 3 mu/r^3, 1/s^2."""

    e1: Vec3
    b_t: Vec3
    gravity_per_s2: float

    def pull(self) -> tuple[float, ...]:
        """The dyad 3 mu/r^3 e1 e1^T by rows, 1/s^2."""
        return _outer(scale(self.gravity_per_s2, self.e1), self.e1)


def acceleration(omega: Vec3, around: BodyFields, m: Vec3, torque: Vec3, rotor: Rotor) -> Vec3:
    """J domega/dt = m x b + 3 mu/r^3 e1 x J e1 - omega x (J omega + h) + torque, all in body axes."""
    j, j_inverse, wheel = rotor
    gravity = scale(around.gravity_per_s2, cross(around.e1, transform(j, around.e1)))
    gyroscopic = cross(omega, add(transform(j, omega), wheel))
    return transform(j_inverse, sub(add(add(cross(m, around.b_t), gravity), torque), gyroscopic))


class Acting(NamedTuple):
    """What acts on the satellite over a tick, and its inertia.

    Radius direction and field, T, inertial axes; 3 mu/r^3, 1/s^2; dipole, A m^2, and torque, N m, body axes.
    """

    e1_eci: Vec3
    b_eci_t: Vec3
    gravity_per_s2: float
    m_am2: Vec3
    torque_nm: Vec3
    rotor: Rotor

    def around(self, q_body_from_eci: Quaternion) -> BodyFields:
        """Radius direction and field at an attitude."""
        e1, b = rotate(q_body_from_eci, self.e1_eci), rotate(q_body_from_eci, self.b_eci_t)
        return BodyFields(e1, b, self.gravity_per_s2)

    def acceleration(self, omega: Vec3, around: BodyFields) -> Vec3:
        """The derivative of the rate, body axes, rad/s^2."""
        return acceleration(omega, around, self.m_am2, self.torque_nm, self.rotor)


class BodyMotion(NamedTuple):
    """How the satellite turns: rate, rad/s, its derivative, rad/s^2, and the dipole that acts, A m^2."""

    omega: Vec3
    alpha: Vec3
    m_am2: Vec3


def middle(q: Quaternion, omega: Vec3, acting: Acting, h: float) -> tuple[BodyFields, BodyMotion]:
    """What acts in the middle of a tick of length h, and how the satellite turns there."""
    omega_mid = add(omega, scale(0.5 * h, acting.acceleration(omega, acting.around(q))))
    around = acting.around(multiply(q, from_small_rotation(scale(0.5 * h, omega))))
    return around, BodyMotion(omega_mid, acting.acceleration(omega_mid, around), acting.m_am2)


def advanced(q: Quaternion, omega: Vec3, motion: BodyMotion, acting: Acting, h: float) -> tuple[Vec3, Vec3]:
    """The rotation over a tick of length h, rad, and the rate after it, by ``motion`` in its middle.

    In a fast turn to the fourth order of h: the rate by Runge and Kutta's method, the rotation by Simpson's
    rule, with what the turn of the axis adds (Magnus 1954).
    """
    rotation = scale(h, motion.omega)
    if dot(rotation, rotation) < MIDPOINT_RAD**2:
        return rotation, add(omega, scale(h, motion.alpha))
    q_mid = multiply(q, from_small_rotation(scale(0.5 * h, omega)))
    around_mid = acting.around(q_mid)
    k1, k2 = acting.acceleration(omega, acting.around(q)), motion.alpha
    k3 = acting.acceleration(add(omega, scale(0.5 * h, k2)), around_mid)
    k4 = acting.acceleration(add(omega, scale(h, k3)), acting.around(multiply(q, turn(rotation))))
    after = add(omega, scale(h / 6.0, add(add(k1, k4), scale(2.0, add(k2, k3)))))
    halfway = add(scale(0.5, add(omega, after)), scale(h / 8.0, sub(k1, k4)))
    mean = scale(1.0 / 6.0, add(add(omega, after), scale(4.0, halfway)))
    return add(scale(h, mean), scale(h * h / 12.0, cross(omega, after))), after


def transition_matrix(
    motion: BodyMotion, around: BodyFields, m_driven: Vec3, rotor: Rotor, config: MekfConfig
) -> Matrix:
    """The rows of attitude and rate of I + A h + (A h)^2 / 2, A being the system matrix, (6, n).

    With A of the middle of the tick good to second order; all other rows are those of the identity.

    Args:
        motion: in the middle of the tick.
        around: radius direction and field there.
        m_driven: dipole that the coils are driven to, A m^2.
        rotor: inertia as estimated.
        config: the filter.
    """
    step = config.constant.copy()
    moving = step[:, 0:6]
    if config.layout.inertia is None:
        change = config.moving.dot((*motion.omega, *around.pull()))
        if motion.m_am2 != ZERO:
            change += config.driven.dot(_outer(motion.m_am2, around.b_t))
        moving += change.reshape(6, 6)
        inverse_h = config.inverse_h
    else:
        inverse_h = config.tick_s * np.array(rotor.inertia_inverse)
        moving[0:3, 0:3] = skew(scale(-config.tick_s, motion.omega))
        moving[3:6] = inverse_h.dot(_torque_rows(motion, around, rotor, config.torques))
        moving += _IDENTITY
    _set_parameter_columns(step, inverse_h, motion, around, m_driven, config)
    transition: Matrix = moving.dot(step)  # (1 + A h)^2, so that half of it and 1 is the series
    moving[:] = _IDENTITY
    transition += step
    transition *= 0.5
    return transition


def _torque_rows(motion: BodyMotion, around: BodyFields, rotor: Rotor, maps: TorqueMaps) -> Matrix:
    """The torque's derivative by attitude and rate, (3, 6)."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = rotor.inertia_kgm2
    moving = maps.moving.dot((xx, yy, zz, xy, xz, yz)).reshape(18, 12)
    entries = moving.dot((*motion.omega, *around.pull())) + maps.driven.dot(_outer(motion.m_am2, around.b_t))
    rows: Matrix = entries.reshape(3, 6)
    if rotor.wheel_body_nms != ZERO:
        rows[:, 3:6] += skew(rotor.wheel_body_nms)
    return rows


def _set_parameter_columns(
    step: Matrix,
    inverse_h: Matrix,
    motion: BodyMotion,
    around: BodyFields,
    m_driven: Vec3,
    config: MekfConfig,
) -> None:
    """Set what the parameters do to the rate: J^-1 h times the torque's derivative by each."""
    parts, maps = config.layout, config.torques
    if parts.dipole is not None:
        step[3:6, parts.dipole] = inverse_h.dot(maps.dipole.dot(around.b_t).reshape(3, 3))
    if parts.coils is not None and m_driven != ZERO:
        drive = _outer(m_driven, around.b_t)
        step[3:6, parts.coils] = inverse_h.dot(maps.coils.dot(drive).reshape(3, 9))
    if parts.inertia is not None:
        if parts.torque is not None:
            step[3:6, parts.torque] = inverse_h
        moves = (*around.pull(), *_outer(motion.omega, motion.omega), *motion.alpha)
        step[3:6, parts.inertia] = inverse_h.dot(maps.inertia.dot(moves).reshape(3, 6))


def _outer(a: Vec3, b: Vec3) -> tuple[float, ...]:
    """The dyad a b^T by rows."""
    a1, a2, a3 = a
    b1, b2, b3 = b
    return (a1 * b1, a1 * b2, a1 * b3, a2 * b1, a2 * b2, a2 * b3, a3 * b1, a3 * b2, a3 * b3)


def turn(rotation_rad: Vec3) -> Quaternion:
    """The quaternion of a rotation vector by the series of sine and cosine: 2e-8 rad off at 0.5 rad."""
    r1, r2, r3 = rotation_rad
    square = 0.25 * (r1 * r1 + r2 * r2 + r3 * r3)
    half_sinc = 0.5 - square * (1.0 / 12.0 - square / 240.0)
    cosine = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square / 720.0))
    return (cosine, half_sinc * r1, half_sinc * r2, half_sinc * r3)


def free_motion(omega: Vec3, parameters: Parameters, nominal: Rotor) -> Matrix:
    """How attitude and rate of a body without torque go on: omega, and its derivative; (6)."""
    rotor = estimated_rotor(nominal, parameters)
    gyroscopic = cross(add(transform(rotor.inertia_kgm2, omega), rotor.wheel_body_nms), omega)
    return np.array((*omega, *transform(rotor.inertia_inverse, gyroscopic)))


def with_age_along(change: Matrix, covariance: Matrix, delay: slice) -> Matrix:
    """The covariance of the error state, (n, n), where a correction has changed the ``free_motion``.

    Samples that are older by the same dtau look like a satellite that is ahead by dtau on its motion: no
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
