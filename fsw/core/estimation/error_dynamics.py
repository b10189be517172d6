"""The error dynamics of the filter: transition over a tick, process noise, acceleration, rotation."""

from typing import NamedTuple

import numpy as np

from fsw.core.algebra.quaternion import Quaternion
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, scale, sub, transform
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import Rotor


def process_noise(m_body_am2: Vec3, b_body_t: Vec3, config: MekfConfig) -> Matrix:
    """The noise of a tick; while a coil is driven also that of its dipole, known to ``dipole_sigma`` only."""
    if m_body_am2 == ZERO:
        return config.process_noise
    turn = scale(config.dipole_sigma * config.tick_s, cross(m_body_am2, b_body_t))
    kick = np.array(transform(config.rotor.inertia_inverse, turn))
    noise = config.process_noise.copy()
    noise[3:6, 3:6] += np.outer(kick, kick)
    return noise


class Surroundings(NamedTuple):
    """What acts at one attitude, body axes: the radius direction e1, the field b, T, and 3 mu/r^3, 1/s^2."""

    e1: Vec3
    b_t: Vec3
    gravity_per_s2: float


def acceleration(omega: Vec3, around: Surroundings, m: Vec3, torque: Vec3, rotor: Rotor) -> Vec3:
    """J domega/dt = m x b + 3 mu/r^3 e1 x J e1 - omega x (J omega + h) + torque, all in body axes."""
    j, j_inverse, wheel = rotor
    gravity = scale(around.gravity_per_s2, cross(around.e1, transform(j, around.e1)))
    gyroscopic = cross(omega, add(transform(j, omega), wheel))
    return transform(j_inverse, sub(add(add(cross(m, around.b_t), gravity), torque), gyroscopic))


def transition_matrix(
    omega: Vec3, alpha: Vec3, around: Surroundings, m_driven: Vec3, config: MekfConfig
) -> Matrix:
    """I + A h + (A h)^2 / 2 of the error dynamics; with A of the middle of the tick good to second order.

    Args:
        omega: rate, rad/s.
        alpha: its derivative, rad/s^2.
        around: radius direction and field.
        m_driven: dipole that the coils are driven to, A m^2.
        config: the filter.
    """
    e1, b, parts = around.e1, around.b_t, config.layout
    g1, g2, g3 = scale(around.gravity_per_s2, e1)
    pull = (*scale(g1, e1), *scale(g2, e1), *scale(g3, e1))
    change = config.moving.dot((*omega, *pull))
    step = config.constant.copy()
    if m_driven != ZERO:
        m1, m2, m3 = m_driven
        drive = (*scale(m1, b), *scale(m2, b), *scale(m3, b))
        change += config.driven.dot(drive)
        if parts.coils is not None:
            step[3:6, parts.coils] = config.by_coils.dot(drive).reshape(3, 9)
    step[0:6, 0:6] += change.reshape(6, 6)
    if parts.dipole is not None:
        step[3:6, parts.dipole] = config.by_dipole.dot(b).reshape(3, 3)
    if parts.inertia is not None:
        w1, w2, w3 = omega
        spin = (*scale(w1, omega), *scale(w2, omega), *scale(w3, omega))
        step[3:6, parts.inertia] = config.by_inertia.dot((*pull, *spin, *alpha)).reshape(3, 6)
    transition: Matrix = step.dot(step)  # (1 + A h)^2, so that half of it and 1 is the series
    transition += config.identity
    transition *= 0.5
    return transition


def turn(rotation_rad: Vec3) -> Quaternion:
    """The quaternion of a rotation vector by the series of sine and cosine: 1e-9 rad off at 0.5 rad."""
    r1, r2, r3 = rotation_rad
    square = 0.25 * (r1 * r1 + r2 * r2 + r3 * r3)
    half_sinc = 0.5 - square * (1.0 / 12.0 - square / 240.0)
    cosine = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square / 720.0))
    return (cosine, half_sinc * r1, half_sinc * r2, half_sinc * r3)
