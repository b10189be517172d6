"""The rigid body: attitude and rate integrated by the classic Runge-Kutta method, on plain floats."""

from collections.abc import Callable, Sequence
from math import isfinite
from typing import NamedTuple

from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import ZERO, Mat3, Quaternion, Vec3, cross, normalise, transform

Torque = Callable[[Quaternion, Vec3, Surroundings], Vec3]
"""Torque in body axes [N m], from q_body_from_eci, the inertial rate in body axes and the surroundings."""


class Motion(NamedTuple):
    """Rotational state."""

    q_body_from_eci: Quaternion
    omega_body_radps: Vec3
    """Inertial rate, body axes."""

    def sound(self, step_s: float) -> bool:
        """Whether attitude and rate are finite, and a step of ``step_s`` turns it by less than a radian."""
        (q0, q1, q2, q3), (x, y, z) = self
        return isfinite(q0 + q1 + q2 + q3) and (x * x + y * y + z * z) * step_s * step_s < 1.0


class RigidBody:
    """dq/dt = 1/2 q (x) (0, w), J dw/dt = T - w x (J w + h).

    Args:
        inertia_kgm2: inertia tensor about the mass centre, body axes, regular.
        wheel_body_nms: constant angular momentum h of wheels relative to the body, body axes.
    """

    def __init__(self, inertia_kgm2: Mat3, wheel_body_nms: Vec3 = ZERO) -> None:
        self._inertia = inertia_kgm2
        self._wheel = wheel_body_nms
        self._inverse = _inverse(inertia_kgm2)

    def step(
        self,
        motion: Motion,
        torque: Torque,
        around: Sequence[Surroundings],
        step_s: float,
        momenta_nms: tuple[Vec3, Vec3, Vec3] | None = None,
    ) -> Motion:
        """One Runge-Kutta step of fourth order; the torque is evaluated at each of its four stages.

        Args:
            motion: state at the start.
            torque: torque on the body.
            around: surroundings at the start, the middle and the end of the step.
            step_s: length of the step.
            momenta_nms: of a driven wheel at the start, the middle and the end, body axes.
        """
        start, middle, end = around
        h_start, h_middle, h_end = momenta_nms or (None, None, None)
        half = 0.5 * step_s
        k1 = self.rates(motion, torque, start, h_start)
        k2 = self.rates(_advance(motion, k1, half), torque, middle, h_middle)
        k3 = self.rates(_advance(motion, k2, half), torque, middle, h_middle)
        k4 = self.rates(_advance(motion, k3, step_s), torque, end, h_end)
        (a1, b1, c1, d1), (x1, y1, z1) = k1
        (a2, b2, c2, d2), (x2, y2, z2) = k2
        (a3, b3, c3, d3), (x3, y3, z3) = k3
        (a4, b4, c4, d4), (x4, y4, z4) = k4
        mean: Rates = (
            (
                a1 + 2.0 * (a2 + a3) + a4,
                b1 + 2.0 * (b2 + b3) + b4,
                c1 + 2.0 * (c2 + c3) + c4,
                d1 + 2.0 * (d2 + d3) + d4,
            ),
            (x1 + 2.0 * (x2 + x3) + x4, y1 + 2.0 * (y2 + y3) + y4, z1 + 2.0 * (z2 + z3) + z4),
        )
        q, w = _advance(motion, mean, step_s / 6.0)
        return Motion(normalise(q), w)

    def rates(
        self, motion: "Stage", torque: Torque, around: Surroundings, driven_nms: Vec3 | None = None
    ) -> "Rates":
        """dq/dt [1/s] and dw/dt [rad/s^2], the right-hand side that ``step`` integrates."""
        q, w = motion
        tx, ty, tz = torque(q, w, around)
        (x, y, z), (hx, hy, hz) = transform(self._inertia, w), self._wheel
        if driven_nms is not None:
            hx, hy, hz = hx + driven_nms[0], hy + driven_nms[1], hz + driven_nms[2]
        gx, gy, gz = cross(w, (x + hx, y + hy, z + hz))
        q0, q1, q2, q3 = q
        wx, wy, wz = 0.5 * w[0], 0.5 * w[1], 0.5 * w[2]
        return (
            (
                -q1 * wx - q2 * wy - q3 * wz,
                q0 * wx + q2 * wz - q3 * wy,
                q0 * wy + q3 * wx - q1 * wz,
                q0 * wz + q1 * wy - q2 * wx,
            ),
            transform(self._inverse, (tx - gx, ty - gy, tz - gz)),
        )


Stage = tuple[Quaternion, Vec3]
"""Attitude and rate within a step; ``Motion`` is one."""

Rates = tuple[Quaternion, Vec3]
"""dq/dt and dw/dt."""


def _advance(motion: Stage, rates: Rates, step_s: float) -> Stage:
    (q0, q1, q2, q3), (wx, wy, wz) = motion
    (a, b, c, d), (x, y, z) = rates
    return (
        (q0 + step_s * a, q1 + step_s * b, q2 + step_s * c, q3 + step_s * d),
        (wx + step_s * x, wy + step_s * y, wz + step_s * z),
    )


def _inverse(m: Mat3) -> Mat3:
    """Inverse by cofactors."""
    (a, b, c), (d, e, f), (g, h, i) = m
    columns = (cross((d, e, f), (g, h, i)), cross((g, h, i), (a, b, c)), cross((a, b, c), (d, e, f)))
    determinant = a * columns[0][0] + b * columns[0][1] + c * columns[0][2]
    (r, u, x), (s, v, y), (t, w, z) = (
        (x / determinant, y / determinant, z / determinant) for x, y, z in columns
    )
    return ((r, s, t), (u, v, w), (x, y, z))
