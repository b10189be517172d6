"""Torques on the body, in body axes."""

from collections.abc import Callable
from typing import final

from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import ZERO, Mat3, Quaternion, Vec3, cross, matrix, transform

SOURCES = ("gravity_gradient", "coils", "residual_dipole", "bias")
"""The torques on every body, in the order of ``TruthRow``; those of ``disturbances`` follow."""


def gravity_gradient(inertia_kgm2: Mat3, e_body: Vec3, gradient_ps2: float) -> Vec3:
    """T = 3 mu / r^3 e x J e [N m], e the unit vector of the radius."""
    x, y, z = cross(e_body, transform(inertia_kgm2, e_body))
    return (gradient_ps2 * x, gradient_ps2 * y, gradient_ps2 * z)


def magnetic(m_body_am2: Vec3, b_body_t: Vec3) -> Vec3:
    """T = m x b [N m]."""
    return cross(m_body_am2, b_body_t)


def eddy(k_nms_per_t2: float, omega_body_radps: Vec3, b_body_t: Vec3) -> Vec3:
    """T = k (omega x b) x b [N m] of the currents that the field induces in a rotating conductor.

    It damps omega across the field, and not along it (Wertz 1978, section 17.2). The slow rotation of the
    field along the orbit is neglected.

    Args:
        k_nms_per_t2: k, from the conductor's shape and conductivity; 2/3 pi r^4 sigma d for a thin sphere.
        omega_body_radps: inertial rate.
        b_body_t: field.
    """
    x, y, z = cross(cross(omega_body_radps, b_body_t), b_body_t)
    return (k_nms_per_t2 * x, k_nms_per_t2 * y, k_nms_per_t2 * z)


class Torque:
    """A torque on the body over an integration step."""

    def at(self, q_body_from_eci: Quaternion, omega_body_radps: Vec3, around: Surroundings) -> Vec3:
        """The torque, body axes [N m].

        Args:
            q_body_from_eci: attitude; its norm may differ from 1 by the error of an integration step.
            omega_body_radps: inertial rate, body axes.
            around: surroundings.
        """
        raise NotImplementedError


@final
class TorqueFunction(Torque):
    """A torque by a function of the same arguments."""

    def __init__(self, function: Callable[[Quaternion, Vec3, Surroundings], Vec3]) -> None:
        self._function = function

    def at(self, q_body_from_eci: Quaternion, omega_body_radps: Vec3, around: Surroundings) -> Vec3:
        """What the function gives."""
        return self._function(q_body_from_eci, omega_body_radps, around)


class Effect:
    """A torque that follows from attitude, rate and surroundings."""

    def at(self, body_from_eci: Mat3, omega_body_radps: Vec3, around: Surroundings) -> Vec3:
        """The torque, body axes [N m]."""
        raise NotImplementedError


@final
class BodyTorque(Torque):
    """T = 3 mu / r^3 e x J e + m x b + bias + effects [N m].

    Args:
        inertia_kgm2: inertia tensor J.
        m_body_am2: dipole of coils and residual together.
        bias_body_nm: constant torque.
        effects: further torques.
    """

    def __init__(
        self,
        inertia_kgm2: Mat3,
        m_body_am2: Vec3,
        bias_body_nm: Vec3 = ZERO,
        effects: tuple[Effect, ...] = (),
    ) -> None:
        self._inertia = inertia_kgm2
        self._dipole = m_body_am2
        self._bias = bias_body_nm
        self._effects = effects

    def at(self, q_body_from_eci: Quaternion, omega_body_radps: Vec3, around: Surroundings) -> Vec3:
        """Their sum: the integration's inner loop, written out."""
        c, gradient = matrix(q_body_from_eci), around.gradient_ps2
        e_body = transform(c, around.e_eci)
        ex, ey, ez = e_body
        bx, by, bz = transform(c, around.b_eci_t)
        mx, my, mz = self._dipole
        dx, dy, dz = self._bias
        fx, fy, fz = transform(self._inertia, e_body)
        x = gradient * (ey * fz - ez * fy) + my * bz - mz * by + dx
        y = gradient * (ez * fx - ex * fz) + mz * bx - mx * bz + dy
        z = gradient * (ex * fy - ey * fx) + mx * by - my * bx + dz
        for effect in self._effects:
            dx, dy, dz = effect.at(c, omega_body_radps, around)
            x, y, z = x + dx, y + dy, z + dz
        return (x, y, z)
