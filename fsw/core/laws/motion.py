"""Absolute rate, momentum and inertial attitude, for the laws of a spinning satellite."""

from typing import NamedTuple

from fsw.core.algebra.quaternion import Quaternion, multiply, rotate
from fsw.core.algebra.vector import Vec3, add, scale, transform
from fsw.core.laws.interface import ControlConfig, LawInput


class InertialMotion(NamedTuple):
    """Rotation relative to the stars: rate and momentum in body axes, wheel included, and attitude."""

    omega_body_radps: Vec3
    momentum_body_nms: Vec3
    q_body_from_eci: Quaternion


def motion(inputs: LawInput, config: ControlConfig) -> InertialMotion | None:
    """Omega = Omega_rel + w0 e3 and h = J omega + h_wheel; None without a valid attitude or an orbit."""
    attitude, reference = inputs.attitude, inputs.reference
    if not attitude.valid or reference is None:
        return None
    normal_body = rotate(attitude.q_body_from_orbit, (0.0, 0.0, 1.0))
    omega = add(attitude.omega_body_orbit_radps, scale(reference.orbit_rate_radps, normal_body))
    momentum = add(transform(config.inertia_kgm2, omega), config.wheel_body_nms)
    return InertialMotion(omega, momentum, multiply(reference.q_orbit_from_eci, attitude.q_body_from_orbit))
