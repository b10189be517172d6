"""Judges a flight by the requirements of its scenario, in one pass over its histories."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from sim.audit.findings import AuditReport
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.figures.coil_effort import dipole_squared_a2m4s, driven_s
from sim.report.figures.controlled import error_vectors
from sim.report.figures.estimate_error import knowledge_errors
from sim.report.figures.mean import Mean
from sim.report.requirements.causes import reasons
from sim.report.requirements.diagnosis import diagnose
from sim.report.requirements.evidence import EvidenceGatherer, Missed
from sim.report.requirements.words import number, orbits
from sim.scenario.controlled import controlled
from sim.scenario.requirements import DEG, INDICES, ORBITS, RequirementSection, in_words
from sim.scenario.schema import Scenario, orbit_period_s
from sim.statistics.indices import Windows, magnitudes
from sim.statistics.settling import HELD_S, Settling, held_ticks
from sim.value_types import Array, Json

# --- Gathers one index over the window of a requirement, block by block, in constant memory

# --- The number that is limited, of the values of an index over a window


LEAST, MOST, STEP = 1e-7, 1e4, 1.005
"""Range and ratio of the steps in which a percentile is found; it is rounded up to the next."""
EDGES = np.geomspace(LEAST, MOST, 1 + round(np.log(MOST / LEAST) / np.log(STEP)))


@dataclass(slots=True)
class Statistic:
    """Root mean square, or what a fraction of the values does not exceed, in constant memory.

    Attributes:
        probability: that fraction; None: the root mean square.
    """

    probability: float | None
    mean: Mean = field(default_factory=Mean)
    counts: NDArray[np.int64] = field(default_factory=lambda: np.zeros(len(EDGES) + 1, np.int64))

    def take(self, values: Array) -> None:
        """Take further values."""
        self.mean.take(values)
        if self.probability is not None:
            self.counts += np.bincount(np.searchsorted(EDGES, values), minlength=len(EDGES) + 1)

    @property
    def value(self) -> float | None:
        """None if there are no values."""
        if not self.mean.count:
            return None
        if self.probability is None:
            return self.mean.rms
        needed = int(np.ceil(self.probability * self.mean.count))
        place = int(np.searchsorted(np.cumsum(self.counts), needed))
        return min(float(EDGES[min(place, len(EDGES) - 1)]), self.mean.most)

    @property
    def words(self) -> str:
        """What it is, in words."""
        if self.probability is None:
            return "RMS"
        return (
            "at all times" if self.probability == 1.0 else f"for {100.0 * self.probability:g} % of the time"
        )


class Gathered:
    """The values of an index over its window.

    Args:
        section: the requirement.
        scenario: of the flight.
        ticks: of the whole flight.
    """

    def __init__(self, section: RequirementSection, scenario: Scenario, ticks: int) -> None:
        self.section = section
        self.what = section.what or pointed(scenario)
        self.ticks_per_orbit = orbit_period_s(scenario) * scenario.time.tick_hz
        self.ticks = ticks
        self.judged = ticks + 1 > section.by_orbit * self.ticks_per_orbit
        """Whether the flight is long enough, to within a tick."""
        self.driven_s = 0.0
        self.dipole_squared_a2m4s = 0.0
        """Of a continuous driver, over the window."""
        self.statistic = Statistic(section.probability)
        self._scenario = scenario
        self._settling = Settling(held_ticks(scenario.time.tick_hz))
        self._windows = self._new_windows()

    @property
    def threshold(self) -> float:
        """Below which what is controlled has settled."""
        return self.section.settled_degps if self.what == "spin" else self.section.settled_deg

    @property
    def settled_at(self) -> int | None:
        """Tick at which what is controlled has settled; None: it has not."""
        return self._settling.tick

    @property
    def long_enough_to_settle(self) -> bool:
        """False where settling is asked for, and the flight is too short to show it."""
        asked = self.section.index == "settling" or self.section.window == "settled"
        return not asked or self.ticks >= self._settling.held_ticks

    @property
    def window_from(self) -> int:
        """The first tick of the window."""
        if self.section.window == "settled":
            return self._settling.since
        return max(0, self.ticks - round(self.section.last_orbits * self.ticks_per_orbit))

    @property
    def flown_orbits(self) -> float:
        """The length of the flight."""
        return self.ticks / self.ticks_per_orbit

    @property
    def window_orbits(self) -> float:
        """The length of the window."""
        return (self.ticks - self.window_from) / self.ticks_per_orbit

    def take(self, truth: Histories, estimates: Estimates) -> None:
        """The next block."""
        first, rows = self._settling.taken, len(truth["t_s"])
        error = error_vectors(self.what, truth, self._scenario)
        broken = self._settling.take(magnitudes(error) < self.threshold)
        if broken and self.section.window == "settled":
            self.statistic = Statistic(self.section.probability)
            self._windows = self._new_windows()
        since = max(0, self.window_from - first)
        if since < rows:
            self._take(truth, estimates, error, slice(since, rows))

    def value(self) -> float | None:
        """The statistic of the index over the window, once all blocks are taken; None where it is empty."""
        if self.section.index in ("mpe", "rpe"):
            self._take_means(self._windows.rest())
            self._windows = self._new_windows()
        return self.statistic.value

    def _new_windows(self) -> Windows:
        return Windows(max(1, round(self.section.average_s * self._scenario.time.tick_hz)))

    def _take(self, truth: Histories, estimates: Estimates, error: Array, rows: slice) -> None:
        index = self.section.index
        if index in ("duty", "energy"):
            if self._scenario.coils.driver != "continuous":
                return
            dipole_am2 = truth["m_body_am2"][rows]
            self.driven_s += driven_s(self._scenario, dipole_am2)
            self.dipole_squared_a2m4s += dipole_squared_a2m4s(self._scenario, dipole_am2)
            return
        if index == "settling":
            return
        if index in ("mpe", "rpe"):
            self._take_means(self._windows.take(error[rows]))
            return
        if index == "ake":
            error = np.degrees(knowledge_errors(truth, estimates))
        elif index == "rate":
            error = error_vectors("rate", truth, self._scenario)
        values = magnitudes(error[rows])
        self.statistic.take(values[truth["lit"][rows] > 0.5] if self.section.sunlit else values)

    def _take_means(self, found: tuple[Array, Array]) -> None:
        """What is limited of MPE and RPE of further windows."""
        mean, relative = found
        self.statistic.take(mean if self.section.index == "mpe" else relative)


def pointed(scenario: Scenario) -> str:
    """What a requirement refers to where it does not say so."""
    what = controlled(scenario).what
    return "attitude" if what == "rate" else what


class Outcome(StrEnum):
    """The outcome of a requirement."""

    MET = "met"
    FAILED = "failed"
    NOT_JUDGED = "not judged"


class Judgement:
    """The judgement of a flight.

    Args:
        scenario: that was flown.
        ticks: of the whole flight.
        own_software: it was flown by the flight software of this project.
    """

    def __init__(self, scenario: Scenario, ticks: int, own_software: bool = True) -> None:
        self._scenario = scenario
        self._gathered = [Gathered(section, scenario, ticks) for section in scenario.requirement]
        self._controlled = controlled(scenario)
        judged = {one.what for one in self._gathered if one.judged} | {self._controlled.what}
        self._evidence = {
            what: EvidenceGatherer(scenario, what, ticks, own_software) for what in sorted(judged)
        }

    def take(self, truth: Histories, estimates: Estimates) -> None:
        """The next block; not an empty one."""
        for gathered in self._gathered:
            gathered.take(truth, estimates)
        for evidence in self._evidence.values():
            evidence.take(truth, estimates)

    def outcomes(self, audit: AuditReport, isolated_s: Mapping[str, float], ended: bool = True) -> list[Json]:
        """Each requirement with what was measured, in their order.

        Args:
            audit: of the log, with the pulses.
            isolated_s: the units out of use at the end, and when they were isolated, s.
            ended: whether the flight came to its end; one that was cut short is not judged.
        """
        outcomes = []
        for one in self._gathered:
            if not ended:
                outcome = _not_judged("the flight did not come to its end")
            elif not one.judged:
                outcome = _not_judged(
                    f"judged by orbit {one.section.by_orbit:g}, flown were {orbits(one.flown_orbits)}"
                )
            elif not one.long_enough_to_settle:
                flown_s = one.ticks / self._scenario.time.tick_hz
                outcome = _not_judged(
                    f"settled is what stays under its threshold for {HELD_S:g} s, flown were {flown_s:g} s"
                )
            else:
                outcome = self._judged(one, audit, isolated_s)
            outcomes.append(
                _stated(one)
                | outcome
                | {"text": f"{in_words(one.section.index, one.what, one.section.id)}{outcome['text']}"}
            )
        return outcomes

    def diagnosis(
        self, settled_orbits: float | None, audit: AuditReport, isolated_s: Mapping[str, float]
    ) -> Json:
        """What the flight shows of its satellite, whatever is required of it.

        Args:
            settled_orbits: since when what is controlled has settled; None: it has not.
            audit: as for ``outcomes``.
            isolated_s: as for ``outcomes``.
        """
        evidence = self._evidence[self._controlled.what].evidence(audit, isolated_s)
        return diagnose(self._controlled, settled_orbits, evidence)

    def _judged(self, one: Gathered, audit: AuditReport, isolated_s: Mapping[str, float]) -> Json:
        section = one.section
        measured, text = _measured(one, self._scenario, audit)
        if measured is not None and measured <= section.limit:
            return {"measured": measured, "verdict": Outcome.MET.value, "text": f" {text}", "reasons": []}
        limits = {DEG: section.limit, ORBITS: one.threshold}
        evidence = self._evidence[one.what].evidence(audit, isolated_s)
        settled = _settled_orbits(one)
        found = reasons(Missed(section.index, one.what, limits.get(section.unit), settled), evidence)
        return {
            "measured": measured,
            "verdict": Outcome.FAILED.value,
            "text": f" {text}",
            "reasons": [reason._asdict() for reason in found],
        }


def _stated(one: Gathered) -> Json:
    """What is required."""
    section = one.section
    return {
        "id": section.id,
        "index": section.index,
        "what": one.what if INDICES[section.index].of else None,
        "limit": section.limit,
        "unit": section.unit.symbol,
        "window": _window(one),
        "by_orbit": section.by_orbit,
    }


def _not_judged(why: str) -> Json:
    return {"measured": None, "verdict": Outcome.NOT_JUDGED.value, "text": f": {why}", "reasons": []}


def _measured(one: Gathered, scenario: Scenario, audit: AuditReport) -> tuple[float | None, str]:
    """The figure that is limited, and a clause that says so; None where what is controlled never settled."""
    section = one.section
    limit = f"at most {section.limit:g} {section.unit.symbol}"
    under = f"{one.threshold:g} {'deg/s' if one.what == 'spin' else 'deg'}"
    if section.index == "settling":
        value = _settled_orbits(one)
        if value is None:
            return None, f"not under {under} for the last {HELD_S:g} s, {limit}"
        return value, f"under {under} from {orbits(value)} on, {limit}"
    settled = _settled_orbits(one)
    if section.window == "settled" and (settled is None or settled > section.by_orbit):
        but = f"nor for the last {HELD_S:g} s" if settled is None else f"but from {orbits(settled)} on"
        return None, f"not settled, under {under}, by orbit {section.by_orbit:g}, {but}; {limit}"
    value = _of_coils(one, scenario, audit) if section.index in ("duty", "energy") else one.value()
    if value is None:
        return None, f"has no value over {_window(one)}, {limit}"
    statistic = "" if section.index in ("duty", "energy") else f" {one.statistic.words}"
    shown = number(value)
    if value > section.limit and float(shown) <= section.limit:
        shown = f"{value:.7g}"
    return value, f"{shown} {section.unit.symbol}{statistic} over {_window(one)}, {limit}"


def _settled_orbits(one: Gathered) -> float | None:
    return None if one.settled_at is None else one.settled_at / one.ticks_per_orbit


def _of_coils(one: Gathered, scenario: Scenario, audit: AuditReport) -> float:
    """Duty of all coils together, %, or energy dissipated in them, J, over the window."""
    coils, hz = scenario.coils, scenario.time.tick_hz
    begin_s, length_s = one.window_from / hz, (one.ticks - one.window_from) / hz
    if coils.driver == "continuous":
        driven_s, squared = one.driven_s, one.dipole_squared_a2m4s
    else:
        inside = [
            (abs(pulse.level), max(0.0, float(pulse.end_s) - max(begin_s, float(pulse.start_s))))
            for pulse in audit.pulses
        ]
        driven_s = sum(seconds for _, seconds in inside)
        squared = sum(coils.levels_am2[min(level, 3) - 1] ** 2 * seconds for level, seconds in inside)
    if one.section.index == "duty":
        return 100.0 * driven_s / length_s
    return squared * (coils.resistance_ohm or 0.0) / coils.dipole_per_ampere_am2**2


def _window(one: Gathered) -> str:
    section = one.section
    if section.index == "settling":
        return "the flight"
    if section.window == "settled":
        window = (
            "the time from settling on"
            if one.settled_at is None
            else f"{orbits(one.window_orbits)} from settling on"
        )
    elif one.window_from == 0:
        window = f"the whole flight of {orbits(one.window_orbits)}"
    else:
        window = "the last orbit" if section.last_orbits == 1.0 else f"the last {orbits(section.last_orbits)}"
    return f"{window}, in sunlight" if section.sunlit else window
