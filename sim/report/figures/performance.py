"""The figures of a flight against the plant's truth, gathered block by block."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from fsw.core.estimation.mekf import Estimate
from fsw.wire.messages import Mode
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.figures import parameters
from sim.report.figures.attitude_arrays import angle_rad, axis1_angle_rad, law_attitude, law_vector
from sim.report.figures.controlled import ControlledError, spin_reference_radps
from sim.report.figures.estimate_error import (
    CONVERGED_DEG,
    CONVERGED_FOR_S,
    estimate_error,
    nees,
    within_3sigma,
)
from sim.report.figures.mean import Mean
from sim.report.requirements.judge import Judgement
from sim.scenario.controlled import SETTLED_DEG, SLOW_DEGPS, SLOWEST_DEGPS, controlled
from sim.scenario.schema import Scenario, orbit_period_s
from sim.statistics.indices import magnitudes
from sim.statistics.settling import Settling, held_ticks, spans
from sim.value_types import Array, Json

BLOCK_TICKS = 4096
"""Sums are taken over blocks of this many ticks, however a flight is handed over: so they are bit-exact."""
SPIN_SETTLED_RADPS = 1e-3
_MODES = frozenset(Mode)


@dataclass(slots=True)
class _Angle:
    """An angle from nominal, in the last orbit and at the end, and the tick at which it has settled."""

    settling: Settling
    last_orbit: Mean = field(default_factory=Mean)
    final_deg: float = np.nan

    def take(self, angle_deg: Array, recent: slice) -> None:
        self.last_orbit.take(angle_deg[recent])
        self.final_deg = float(angle_deg[-1])
        self.settling.take(angle_deg < SETTLED_DEG)

    def figures(self) -> Json:
        return {
            "final": self.final_deg,
            "rms_last_orbit": self.last_orbit.rms,
            "max_last_orbit": self.last_orbit.most,
        }


@dataclass(slots=True)
class _Consistency:
    """Of the estimate from a tick on: its errors, and whether its covariance accounts for them."""

    sunlit: Mean = field(default_factory=Mean)
    eclipse: Mean = field(default_factory=Mean)
    consistency: Mean = field(default_factory=Mean)
    counted: int = 0
    inside: int = 0

    def take(self, truth: Histories, estimates: Estimates, error_deg: Array, since: int) -> None:
        """A block, from its row ``since`` on."""
        ticks, estimated = len(error_deg), np.isfinite(error_deg)
        estimated[:since] = False  # also where a filter that restarts has no estimate for a while
        lit = truth["lit"] > 0.5
        self.sunlit.take(error_deg[lit & estimated])
        self.eclipse.take(error_deg[~lit & estimated])
        consistency = nees(truth, estimates)[since:]
        self.consistency.take(consistency[np.isfinite(consistency)])
        counted = estimates.valid[:ticks] & np.isfinite(estimates.covariance[:ticks]).all(axis=(1, 2))
        counted[:since] = False
        self.counted += int(counted.sum())
        self.inside += int(within_3sigma(truth, estimates)[counted].all(axis=1).sum())

    def figures(self) -> Json:
        named = (("rms_sunlit", self.sunlit), ("rms_eclipse", self.eclipse))
        result: Json = {
            "estimate_deg": {key: errors.rms for key, errors in named if errors.count}
            | {
                "max": max(self.sunlit.most, self.eclipse.most),
                "within_3sigma": self.inside / self.counted if self.counted else None,
            }
        }
        if self.consistency.count:
            result["nees_mean"] = self.consistency.mean
        return result


@dataclass(slots=True)
class _Convergence:
    """Finds the first ten minutes with a small error, and judges the estimate from their first tick on.

    What follows the first tick of a span that may become long enough counts from then on; where the span ends
    too early, it is forgotten.
    """

    length: int
    first: int | None = None
    found: bool = False
    consistency: _Consistency = field(default_factory=_Consistency)

    def take(self, truth: Histories, estimates: Estimates, begin: int) -> None:
        error_deg = np.degrees(angle_rad(estimate_error(truth, estimates)))
        if not self.found:
            since = self._search(error_deg, begin)
            if since is None:
                return
        else:
            since = 0
        self.consistency.take(truth, estimates, error_deg, since)

    def _search(self, error_deg: Array, begin: int) -> int | None:
        """The row from which this block counts; None if it does not."""
        small = spans(error_deg < CONVERGED_DEG)
        if self.first is not None and not (small and small[0][0] == 0):
            self.first, self.consistency = None, _Consistency()
        for row, past in small:
            goes_on = self.first is not None and row == 0
            first = self.first if goes_on and self.first is not None else begin + row
            self.found = begin + past - first >= self.length
            if self.found or past == len(error_deg):
                if not goes_on:
                    self.first, self.consistency = first, _Consistency()
                return 0 if goes_on else row
            self.first, self.consistency = None, _Consistency()
        return None


@dataclass(slots=True)
class _Spin:
    """The spin about axis 1 against its reference, and the tick at which it has settled at that."""

    settling: Settling
    reference_radps: float = 0.0
    """The latest."""
    asked: bool = False
    """Whether it was ever other than 0."""
    last_orbit: Mean = field(default_factory=Mean)
    deviation: Mean = field(default_factory=Mean)

    def take(self, spin_radps: Array, reference_radps: Array, recent: slice) -> None:
        deviation = np.abs(spin_radps - reference_radps)
        self.reference_radps = float(reference_radps[-1])
        self.asked |= bool(reference_radps.any())
        self.last_orbit.take(spin_radps[recent])
        self.deviation.take(deviation[recent])
        self.settling.take(deviation < SPIN_SETTLED_RADPS)


@dataclass(slots=True)
class _Tumble:
    """The rate relative to the orbital frame: at start and end, and since when it stays under two limits."""

    slow: Settling
    slowest: Settling
    start_degps: float = np.nan
    final_degps: float = np.nan

    def take(self, rate_degps: Array) -> None:
        if self.slow.taken == 0:
            self.start_degps = float(rate_degps[0])
        self.final_degps = float(rate_degps[-1])
        self.slow.take(rate_degps < SLOW_DEGPS)
        self.slowest.take(rate_degps < SLOWEST_DEGPS)

    def figures(self, hz: float) -> Json:
        result: Json = {"start": self.start_degps, "final": self.final_degps}
        for name, settling in (("under_1_s", self.slow), ("under_0.1_s", self.slowest)):
            if settling.tick is not None:
                result[name] = settling.tick / hz
        return result


class Performance:
    """What a flight of ``ticks`` ticks achieves, from its blocks in order.

    Args:
        scenario: that was flown.
        ticks: of the whole flight.
        own_software: it was flown by the flight software of this project.
    """

    def __init__(self, scenario: Scenario, ticks: int, own_software: bool = True) -> None:
        self._scenario = scenario
        self._hz, self._orbit_s = scenario.time.tick_hz, orbit_period_s(scenario)
        self._last_orbit_from = max(0, ticks - round(self._orbit_s * self._hz))
        self.ticks = 0
        """Taken so far."""
        held = held_ticks(self._hz)
        self._pointing, self._axis1 = _Angle(Settling(held)), _Angle(Settling(held))
        self._convergence = _Convergence(round(CONVERGED_FOR_S * self._hz))
        self._spin = _Spin(Settling(held))
        self._tumble = _Tumble(Settling(held), Settling(held))
        self._controlled = ControlledError(controlled(scenario), scenario, Settling(held))
        self.judgement = Judgement(scenario, ticks, own_software)
        """By the requirements of the scenario."""
        self._last: tuple[Histories, Estimates] | None = None
        self.last_estimate: Estimate | None = None
        """That of the filter, whole."""

    def take(self, truth: Histories, estimates: Estimates) -> None:
        """The next block of ``BLOCK_TICKS``; the last one may be shorter, but is not empty."""
        first, rows = self.ticks, len(truth["t_s"])
        axes = self._scenario.body.law_axes
        q = law_attitude(truth["q_body_from_orbit"], axes)
        recent = slice(max(0, self._last_orbit_from - first), rows)
        self._pointing.take(np.degrees(angle_rad(q)), recent)
        self._axis1.take(np.degrees(axis1_angle_rad(q)), recent)
        self._tumble.take(np.degrees(magnitudes(truth["omega_body_orbit_radps"])))
        self._convergence.take(truth, estimates, first)
        reference_radps = spin_reference_radps(self._scenario, truth["t_s"])
        self._spin.take(law_vector(truth["omega_body_orbit_radps"], axes)[:, 0], reference_radps, recent)
        self._controlled.take(truth, recent)
        self.judgement.take(truth, estimates)
        self._last = truth, estimates
        self.last_estimate = estimates.last or self.last_estimate
        self.ticks += rows

    def figures(self) -> Json:
        """The keys of summary.json on attitude, estimate and mode; none of a flight without ticks."""
        if self._last is None:
            return {}
        truth, estimates = self._last
        axis1 = self._axis1.figures() | {"mean_last_orbit": self._axis1.last_orbit.mean}
        if (settled := self._axis1.settling.tick) is not None:
            axis1["settle_orbits_5deg"] = settled / self._hz / self._orbit_s
        result: Json = {
            "orbits": self.ticks / self._hz / self._orbit_s,
            "controlled": self._controlled.figures(self._orbit_s * self._hz),
            "pointing_deg": self._pointing.figures(),
            "axis1_deg": axis1,
            "rate_degps": self._tumble.figures(self._hz),
        }
        if self._convergence.found and self._convergence.first is not None:
            result |= self._convergence.consistency.figures()
            result["converged_at_s"] = self._convergence.first / self._hz
        result["parameters"] = parameters.parameter_figures(self._scenario, truth, self.last_estimate)
        if (mode := int(estimates.mode[len(truth["t_s"]) - 1])) in _MODES:
            result["mode_final"] = Mode(mode).name
        return result

    def spin(self) -> Json | None:
        """How the spin follows its reference; None without a reference, or without a tick."""
        spin = self._spin
        if not spin.asked or self._last is None:
            return None
        result: Json = {
            "reference": spin.reference_radps,
            "mean_last_orbit": spin.last_orbit.mean,
            "max_dev_last_orbit": spin.deviation.most,
        }
        if (settled := spin.settling.tick) is not None:
            result["settle_s_1e-3"] = settled / self._hz
        return result


def perform(scenario: Scenario, truth: Histories, estimates: Estimates) -> Performance:
    """The performance of a flight, from its whole histories."""
    performance = Performance(scenario, len(truth["t_s"]))
    for truth_block, estimates_block in blocks(truth, estimates):
        performance.take(truth_block, estimates_block)
    return performance


def blocks(truth: Histories, estimates: Estimates) -> Iterator[tuple[Histories, Estimates]]:
    """Histories in blocks, in order."""
    ticks = len(truth["t_s"])
    for first in range(0, ticks, BLOCK_TICKS):
        rows = slice(first, min(first + BLOCK_TICKS, ticks))
        yield {name: history[rows] for name, history in truth.items()}, estimates.part(rows)
