"""Quantities by tick, derived from a flight's histories or from a block of them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fsw.core.laws.plan.law_axes import LawAxes
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.figures.attitude_arrays import angle_rad, axis1_angle_rad, law_attitude, normal_in_body
from sim.report.figures.estimate_error import estimate_error
from sim.value_types import Array

DARK = 0.5
"""A smaller visible fraction of the Sun counts as eclipse."""


@dataclass(frozen=True, slots=True)
class FlightHistories:
    """The histories of at least one tick: the plant's, and the controller's of the same ticks."""

    truth: Histories
    estimates: Estimates
    axes: LawAxes | None = None
    """Those that the laws count by; None: the body axes."""

    @property
    def ticks(self) -> int:
        """The number of ticks."""
        return len(self.truth["t_s"])

    @property
    def dark(self) -> NDArray[np.bool_]:
        """Whether it is eclipse."""
        return self.truth["lit"] < DARK

    @property
    def pointing_deg(self) -> Array:
        """The angle between the nominal and the true attitude."""
        return np.degrees(angle_rad(law_attitude(self.truth["q_body_from_orbit"], self.axes)))

    @property
    def axis1_deg(self) -> Array:
        """The angle of axis 1, that looks up, from the local vertical."""
        return np.degrees(axis1_angle_rad(law_attitude(self.truth["q_body_from_orbit"], self.axes)))

    @property
    def attitude_error_deg(self) -> Array:
        """The angle between the estimated and the true attitude; NaN before the first estimate."""
        return np.degrees(angle_rad(estimate_error(self.truth, self.estimates)))

    @property
    def rate_error_degps(self) -> Array:
        """The magnitude of the error of the inertial rate; NaN where unknown."""
        omega = self.estimates.omega_body_radps[: self.ticks]
        relative = self.estimates.omega_body_orbit_radps[: self.ticks]
        orbit_rate = np.linalg.norm(omega - relative, axis=1)
        orbital = orbit_rate[:, None] * normal_in_body(self.truth["q_body_from_orbit"])
        error: Array = np.linalg.norm(self.truth["omega_body_orbit_radps"] + orbital - omega, axis=1)
        return np.degrees(error)

    def sigma3_deg(self, first: int) -> Array:
        """3 sqrt(tr P) of three error states, from ``first`` on: three times the error the filter expects."""
        variances = [self.estimates.covariance[: self.ticks, i, i] for i in range(first, first + 3)]
        result: Array = np.degrees(3.0 * np.sqrt(np.sum(variances, axis=0)))
        return result
