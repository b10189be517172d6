"""The histories of a flight, and what is read off them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fsw.core.algebra.quaternion import Quaternion, rotate
from sim.value_types import Array


@dataclass(frozen=True)
class FlownMotion:
    """How a body moved relative to the orbital frame, a row a step.

    Attributes:
        orbit_s: period of the orbit.
        t_s: time.
        q_body_from_orbit: attitude, of the axes of the laws.
        relative_body_radps: rate relative to the orbital frame, in these axes.
    """

    orbit_s: float
    t_s: Array
    q_body_from_orbit: Array
    relative_body_radps: Array

    @cached_property
    def pointing_deg(self) -> Array:
        """Angle from the nominal attitude."""
        cosine = np.clip(np.abs(self.q_body_from_orbit[:, 0]), 0.0, 1.0)
        angle: Array = np.degrees(2.0 * np.arccos(cosine))
        return angle

    @cached_property
    def axis1_deg(self) -> Array:
        """Angle of axis 1 from the vertical."""
        q0, q1, q2, q3 = self.q_body_from_orbit.T
        angle: Array = np.degrees(np.arccos(np.clip(q0 * q0 + q1 * q1 - q2 * q2 - q3 * q3, -1.0, 1.0)))
        return angle

    def orbit(self, number: int) -> slice:
        """The rows of an orbit, from 0; negative from the end."""
        rows = round(self.orbit_s / (self.t_s[1] - self.t_s[0]))
        first = number * rows if number >= 0 else len(self.t_s) + number * rows
        return slice(max(0, first), first + rows)


@dataclass(frozen=True)
class RigidFlight(FlownMotion):
    """A flight of a rigid body; a row is what was before its dipole acts.

    Attributes:
        q_body_from_eci: attitude.
        omega_body_radps: inertial rate, body axes.
        momentum_body_nms: of body and wheel, body axes.
        m_body_am2: dipole of the coils over the step.
    """

    q_body_from_eci: Array
    omega_body_radps: Array
    momentum_body_nms: Array
    m_body_am2: Array

    def axis_to_deg(self, axis: int, direction_eci: Sequence[float]) -> Array:
        """Angle of a body axis, from 0, to a direction."""
        return self._angles(np.tile(np.eye(3)[axis], (len(self.t_s), 1)), direction_eci)

    def momentum_to_deg(self, direction_eci: Sequence[float]) -> Array:
        """Angle of the momentum, wheel included, to a direction."""
        return self._angles(self.momentum_body_nms, direction_eci)

    def _angles(self, vectors_body: Array, direction_eci: Sequence[float]) -> Array:
        turned = [
            rotate(_quaternion(q), (direction_eci[0], direction_eci[1], direction_eci[2]))
            for q in self.q_body_from_eci
        ]
        towards = np.array(turned)
        sizes = np.linalg.norm(vectors_body, axis=1) * np.linalg.norm(towards, axis=1)
        cosines = np.einsum("ti,ti->t", vectors_body, towards) / sizes
        angles: Array = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
        return angles


def _quaternion(q: Sequence[float]) -> Quaternion:
    a, b, c, d = q
    return (float(a), float(b), float(c), float(d))
