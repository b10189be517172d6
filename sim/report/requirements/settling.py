"""Why a flight settled late: causes from its course, in addition to those of ``causes.py``."""

from math import log

import numpy as np

from sim.report.requirements.evidence import FlightEvidence, Missed
from sim.report.requirements.words import number, orbits, part

MOST_TOLD = 3
FALLS = 0.9
"""An error falls if it is at most this fraction of itself an orbit earlier."""


def fell_back(missed: Missed, evidence: FlightEvidence) -> str:
    """The controller went back to damp rates, or to SAFE, after it had known the attitude."""
    told = [
        f"{mode.name} from {orbits(at)} on for {orbits(length)}" for mode, at, length in evidence.fell_back
    ]
    more = f" and {len(told) - MOST_TOLD} times more" if len(told) > MOST_TOLD else ""
    return f"the controller fell back to {', to '.join(told[:MOST_TOLD])}{more}" if told else ""


def left_again(missed: Missed, evidence: FlightEvidence) -> str:
    """The error had been small, and grew again."""
    under = [place for place, error in enumerate(evidence.course) if missed.limit and error < missed.limit]
    if missed.limit is None or not under:
        return ""
    worst = max(range(under[0], len(evidence.course)), key=lambda place: evidence.course[place])
    if evidence.course[worst] < missed.limit:
        return ""
    unit = _unit(missed)
    return (
        f"it was under {number(missed.limit)} {unit} at {orbits(under[0] / 2.0)} and left it again: "
        f"{number(evidence.course[worst])} {unit} RMS in the half orbit from {orbits(worst / 2.0)} on"
    )


def slow(missed: Missed, evidence: FlightEvidence) -> str:
    """It settled, with an error that fell all the way."""
    if missed.settled is None or missed.limit is None:
        return ""
    way = evidence.course[: int(2.0 * missed.settled) + 1]
    if len(way) < 2 or min(way) <= 0.0:
        return ""
    factor = float(np.exp(2.0 * np.polyfit(np.arange(len(way)), np.log(way), 1)[0]))
    if factor > FALLS:
        return ""
    return (
        f"slow: from {number(way[0])} {_unit(missed)} RMS in the first half orbit the error fell to "
        f"{part(factor)} of itself an orbit, and so to {number(missed.limit)} at {orbits(missed.settled)}"
    )


def swings(missed: Missed, evidence: FlightEvidence) -> str:
    """It does not settle, and the error no longer falls."""
    trend = evidence.trend
    if missed.settled is not None or missed.limit is None or len(trend) < 3 or min(trend) <= 0.0:
        return ""
    slope = float(np.polyfit(np.arange(len(trend)) / 2.0, np.log(trend), 1)[0])
    if trend[-1] > missed.limit and slope <= log(FALLS):
        return ""
    span = f"{number(min(trend))} to {number(max(trend))} {_unit(missed)} RMS"
    return (
        f"the error falls no longer: {span} in each of the last {len(trend)} half orbits, "
        f"and more than {number(missed.limit)} at times"
    )


def _unit(missed: Missed) -> str:
    return "deg/s" if missed.what == "spin" else "deg"
