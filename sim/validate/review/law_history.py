"""What a flight of a law has been: histories, and angles read off them."""

from dataclasses import dataclass

import numpy as np

from sim.plant.environment.orbit import Array
from sim.plant.rotation import Vec3


@dataclass(frozen=True, slots=True)
class LawHistory:
    """Histories, a row a step, each before its dipole acts.

    Attributes:
        t_s: time.
        orbit_rate_radps: of the circular orbit.
        omega_body_radps: inertial rate, body axes.
        relative_body_radps: rate relative to the orbital frame, body axes.
        q_body_from_orbit: attitude.
        c_body_from_orbit: the same as matrices.
        c_body_from_eci: attitude.
        momentum_eci_nms: of body and wheel.
        m_body_am2: dipole of the coils over the step.
        wheel_nms: momentum of a driven wheel relative to the body, along its axis; 0 without one.
    """

    t_s: Array
    orbit_rate_radps: float
    omega_body_radps: Array
    relative_body_radps: Array
    q_body_from_orbit: Array
    c_body_from_orbit: Array
    c_body_from_eci: Array
    momentum_eci_nms: Array
    m_body_am2: Array
    wheel_nms: Array

    @property
    def orbits(self) -> Array:
        """Time in orbits."""
        return self.t_s * self.orbit_rate_radps / (2.0 * np.pi)

    @property
    def angle_deg(self) -> Array:
        """Angle from the nominal attitude."""
        scalar = np.clip(np.abs(self.q_body_from_orbit[:, 0]), 0.0, 1.0)
        angle: Array = np.degrees(2.0 * np.arccos(scalar))
        return angle

    @property
    def last_orbit_deg(self) -> float:
        """The largest angle from the nominal attitude in the last orbit."""
        return float(self.angle_deg[self.orbits > self.orbits[-1] - 1.0].max())

    def axis_deg(self, axis: int, direction_eci: Vec3) -> Array:
        """Angle of a body axis, from 0, from a direction."""
        return angle_deg(self.c_body_from_eci[:, axis, :], direction_eci)

    def orbit_axis_deg(self, axis: int, direction: int) -> Array:
        """Angle of a body axis, from 0, from an axis of the orbital frame."""
        cosines = np.clip(self.c_body_from_orbit[:, axis, direction], -1.0, 1.0)
        angle: Array = np.degrees(np.arccos(cosines))
        return angle


def angle_deg(vectors: Array, direction: Vec3) -> Array:
    """Angle of each row from a direction in the same axes."""
    cosines = vectors @ np.array(direction) / np.linalg.norm(direction) / np.linalg.norm(vectors, axis=1)
    angle: Array = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
    return angle
