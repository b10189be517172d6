"""Quantities of a flight as lines to draw, and spans of time, gathered block by block."""

import numpy as np
from numpy.typing import NDArray

from fsw.wire.messages import Mode
from sim.drawing.envelope import Envelope
from sim.record.estimates import Estimates
from sim.record.truth import OF_WHEEL, Histories
from sim.report.figures.coil_effort import driven_coils
from sim.report.figures.histories import FlightHistories
from sim.scenario.schema import Scenario, orbit_period_s
from sim.statistics.settling import spans
from sim.value_types import Array

# --- Attitude, field, Sun and position of a flight as samples for a moving picture, gathered block by block


MOST_SAMPLES = 3000
COLUMNS = {"q_body_from_orbit": 4, "b_body_t": 3, "m_body_am2": 3, "sun_body": 3, "r_eci_m": 3, "lit": 1}
"""Histories that are sampled, and their widths."""


class MotionSamples:
    """Of a flight of ``ticks`` ticks, from its blocks in order; memory does not grow with its length."""

    def __init__(self, ticks: int) -> None:
        self.places = np.unique(np.linspace(0, ticks - 1, min(ticks, MOST_SAMPLES)).round().astype(int))
        """The tick of each sample."""
        self._samples = {name: np.full((len(self.places), width), np.nan) for name, width in COLUMNS.items()}
        self._taken = 0

    def take(self, truth: Histories) -> None:
        """The next block."""
        begin, end = self._taken, self._taken + len(truth["lit"])
        first, past = np.searchsorted(self.places, (begin, end))
        for name, samples in self._samples.items():
            samples[first:past] = truth[name][self.places[first:past] - begin].reshape(-1, samples.shape[1])
        self._taken = end

    def samples(self, name: str) -> Array:
        """A history at each place, (samples, width)."""
        return self._samples[name]


TORQUE = "torque_body_nm/"
"""Begins the name of a torque, in the histories and here."""
MEAN_S = 600.0
"""Coils act in pulses: their torque is drawn as the magnitude of its mean over this time."""
FINE_BINS = 2500
"""Bins along a flight; a picture shows fewer, but the page can be zoomed."""
ROUNDING = 1e-9
"""A torque below this fraction of the largest so far is the rounding error of a mean."""


class Spans:
    """The spans of ticks over which something holds."""

    def __init__(self) -> None:
        self.spans: list[tuple[int, int]] = []
        self._ticks = 0

    def take(self, holds: NDArray[np.bool_]) -> None:
        """Whether it does in each of the next ticks."""
        for first, past in spans(holds):
            begin, end = self._ticks + first, self._ticks + past
            if self.spans and self.spans[-1][1] == begin:
                begin, _ = self.spans.pop()
            self.spans.append((begin, end))
        self._ticks += len(holds)


class _RunningMean:
    """The mean of vectors over the last ``rows`` rows, over fewer at the beginning."""

    def __init__(self, rows: int, width: int = 3) -> None:
        self._rows = rows
        self._before = np.zeros((0, width))

    def take(self, vectors: Array) -> Array:
        """The mean at each of the next rows."""
        known = np.concatenate((self._before, vectors))
        total = np.concatenate((np.zeros((1, known.shape[1])), np.cumsum(known, axis=0)))
        past = np.arange(len(self._before) + 1, len(known) + 1)
        first = np.maximum(past - self._rows, 0)
        self._before = known[-self._rows :]
        result: Array = (total[past] - total[first]) / (past - first)[:, None]
        return result


class _Torques:
    """Magnitudes of the torques by source; of the coils, which act in pulses, of the mean."""

    def __init__(self, mean_rows: int) -> None:
        self._mean = _RunningMean(mean_rows)
        self._largest: dict[str, float] = {}

    def of(self, truth: Histories) -> dict[str, Array]:
        """By name, N m; NaN where there is none."""
        sizes = {}
        for name, torque in truth.items():
            if name.startswith(TORQUE):
                acts = self._mean.take(torque) if name == f"{TORQUE}coils" else torque
                size = np.linalg.norm(acts, axis=1)
                largest = max(self._largest.get(name, 0.0), float(size.max()))
                self._largest[name] = largest
                sizes[name] = np.where(size > ROUNDING * largest, size, np.nan)
        return sizes


class _Duty:
    """Fraction of the orbit before each tick, or of the flight so far, that a continuous driver drove."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._mean = _RunningMean(max(1, round(orbit_period_s(scenario) * scenario.time.tick_hz)), 4)

    def of(self, truth: Histories) -> Array:
        """Of each coil, and of the time in which any was driven, (n, 4)."""
        driven = driven_coils(self._scenario, truth["m_body_am2"])
        each_and_any = np.column_stack((driven, driven.any(axis=1))).astype(float)
        return self._scenario.coils.on_fraction * self._mean.take(each_and_any)


class Lines:
    """Of a flight of ``ticks`` ticks, from its blocks in order; memory does not grow with its length."""

    def __init__(self, ticks: int, scenario: Scenario) -> None:
        self.ticks = ticks
        self._axes = scenario.body.law_axes
        self.dark = Spans()
        self.modes = {mode: Spans() for mode in Mode}
        self.motion = MotionSamples(ticks)
        self.has_estimates = False
        """Whether the controller estimated with a filter, at some tick."""
        self._torques = _Torques(round(MEAN_S * scenario.time.tick_hz))
        self._duty = _Duty(scenario) if scenario.coils.driver == "continuous" else None
        self._columns: dict[str, slice] = {}
        self._envelope: Envelope | None = None

    def take(self, truth: Histories, estimates: Estimates) -> None:
        """The next block, of at least one tick."""
        flight = FlightHistories(truth, estimates, self._axes)
        self.dark.take(flight.dark)
        self.motion.take(truth)
        for mode, ticks in self.modes.items():
            ticks.take(estimates.mode[: flight.ticks] == mode)
        self.has_estimates |= bool(np.isfinite(estimates.covariance[: flight.ticks, 0, 0]).any())
        drawn = _quantities(flight) | self._torques.of(truth)
        if self._duty is not None:
            drawn["duty"] = self._duty.of(truth)
        samples = np.column_stack(list(drawn.values()))
        if self._envelope is None:
            ends = np.cumsum([history.size // flight.ticks for history in drawn.values()])
            self._columns = {
                name: slice(begin, end)
                for name, begin, end in zip(drawn, (0, *ends[:-1].tolist()), ends.tolist(), strict=True)
            }
            self._envelope = Envelope(self.ticks, samples.shape[1], FINE_BINS)
        self._envelope.take(samples)

    @property
    def places(self) -> Array:
        """The tick at which each point stands."""
        return np.zeros(0) if self._envelope is None else self._envelope.places.astype(float)

    def line(self, name: str) -> Array:
        """A quantity, (points,), a vector, (points, 3), or ``duty`` of each coil and of any, (points, 4).

        Raises:
            KeyError: there is none of this name.
        """
        columns = self._columns[name]
        points = np.zeros((0, 0)) if self._envelope is None else self._envelope.points[:, columns]
        return points[:, 0] if points.shape[1] == 1 else points

    def torques(self) -> dict[str, Array]:
        """Of each source that ever acts, N m."""
        lines = {
            name.removeprefix(TORQUE): self.line(name) for name in self._columns if name.startswith(TORQUE)
        }
        return {source: line for source, line in lines.items() if np.isfinite(line).any()}


def _quantities(flight: FlightHistories) -> dict[str, Array]:
    """By name, (n,) or (n, 3): angles in degrees and degrees per second, the others in SI."""
    omega_degps = np.degrees(flight.truth["omega_body_orbit_radps"])
    b_body_t = flight.truth["b_body_t"]
    wheel = OF_WHEEL[0]
    return {
        "pointing_deg": flight.pointing_deg,
        "axis1_deg": flight.axis1_deg,
        "omega_degps": omega_degps,
        "rate_degps": np.linalg.norm(omega_degps, axis=1),
        "attitude_error_deg": flight.attitude_error_deg,
        "attitude_sigma3_deg": flight.sigma3_deg(0),
        "rate_error_degps": flight.rate_error_degps,
        "rate_sigma3_degps": flight.sigma3_deg(3),
        "b_body_t": b_body_t,
        "field_t": np.linalg.norm(b_body_t, axis=1),
        "m_body_am2": flight.truth["m_body_am2"],
        **({wheel: flight.truth[wheel]} if wheel in flight.truth else {}),
    }
