"""The result of a flight of a comparison: its line of the table, and its history for the picture."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fsw.core.laws.entry import Aim
from fsw.input.schema import TableError
from fsw.wire.messages import Mode
from sim.campaign.flight import RecordedFlight, record_order
from sim.compare.case import ComparisonCase, Driver
from sim.drawing.canvas import TimeAxis
from sim.errors import HarnessError
from sim.record.truth import Histories
from sim.report.charts.drawn_flight import whole_flight
from sim.report.figures.coil_effort import dipole_squared_a2m4s, driven_s
from sim.report.figures.controlled import error_vectors
from sim.report.figures.histories import FlightHistories
from sim.scenario.controlled import Controlled
from sim.scenario.schema import Scenario, orbit_period_s
from sim.statistics.settling import settled_tick, spans
from sim.value_types import Array

POINTS_AN_ORBIT = 60
MOST_POINTS = 1200
WINDOW_ORBITS = 0.25


@dataclass(frozen=True, slots=True)
class Score:
    """A line of the table; its fields are the columns of the files.

    Attributes:
        law: its name.
        aim: of the law.
        driver: of the coils.
        settle_orbits: when the error of what they are judged by has settled; None: never.
        error_rms: of that error over the last orbit, deg or deg/s.
        error_max: its largest.
        rate_rms_degps: rate relative to the orbital frame, less the spin reference, over the last orbit.
        dipole_squared_a2m4s: integral over the flight of |m|^2, m what the currents nominally give; times
            resistance over (dipole an ampere)^2 it is the energy lost in the coils.
        pulses: None for a continuous driver, which has none.
        duty: fraction of time for which any coil was driven.
        mode_final: of the controller.
        limits_ok: whether the coil driver kept its limits.
        failure: why there was no flight, then all figures are None; else empty.
        tuned: whether it flew with the best gains that were found, not with the scenario's.
    """

    law: str
    aim: Aim
    driver: Driver
    settle_orbits: float | None = None
    error_rms: float | None = None
    error_max: float | None = None
    rate_rms_degps: float | None = None
    dipole_squared_a2m4s: float | None = None
    pulses: int | None = None
    duty: float | None = None
    mode_final: str | None = None
    limits_ok: bool | None = None
    failure: str = ""
    tuned: bool = False


class History(NamedTuple):
    """The running root mean square of the error of what a flight is judged by, on its time axis."""

    time: TimeAxis
    t_s: Array
    error: Array


class Result(NamedTuple):
    """The result of a case; no history without a flight."""

    score: Score
    history: History | None


def fly_case(case: ComparisonCase, by: Controlled) -> Result:
    """Fly and judge. A law that cannot fly on this scenario has a line that says so."""
    try:
        record = record_order(case.order)
    except (TableError, HarnessError) as error:
        return Result(Score(case.law, case.aim, case.driver, failure=str(error), tuned=case.tuned), None)
    return Result(judge(case, record, by), history(record, by))


def judge(case: ComparisonCase, record: RecordedFlight, by: Controlled) -> Score:
    """The line of a flight, from the plant's truth and the audit."""
    scenario, truth, audit = record.scenario, record.truth, record.audit
    tick_hz, orbit_s = scenario.time.tick_hz, orbit_period_s(scenario)
    error = error_of(record, by)
    last_orbit = slice(-round(orbit_s * tick_hz), None)
    settled = settled_tick(error < by.threshold, tick_hz, orbit_s)
    continuous = case.driver is Driver.CONTINUOUS
    return Score(
        law=case.law,
        aim=case.aim,
        driver=case.driver,
        settle_orbits=None if settled is None else settled / tick_hz / orbit_s,
        error_rms=_rms(error[last_orbit]),
        error_max=float(error[last_orbit].max()),
        rate_rms_degps=_rms(_rate_error_degps(scenario, truth)[last_orbit]),
        dipole_squared_a2m4s=dipole_squared_a2m4s(scenario, truth["m_body_am2"]),
        pulses=None if continuous else len(audit.pulses),
        duty=driven_s(scenario, truth["m_body_am2"]) / (len(error) / tick_hz)
        if continuous
        else float(audit.duty_total),
        mode_final=Mode(int(record.estimates.mode[len(error) - 1])).name,
        limits_ok=audit.ok,
        tuned=case.tuned,
    )


def history(record: RecordedFlight, by: Controlled) -> History:
    """The running root mean square of the error, sixty points an orbit, fewer in a long flight.

    The window of a quarter of an orbit takes out the dips where the error passes zero.
    """
    tick_hz, orbit_s = record.scenario.time.tick_hz, orbit_period_s(record.scenario)
    flight = FlightHistories(record.truth, record.estimates)
    ticks, length_s = flight.ticks, flight.ticks / tick_hz
    points = min(ticks, MOST_POINTS, max(2, round(POINTS_AN_ORBIT * length_s / orbit_s)))
    at = np.linspace(0, ticks - 1, points).round().astype(int)
    half = round(0.5 * WINDOW_ORBITS * orbit_s * tick_hz)
    first, past = np.maximum(at - half, 0), np.minimum(at + half + 1, ticks)
    total = np.concatenate(([0.0], np.cumsum(error_of(record, by) ** 2)))
    eclipses = tuple((begin / tick_hz, end / tick_hz) for begin, end in spans(flight.dark))
    time = whole_flight(length_s, orbit_s, eclipses)
    return History(time, record.truth["t_s"][at], np.sqrt((total[past] - total[first]) / (past - first)))


def error_of(record: RecordedFlight, by: Controlled) -> Array:
    """The error of what a flight is judged by, at each tick."""
    vectors = error_vectors(by.what, record.truth, record.scenario)
    result: Array = np.linalg.norm(vectors, axis=1)
    return result


def _rate_error_degps(scenario: Scenario, truth: Histories) -> Array:
    result: Array = np.linalg.norm(error_vectors("rate", truth, scenario), axis=1)
    return result


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
