"""The error dynamics of the filter: transition over a tick, process noise, acceleration, rotation."""

from typing import NamedTuple

import numpy as np

from fsw.core.algebra.quaternion import Quaternion
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, scale, skew, sub, transform
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import Rotor
from fsw.core.estimation.torque_maps import TorqueMaps

_IDENTITY = np.eye(6)


def process_noise(m_body_am2: Vec3, b_body_t: Vec3, config: MekfConfig) -> Matrix:
    """The noise of a tick; while a coil is driven also that of its dipole, known to ``dipole_sigma`` only."""
    if m_body_am2 == ZERO:
        return config.process_noise
    turn = scale(config.dipole_sigma * config.tick_s, cross(m_body_am2, b_body_t))
    kick = np.array(transform(config.rotor.inertia_inverse, turn))
    noise = config.process_noise.copy()
    noise[3:6, 3:6] += np.outer(kick, kick)
    return noise


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


class BodyMotion(NamedTuple):
    """How the satellite turns: rate, rad/s, its derivative, rad/s^2, and the dipole that acts, A m^2."""

    omega: Vec3
    alpha: Vec3
    m_am2: Vec3


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
