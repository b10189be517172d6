"""Judges a flight by the requirements of its scenario, in one pass over its histories."""

from collections.abc import Mapping
from enum import StrEnum
from typing import Any

from sim.audit.findings import AuditReport
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.requirements.causes import reasons
from sim.report.requirements.evidence import EvidenceGatherer, Missed
from sim.report.requirements.gather import Gathered
from sim.report.requirements.words import number, orbits
from sim.scenario.requirements import DEG, INDICES, OF, ORBITS
from sim.scenario.schema import Scenario
from sim.statistics.settling import HELD_S

Json = dict[str, Any]


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
    """

    def __init__(self, scenario: Scenario, ticks: int) -> None:
        self._scenario = scenario
        self._gathered = [Gathered(section, scenario, ticks) for section in scenario.requirement]
        judged = {one.what for one in self._gathered if one.judged}
        self._evidence = {what: EvidenceGatherer(scenario, what, ticks) for what in sorted(judged)}

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
            outcomes.append(_stated(one) | outcome | {"text": f"{_name(one)}{outcome['text']}"})
        return outcomes

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


def _name(one: Gathered) -> str:
    row = INDICES[one.section.index]
    of = f" of {OF[one.what]}" if row.of else ""
    return f"{row.words}{of}"


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
