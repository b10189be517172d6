"""The error dynamics of the filter: transition over a tick, process noise, acceleration, rotation."""

import numpy as np

from fsw.core.algebra.quaternion import Quaternion
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, scale, sub, transform
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf_config import MekfConfig


def process_noise(m_body_am2: Vec3, b_body_t: Vec3, config: MekfConfig) -> Matrix:
    """The noise of a tick; while a coil is driven also that of its dipole, known to ``dipole_sigma`` only."""
    if m_body_am2 == ZERO:
        return config.process_noise
    turn = scale(config.dipole_sigma * config.tick_s, cross(m_body_am2, b_body_t))
    kick = np.array(transform(config.inertia_inverse, turn))
    noise = config.process_noise.copy()
    noise[3:6, 3:6] += np.outer(kick, kick)
    return noise


def acceleration(
    omega: Vec3, e1: Vec3, b: Vec3, gravity_per_s2: float, m: Vec3, torque: Vec3, config: MekfConfig
) -> Vec3:
    """J domega/dt = m x b + 3 mu/r^3 e1 x J e1 - omega x (J omega + h) + torque, all in body axes."""
    j = config.inertia_kgm2
    gravity = scale(gravity_per_s2, cross(e1, transform(j, e1)))
    gyroscopic = cross(omega, add(transform(j, omega), config.wheel_body_nms))
    return transform(config.inertia_inverse, sub(add(add(cross(m, b), gravity), torque), gyroscopic))


def transition_matrix(
    omega: Vec3, e1: Vec3, b: Vec3, gravity_per_s2: float, m: Vec3, config: MekfConfig
) -> Matrix:
    """I + A h + (A h)^2 / 2 of the error dynamics; with A of the middle of the tick good to second order."""
    g1, g2, g3 = scale(gravity_per_s2, e1)
    change = config.moving.dot((*omega, *scale(g1, e1), *scale(g2, e1), *scale(g3, e1)))
    if m != ZERO:
        m1, m2, m3 = m
        change += config.driven.dot((*scale(m1, b), *scale(m2, b), *scale(m3, b)))
    step = config.constant.copy()
    step[0:6, 0:6] += change.reshape(6, 6)
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
