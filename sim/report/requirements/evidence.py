"""What is known of a flight when a requirement is missed: truth, estimate, modes, coils, disturbances."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsw.wire.messages import Mode
from sim.audit.findings import AuditReport
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.figures.coil_effort import nominal_dipole_am2
from sim.report.figures.controlled import error_vectors
from sim.report.figures.estimate_error import knowledge_errors, within_3sigma
from sim.report.figures.mean import Mean
from sim.scenario.schema import Scenario, flight_table, orbit_period_s
from sim.statistics.indices import magnitudes
from sim.value_types import Array

HALF_ORBITS = 6
"""At the end of the flight, from which the trend of the error is determined."""
NOT_DISTURBANCES = ("gravity_gradient", "coils", "residual_dipole")
"""Torques that are the body's own, the coils' or counted as a dipole."""


class Missed(NamedTuple):
    """A requirement that a flight misses.

    Attributes:
        name: of its index.
        what: what it is of.
        limit: the most it may be, or the error below which it has settled; None where it is not an angle.
        settled: since when it has settled, in orbits; None: never.
    """

    name: str
    what: str
    limit: float | None
    settled: float | None = None


@dataclass(frozen=True, slots=True)
class FlightEvidence:
    """Figures of a flight, times in orbits; of the last orbit, or of the whole of a shorter flight.

    Attributes:
        scenario: what was flown.
        orbits: length of the flight.
        trend: by half orbit, RMS of the error of what is controlled, at the end of the flight.
        estimate_deg: RMS of the knowledge error while the attitude is called valid; None if it never is.
        valid_part: fraction of the last orbit in which the attitude is called valid.
        within_3sigma: fraction of that in which each axis of the error is inside the filter's 3 sigma.
        first_valid: when the attitude was first called valid; None: never.
        lit_from: when the Sun was first seen; None: never.
        in_mode: fraction of the flight in each mode.
        first_in_point: when POINT was first entered; None: never.
        rate_degps: at the start, relative to the orbital frame and the spin reference.
        rate_last_degps: RMS of the same.
        slow_from: since when the rate stays below that of ACQUIRE; None: it does not.
        isolated: the units that are out of use at the end, and since when.
        torque_nm: mean disturbance torque, body axes.
        levels: pulses at each level, least first.
        saturated_part: fraction of the time in which a continuous driver gives all it can.
        course: by half orbit, RMS of the error of what is controlled, from the start.
        pulses: start in orbits and size of the level of each pulse of the flight.
        fell_back: since when and for how long the controller was in SAFE or DETUMBLE after a better mode.
        unsure_dark: part of the ticks in the Earth's shadow, after the first valid one, in which the filter
            is less certain than the control can use.
        dark_course: by half orbit, RMS of the knowledge error in the Earth's shadow, deg; 0 without a shadow.
        own_software: the flight software is this project's, whose modes, table and laws are known.
    """

    scenario: Scenario
    orbits: float
    trend: tuple[float, ...] = ()
    estimate_deg: float | None = None
    valid_part: float = 1.0
    within_3sigma: float | None = None
    first_valid: float | None = 0.0
    lit_from: float | None = 0.0
    in_mode: Mapping[Mode, float] = field(default_factory=dict)
    first_in_point: float | None = 0.0
    rate_degps: float = 0.0
    rate_last_degps: float = 0.0
    slow_from: float | None = 0.0
    isolated: Mapping[str, float] = field(default_factory=dict)
    torque_nm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    levels: tuple[int, int, int] = (0, 0, 0)
    saturated_part: float = 0.0
    course: tuple[float, ...] = ()
    pulses: tuple[tuple[float, int], ...] = ()
    fell_back: tuple[tuple[Mode, float, float], ...] = ()
    unsure_dark: float = 0.0
    dark_course: tuple[float, ...] = ()
    own_software: bool = True


class EvidenceGatherer:
    """Gathers the evidence block by block, in constant memory."""

    def __init__(self, scenario: Scenario, what: str, ticks: int, own_software: bool = True) -> None:
        self._scenario, self._what, self._ticks = scenario, what, ticks
        self._own_software = own_software
        self._orbit = orbit_period_s(scenario) * scenario.time.tick_hz
        self._last_from = max(0, ticks - round(self._orbit))
        self._halves = [Mean() for _ in range(min(HALF_ORBITS, int(2.0 * ticks / self._orbit)))]
        table = flight_table(scenario)
        self._slow_degps = table.modes.slow_degps
        self._usable_rad = np.radians(table.estimator.usable_sigma_deg)
        self._dark = self._unsure_dark = 0
        halves = int(2.0 * ticks / self._orbit) + 1
        self._dark_squares, self._dark_ticks = np.zeros(halves), np.zeros(halves)
        self._taken = 0
        self._estimate, self._rate, self._torque = Mean(), Mean(), np.zeros(3)
        self._valid = self._inside = self._saturated = 0
        self._modes = np.zeros(max(Mode) + 1, np.int64)
        self._first: dict[str, int] = {}
        self._slow_from = 0
        self._course: list[Mean] = []
        self._course_end = 0
        self._mode: list[tuple[int, int]] = []
        self._rate_at_start = 0.0

    def take(self, truth: Histories, estimates: Estimates) -> None:
        """The next block."""
        first, rows = self._taken, len(truth["t_s"])
        self._taken += rows
        recent = slice(max(0, self._last_from - first), rows)
        self._take_trend(first, magnitudes(error_vectors(self._what, truth, self._scenario)))
        self._take_rate(first, magnitudes(error_vectors("rate", truth, self._scenario)), recent)
        if self._own_software:
            self._take_mode(first, estimates.mode[:rows])
            self._modes += np.bincount(estimates.mode[:rows], minlength=len(self._modes))
        self._note("valid", first, estimates.valid[:rows])
        self._note("lit", first, truth["lit"] > 0.5)
        self._note("point", first, estimates.mode[:rows] == Mode.POINT)
        self._torque += _disturbance(self._scenario, truth)
        self._saturated += int(_saturated(self._scenario, truth)[recent].sum())
        self._take_shadow(first, truth, estimates)
        if recent.start < rows:
            self._take_estimate(truth, estimates, recent)

    def evidence(self, audit: AuditReport, isolated_s: Mapping[str, float]) -> FlightEvidence:
        """All of it; ``isolated_s`` are the units out of use at the end, and when they were isolated."""
        orbit_s = self._orbit / self._scenario.time.tick_hz
        last = max(1, self._ticks - self._last_from)
        since_s = self._last_from / self._scenario.time.tick_hz
        levels = [abs(pulse.level) for pulse in audit.pulses if pulse.start_s >= since_s]
        x, y, z = (self._torque / max(1, self._taken)).tolist()
        return FlightEvidence(
            scenario=self._scenario,
            orbits=self._ticks / self._orbit,
            trend=tuple(half.rms for half in self._halves if half.count),
            estimate_deg=self._estimate.rms if self._estimate.count else None,
            valid_part=self._valid / last,
            within_3sigma=self._inside / self._valid if self._valid else None,
            first_valid=self._since("valid"),
            lit_from=self._since("lit"),
            in_mode={mode: self._modes[mode] / max(1, self._taken) for mode in Mode},
            first_in_point=self._since("point"),
            rate_degps=self._rate_at_start,
            rate_last_degps=self._rate.rms,
            slow_from=self._slow_from / self._orbit if self._slow_from < self._taken else None,
            isolated={unit: at_s / orbit_s for unit, at_s in isolated_s.items()},
            torque_nm=(x, y, z),
            levels=(levels.count(1), levels.count(2), levels.count(3)),
            saturated_part=self._saturated / last,
            course=tuple(half.rms for half in self._course),
            pulses=tuple((float(pulse.start_s) / orbit_s, abs(pulse.level)) for pulse in audit.pulses),
            fell_back=tuple(self._fell_back()) if self._own_software else (),
            unsure_dark=self._unsure_dark / self._dark if self._dark else 0.0,
            dark_course=tuple(np.sqrt(self._dark_squares / np.maximum(1.0, self._dark_ticks)).tolist()),
            own_software=self._own_software,
        )

    def _take_trend(self, first: int, error: Array) -> None:
        past, half = self._ticks - len(self._halves) * self._orbit / 2.0, self._orbit / 2.0
        for number, mean in enumerate(self._halves):
            begin, end = (round(past + place * half) - first for place in (number, number + 1))
            mean.take(error[max(0, begin) : max(0, end)])

        half_ticks = round(self._orbit / 2.0)
        while self._course_end < first + len(error):
            begin = self._course_end - first
            place, inside = divmod(self._course_end, half_ticks)
            if place == len(self._course):
                self._course.append(Mean())
            end = min(len(error), begin + half_ticks - inside)
            self._course[place].take(error[begin:end])
            self._course_end = first + end

    def _take_mode(self, first: int, mode: NDArray[np.integer]) -> None:
        """Note each mode and the tick in which it begins."""
        before = self._mode[-1][1] if self._mode else -1
        changes = np.flatnonzero(np.diff(mode, prepend=before))
        self._mode += [(first + int(place), int(mode[place])) for place in changes]

    def _fell_back(self) -> Iterator[tuple[Mode, float, float]]:
        ends = [*(tick for tick, _ in self._mode[1:]), self._taken]
        best = Mode.SAFE
        for (tick, mode), end in zip(self._mode, ends, strict=True):
            best = max(best, Mode(mode))
            if mode <= Mode.DETUMBLE < best:
                yield Mode(mode), tick / self._orbit, (end - tick) / self._orbit

    def _take_rate(self, first: int, rate_degps: Array, recent: slice) -> None:
        if first == 0:
            self._rate_at_start = float(rate_degps[0])
        self._rate.take(rate_degps[recent])
        fast = np.flatnonzero(rate_degps >= self._slow_degps)
        if len(fast):
            self._slow_from = first + int(fast[-1]) + 1

    def _take_shadow(self, first: int, truth: Histories, estimates: Estimates) -> None:
        if self._scenario.knowledge != "filter" or "valid" not in self._first:
            return
        rows = len(truth["t_s"])
        dark = (truth["lit"] < 0.5) & (first + np.arange(rows) >= self._first["valid"])
        variances = np.diagonal(estimates.covariance[:rows, :3, :3], axis1=1, axis2=2)
        certain = np.max(variances, axis=1) <= self._usable_rad**2
        self._dark += int(dark.sum())
        self._unsure_dark += int((dark & ~certain).sum())
        known = dark & np.isfinite(estimates.q_body_from_orbit[:rows]).all(axis=1)
        error_deg = np.degrees(magnitudes(knowledge_errors(truth, estimates)[known]))
        halves = ((first + np.flatnonzero(known)) * 2.0 / self._orbit).astype(int)
        self._dark_squares += np.bincount(halves, error_deg**2, len(self._dark_squares))
        self._dark_ticks += np.bincount(halves, minlength=len(self._dark_ticks))

    def _take_estimate(self, truth: Histories, estimates: Estimates, recent: slice) -> None:
        valid = estimates.valid[: len(truth["t_s"])].copy()
        valid[: recent.start] = False
        self._valid += int(valid.sum())
        self._estimate.take(np.degrees(magnitudes(knowledge_errors(truth, estimates)[valid])))
        if self._scenario.knowledge == "filter":
            self._inside += int(within_3sigma(truth, estimates)[valid].all(axis=1).sum())
        else:
            self._inside += int(valid.sum())

    def _note(self, name: str, first: int, holds: NDArray[np.bool_]) -> None:
        if name not in self._first and holds.any():
            self._first[name] = first + int(holds.argmax())

    def _since(self, name: str) -> float | None:
        return self._first[name] / self._orbit if name in self._first else None


def _disturbance(scenario: Scenario, truth: Histories) -> Array:
    """The sum over the block of the disturbance torques: the plant's, or those that the scenario states."""
    named = {name.partition("/")[2]: history for name, history in truth.items() if "/" in name}
    if not named:
        return len(truth["t_s"]) * np.array(scenario.disturbance.torque_nm)
    found: Array = np.zeros(3)
    for name, torque in named.items():
        if name not in NOT_DISTURBANCES:
            found = found + torque.sum(axis=0)
    return found


def _saturated(scenario: Scenario, truth: Histories) -> NDArray[np.bool_]:
    """Ticks in which a continuous driver gives all it can; none for a pulsed one."""
    coils = scenario.coils
    if coils.driver != "continuous":
        return np.zeros(len(truth["t_s"]), dtype=bool)
    full_scale_am2 = coils.on_fraction * coils.largest_am2
    given_am2 = np.abs(nominal_dipole_am2(scenario, truth["m_body_am2"])).max(axis=1)
    result: NDArray[np.bool_] = given_am2 > 0.98 * full_scale_am2
    return result
