"""The rigid body: attitude and rate integrated by the classic Runge-Kutta method, on plain floats."""

from math import isfinite
from typing import final

from fsw.wire.value import Value
from sim.plant.dynamics.torques import Torque
from sim.plant.dynamics.wheel import WheelStep
from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import ZERO, Mat3, Quaternion, Vec3, add, cross, normalise, transform


@final
class Motion(Value):
    """Attitude, and inertial rate in body axes."""

    FIELDS = ("q_body_from_eci", "omega_body_radps")
    __slots__ = FIELDS

    def __init__(self, q_body_from_eci: Quaternion, omega_body_radps: Vec3) -> None:
        self.q_body_from_eci = q_body_from_eci
        self.omega_body_radps = omega_body_radps

    def is_sound(self, step_s: float) -> bool:
        """Whether attitude and rate are finite, and a step of ``step_s`` turns it by less than a radian."""
        q0, q1, q2, q3 = self.q_body_from_eci
        x, y, z = self.omega_body_radps
        return isfinite(q0 + q1 + q2 + q3) and (x * x + y * y + z * z) * step_s * step_s < 1.0


@final
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
        step_s: float,
        start: Surroundings,
        middle: Surroundings,
        end: Surroundings,
        *,
        driven: WheelStep | None = None,
    ) -> Motion:
        """One Runge-Kutta step of fourth order; the torque is evaluated at each of its four stages.

        Args:
            motion: state at the start.
            torque: torque on the body.
            step_s: length of the step.
            start: surroundings at its start.
            middle: in its middle.
            end: at its end.
            driven: a driven wheel, over the step.
        """
        q, w, half = motion.q_body_from_eci, motion.omega_body_radps, 0.5 * step_s
        h1 = h2 = h4 = self._wheel
        if driven is not None:
            h1, h2, h4 = add(h1, driven.start_nms), add(h2, driven.middle_nms), add(h4, driven.end_nms)
        k1 = self._rates(q, w, torque, start, h1)
        q2, w2 = _advance(q, w, k1, half)
        k2 = self._rates(q2, w2, torque, middle, h2)
        q3, w3 = _advance(q, w, k2, half)
        k3 = self._rates(q3, w3, torque, middle, h2)
        q4, w4 = _advance(q, w, k3, step_s)
        k4 = self._rates(q4, w4, torque, end, h4)
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
        q, w = _advance(q, w, mean, step_s / 6.0)
        return Motion(normalise(q), w)

    def rates(self, motion: Motion, torque: Torque, around: Surroundings) -> "Rates":
        """dq/dt [1/s] and dw/dt [rad/s^2], the right-hand side that ``step`` integrates."""
        return self._rates(motion.q_body_from_eci, motion.omega_body_radps, torque, around, self._wheel)

    def _rates(self, q: Quaternion, w: Vec3, torque: Torque, around: Surroundings, wheel: Vec3) -> "Rates":
        """The same of a stage; ``wheel`` is the momentum of all wheels."""
        tx, ty, tz = torque.at(q, w, around)
        x, y, z = transform(self._inertia, w)
        hx, hy, hz = wheel
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


Rates = tuple[Quaternion, Vec3]
"""dq/dt and dw/dt."""


def _advance(q: Quaternion, w: Vec3, rates: Rates, step_s: float) -> tuple[Quaternion, Vec3]:
    q0, q1, q2, q3 = q
    wx, wy, wz = w
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
