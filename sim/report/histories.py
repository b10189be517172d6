"""The quantities that the charts of the report draw, derived from a run's histories."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sim.audit.auditor import AuditReport
from sim.audit.findings import COILS, DrivenPulse
from sim.drawing.canvas import Span, TimeAxis
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.attitude_arrays import angle_rad, axis1_angle_rad, normal_in_body
from sim.report.spans import spans
from sim.report.summary import estimate_error
from sim.scenario.schema import Scenario, orbit_period_s

Array = NDArray[np.float64]

DARK = 0.5
"""A smaller visible fraction of the Sun is an eclipse."""
ROUNDING = 1e-9
"""A torque below this fraction of the largest is the rounding error of a mean."""


@dataclass(frozen=True, slots=True)
class FlightHistories:
    """The histories of a flight of at least one tick.

    Attributes:
        truth: the plant's histories.
        estimates: the controller's, of the same ticks.
        audit: pulses, violations and the limits.
        tick_hz: ticks a second.
        orbit_s: period of the orbit.
    """

    truth: Histories
    estimates: Estimates
    audit: AuditReport
    tick_hz: int
    orbit_s: float

    @classmethod
    def of(
        cls, scenario: Scenario, truth: Histories, estimates: Estimates, audit: AuditReport
    ) -> "FlightHistories":
        """The histories of a run."""
        return cls(truth, estimates, audit, scenario.time.tick_hz, orbit_period_s(scenario))

    @property
    def t_s(self) -> Array:
        """Time of each tick."""
        return self.truth["t_s"]

    @property
    def ticks(self) -> int:
        """The number of ticks."""
        return len(self.t_s)

    @property
    def length_s(self) -> float:
        """How long the flight lasted."""
        return self.ticks / self.tick_hz

    @property
    def time(self) -> TimeAxis:
        """The whole flight in orbits; a short one in minutes or seconds."""
        if self.length_s < 0.75 * self.orbit_s:
            return self.window(0.0, self.length_s)
        label = f"orbits of {self.orbit_s / 60.0:.1f} min"
        return TimeAxis(label, self.orbit_s, 0.0, self.length_s, self.spans(self.truth["lit"] < DARK))

    def window(self, start_s: float, length_s: float) -> TimeAxis:
        """A part of the flight, in minutes or seconds."""
        label, unit_s = ("minutes", 60.0) if length_s >= 300.0 else ("seconds", 1.0)
        eclipses = self.spans(self.truth["lit"] < DARK)
        shown = tuple(span for span in eclipses if span[1] > start_s and span[0] < start_s + length_s)
        return TimeAxis(f"{label} from the start", unit_s, start_s, start_s + length_s, shown)

    def spans(self, where: NDArray[np.bool_]) -> tuple[Span, ...]:
        """The spans of time, s, over which something is so at every tick."""
        return tuple((first / self.tick_hz, past / self.tick_hz) for first, past in spans(where))

    @property
    def pointing_deg(self) -> Array:
        """The angle of the turn from nominal to the true attitude."""
        return np.degrees(angle_rad(self.truth["q_body_from_orbit"]))

    @property
    def axis1_deg(self) -> Array:
        """The angle of body axis 1 from the local vertical."""
        return np.degrees(axis1_angle_rad(self.truth["q_body_from_orbit"]))

    @property
    def has_estimates(self) -> bool:
        """Whether the controller estimated with a filter, at some tick."""
        return bool(np.isfinite(self.estimates.covariance[: self.ticks, 0, 0]).any())

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
        """3 sqrt(tr P) of three error states, ``first`` and on: thrice the error the filter expects."""
        variances = [self.estimates.covariance[: self.ticks, i, i] for i in range(first, first + 3)]
        result: Array = np.degrees(3.0 * np.sqrt(np.sum(variances, axis=0)))
        return result

    def torques(self) -> dict[str, Array]:
        """Magnitude of the torque of each source that ever acts, N m.

        Coils act in pulses: theirs is the magnitude of the mean over ten minutes.
        """
        by_source = {}
        for name, torque in self.truth.items():
            source = name.removeprefix("torque_body_nm/")
            if source != name and np.any(torque):
                acts = _mean(torque, round(600.0 * self.tick_hz)) if source == "coils" else torque
                size = np.linalg.norm(acts, axis=1)
                by_source[source] = np.where(size > ROUNDING * size.max(), size, np.nan)
        return by_source

    def duty(self, coil: int, at_s: Array) -> Array:
        """Fraction of the orbit before each time, or of the flight so far, for which a coil was driven."""
        pulses = [pulse for pulse in self.audit.pulses if pulse.coil == coil]
        driven_s = _driven_s(pulses, at_s) - _driven_s(pulses, at_s - self.orbit_s)
        result: Array = driven_s / np.clip(at_s, 1.0 / self.tick_hz, self.orbit_s)
        return result

    def gaps_s(self) -> Array:
        """The gaps that the back-off limits: between any pulses, or between those of one coil."""
        groups = [COILS] if self.audit.limits.shared else [(coil,) for coil in COILS]
        gaps = []
        for group in groups:
            pulses = [pulse for pulse in self.audit.pulses if pulse.coil in group]
            gaps += [float(later.start_s - sooner.end_s) for sooner, later in pairwise(pulses)]
        return np.array(gaps)

    def busiest(self, length_s: float) -> float:
        """Start [s] of the first window of this length that holds the most pulses."""
        starts = np.array([float(pulse.start_s) for pulse in self.audit.pulses])
        if self.length_s <= length_s or len(starts) == 0:
            return 0.0
        counts = np.searchsorted(starts, starts + 0.9 * length_s) - np.arange(len(starts))
        begin = float(starts[int(np.argmax(counts))]) - 0.05 * length_s
        return min(max(begin, 0.0), self.length_s - length_s)


def _driven_s(pulses: Sequence[DrivenPulse], at_s: Array) -> Array:
    """Seconds driven until each time, by pulses of one coil in order."""
    if not pulses:
        return np.zeros_like(at_s)
    edges = np.array([(float(pulse.start_s), float(pulse.end_s)) for pulse in pulses])
    lengths = edges[:, 1] - edges[:, 0]
    done = np.cumsum(lengths)
    total_s = np.stack((done - lengths, done), axis=1)
    result: Array = np.interp(at_s, edges.ravel(), total_s.ravel())
    return result


def _mean(vectors: Array, length: int) -> Array:
    """The running mean over the last ``length`` rows, over fewer at the beginning."""
    total = np.cumsum(vectors, axis=0)
    count = np.minimum(np.arange(1, len(vectors) + 1), length)[:, None]
    before = np.zeros_like(total)
    before[length:] = total[:-length]
    result: Array = (total - before) / count
    return result
