"""What a flight shows of its satellite, requirement or not: what may limit its pointing, and what does.

A finding for each thing that may: axes and gravity, coils, estimate, disturbances, time. Where what is
controlled has not settled, the causes that the flight gives evidence of.
"""

from collections.abc import Callable

import numpy as np

from sim.report.requirements.causes import reasons
from sim.report.requirements.evidence import FlightEvidence, Missed
from sim.report.requirements.sizing import balance
from sim.report.requirements.words import number, orbits, part
from sim.scenario.controlled import Controlled
from sim.sizing.gravity import gravity_on, gravity_predicate
from sim.value_types import Json


def diagnose(of: Controlled, settled: float | None, evidence: FlightEvidence) -> Json:
    """The findings in words, and the causes.

    Args:
        of: what is controlled.
        settled: since when it has settled, in orbits; None: it has not.
        evidence: of the flight. Over its last orbit the error must be small too, or it has only swung by.
    """
    last_orbit = np.sqrt(np.mean(np.square(evidence.trend[-2:]))) if evidence.trend else 0.0
    if last_orbit > of.threshold:
        settled = None
    missed = Missed("settling", of.what, of.threshold, settled)
    found = [] if settled is not None else reasons(missed, evidence)
    return {
        "findings": {name: find(of, settled, evidence) for name, find in FINDINGS.items()},
        "reasons": [reason._asdict() for reason in found],
    }


def _gravity(of: Controlled, settled: float | None, evidence: FlightEvidence) -> str:
    return f"gravity {gravity_predicate(gravity_on(evidence.scenario))}"


def _coils(of: Controlled, settled: float | None, evidence: FlightEvidence) -> str:
    coils, total = evidence.scenario.coils, sum(evidence.levels)
    if coils.driver == "continuous":
        return f"at their largest dipole for {part(evidence.saturated_part)} of the last orbit"
    if not total:
        return "no pulse in the last orbit"
    return (
        f"{total} pulses in the last orbit, {part(evidence.levels[2] / total)} of them at the highest level; "
        f"a coil may be driven for {part(coils.on_part)} of the time"
    )


def _estimate(of: Controlled, settled: float | None, evidence: FlightEvidence) -> str:
    if evidence.scenario.knowledge == "perfect":
        return "none: the attitude is known"
    if evidence.first_valid is None and not evidence.own_software:
        return "none is given on the bus"
    if evidence.first_valid is None or evidence.estimate_deg is None:
        return "never valid" if evidence.first_valid is None else "not valid in the last orbit"
    honest = evidence.within_3sigma
    inside = "" if honest is None else f", inside its 3 sigma {part(honest)} of that"
    return (
        f"valid from {orbits(evidence.first_valid)} on, and for {part(evidence.valid_part)} of the last "
        f"orbit, {number(evidence.estimate_deg)} deg RMS wrong{inside}"
    )


def _disturbances(of: Controlled, settled: float | None, evidence: FlightEvidence) -> str:
    found = balance(evidence.scenario, evidence.torque_nm, of.what)
    torque_nm = number(float(np.linalg.norm(evidence.torque_nm)))
    return (
        f"{torque_nm} N m on the mean; balancing them and the residual dipole takes {part(found.load)} of "
        "what the coils can give"
    )


def _time(of: Controlled, settled: float | None, evidence: FlightEvidence) -> str:
    flown = f"{orbits(evidence.orbits)} flown"
    if settled is not None:
        return f"{flown}, under {of.threshold:g} {of.unit} from {orbits(settled)} on"
    return f"{flown}, not settled under {of.threshold:g} {of.unit}"


Find = Callable[[Controlled, float | None, FlightEvidence], str]
FINDINGS: dict[str, Find] = {
    "axes and gravity": _gravity,
    "coils": _coils,
    "estimate": _estimate,
    "disturbances": _disturbances,
    "time": _time,
}
"""In the order in which one looks."""
