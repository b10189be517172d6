"""Absolute rate, momentum and inertial attitude, for the laws of a spinning satellite."""

from typing import NamedTuple

from fsw.core.algebra.quaternion import Quaternion, multiply, rotate
from fsw.core.algebra.vector import ZERO, Vec3, add, scale, transform
from fsw.core.laws.interface import ControlConfig, LawInput


class InertialMotion(NamedTuple):
    """Rotation relative to the stars: rate, momentum, that of wheels in it, in body axes, and attitude."""

    omega_body_radps: Vec3
    momentum_body_nms: Vec3
    wheel_body_nms: Vec3
    q_body_from_eci: Quaternion


def motion(inputs: LawInput, config: ControlConfig) -> InertialMotion | None:
    """Omega = Omega_rel + w0 e3 and h = J omega + h_wheel; None without a usable attitude or an orbit."""
    attitude, reference = inputs.attitude, inputs.reference
    if not attitude.usable or reference is None:
        return None
    normal_body = rotate(attitude.q_body_from_orbit, (0.0, 0.0, 1.0))
    omega = add(attitude.omega_body_orbit_radps, scale(reference.orbit_rate_radps, normal_body))
    wheel_nms = wheel_momentum(inputs, config)
    momentum = add(transform(config.inertia_kgm2, omega), wheel_nms)
    q_body_from_eci = multiply(reference.q_orbit_from_eci, attitude.q_body_from_orbit)
    return InertialMotion(omega, momentum, wheel_nms, q_body_from_eci)


def wheel_momentum(inputs: LawInput, config: ControlConfig) -> Vec3:
    """h_wheel, body axes, N m s: of the wheel at constant speed and of the driven one."""
    driven_nms = driven_momentum(inputs, config)
    return add(config.wheel_body_nms, driven_nms) if driven_nms != ZERO else config.wheel_body_nms


def driven_momentum(inputs: LawInput, config: ControlConfig) -> Vec3:
    """That of the driven wheel alone, zero where there is none or it is not known."""
    if config.wheel is None or inputs.wheel_nms is None:
        return ZERO
    return scale(inputs.wheel_nms, config.wheel.axis_body)
