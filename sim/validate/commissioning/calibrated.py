"""Claims on calibration: random satellites, calibrated by an orbit of pulses, and flown by what was found."""

from collections.abc import Sequence
from functools import partial
from math import nan
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from fsw.input.schema import Nested, merge
from fsw.table.table import FlightTable
from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.commissioning.calibrate.flown.run_fit import RunCalibration, calibrated
from sim.commissioning.calibrate.flown.samples import Samples, read_samples
from sim.commissioning.calibrate.flown.tables import tables
from sim.errors import HarnessError
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.pace import Pace
from sim.record.truth import read_truth
from sim.scenario.assemble import plant_config
from sim.scenario.residual_errors import reading_of
from sim.scenario.schema import Scenario, flight_table, load
from sim.validate.commissioning.wirings import SCENARIO, satellite
from sim.value_types import Array

SATELLITES = 30
ORBIT_TICKS = 6040
POINTING_ORBITS, COUNTED_ORBITS = 12, 10
"""By chance the ratio of one orbit varies by a tenth, that of ten orbits by a third of it."""
POINTED = {"initial": {"angle_deg": 12.0, "axis": [1.0, 1.0, -0.5], "rate_degps": [0.02, -0.01, 0.02]}}
SOURCE = "Offset to 60 uT, scale 5 %, non-orthogonality 2 deg, coil field 20 uT, delay 0 to 2 ticks"
INSIDE = "Part of the true values inside 3 sigma: offset, matrix, coils' field, delay, all satellites"
BESIDE = (
    f"RMS pointing error of the last {COUNTED_ORBITS} of {POINTING_ORBITS} orbits over that with the true "
    "calibration, all"
)
MOST_WORSE = 1.10


VALUES = 22
"""Of a satellite: matrix, offset, coils' field, delay."""


class Flown(NamedTuple):
    """One satellite: errors in standard deviations, pointing error by what was found and by the truth.

    Where its log does not tell a calibration, ``reason`` says why, and nothing else is a number.
    """

    number: int
    off: tuple[float, ...]
    found_deg: float
    perfect_deg: float
    reason: str = ""


class TrueCalibration(NamedTuple):
    """Of the plant: body from channels, offset, coils' field by output, delay."""

    matrix: Array
    offset_nt: Array
    field_nt_per_am2: Array
    delay_s: float


def true_calibration(scenario: Scenario) -> TrueCalibration:
    """What a perfect calibration finds."""
    section = scenario.sensors.magnetometer
    sensed, offset_t = reading_of(plant_config(scenario, 1).magnetometer)
    return TrueCalibration(
        np.asarray(np.linalg.inv(sensed), float),
        1e9 * offset_t,
        np.array(section.coil_field_nt_per_am2),
        section.latency_s,
    )


def errors(found: RunCalibration, true: TrueCalibration, tick_s: float) -> tuple[float, ...]:
    """Found less true, in standard deviations.

    Raises:
        HarnessError: the delay was not found.
    """
    sigma = np.sqrt(found.field.covariance.diagonal())
    late, late_sigma = found.response.delay_ticks, found.response.delay_sigma
    if late is None or late_sigma is None:
        raise HarnessError("the log does not tell the delay of the magnetometer")
    parts = [
        (found.field.matrix - true.matrix).ravel() / sigma[:9],
        (found.field.offset_nt - true.offset_nt) / sigma[9:],
        ((found.field_nt_per_am2 - true.field_nt_per_am2) / found.field_sigma).ravel(),
        np.array([(late * tick_s - true.delay_s) / (late_sigma * tick_s)]),
    ]
    return tuple(np.concatenate(parts).tolist())


def flown(number: int) -> Flown:
    """Tumble for an orbit with pulses, calibrate, and point by what was found and by the truth."""
    settings = satellite(number)
    tumbling = load(SCENARIO, merge(settings, {"control": {"law": "phasing"}}))
    with TemporaryDirectory() as scratch:
        log = _fly(Path(scratch) / "tumbling", tumbling, number, ORBIT_TICKS) / run_dir.BUS_LOG
        samples, true = read_samples(log, tumbling.time.tick_hz), true_calibration(tumbling)
        try:
            off, given = determined_values(samples, flight_table(tumbling), true, 1.0 / tumbling.time.tick_hz)
        except HarnessError as error:
            return Flown(number, (nan,) * VALUES, nan, nan, str(error))
        found_deg, perfect_deg = (
            _pointing_deg(Path(scratch) / name, merge(merge(settings, POINTED), {"flight": values}), number)
            for name, values in (("found", given), ("perfect", merge(given, _as_table(true))))
        )
    return Flown(number, off, found_deg, perfect_deg)


def determined_values(
    samples: Samples, table: FlightTable, true: TrueCalibration, tick_s: float
) -> tuple[tuple[float, ...], Nested]:
    """What a log tells: the errors of the values found, in standard deviations, and the tables.

    Raises:
        HarnessError: it does not tell a calibration by which a satellite may fly.
    """
    found = calibrated(samples, table)
    return errors(found, true, tick_s), tables(found, table)


def _as_table(true: TrueCalibration) -> Nested:
    coils = {"field_nt_per_am2": true.field_nt_per_am2.tolist(), "field_delay_s": true.delay_s}
    magnetometer = {"offset_nt": true.offset_nt.tolist(), "matrix": true.matrix.tolist()}
    return {"calibration": {"magnetometer": magnetometer, "coils": coils}}


def _fly(folder: Path, scenario: Scenario, seed: int, ticks: int) -> Path:
    run_dir.begin(folder, scenario, seed, ticks, "virtual", Pace())
    fly_virtual(folder, scenario, lambda tick: None)
    return folder


def _pointing_deg(folder: Path, settings: Nested, seed: int) -> float:
    """RMS of the angle from the orbital frame over the orbits that count."""
    path = _fly(folder, load(SCENARIO, settings), seed, POINTING_ORBITS * ORBIT_TICKS)
    q0 = np.abs(read_truth(path / run_dir.TRUTH)["q_body_from_orbit"][-COUNTED_ORBITS * ORBIT_TICKS :, 0])
    angle_deg = np.degrees(2.0 * np.arccos(np.clip(q0, 0.0, 1.0)))
    return float(np.sqrt(np.mean(angle_deg**2)))


def studies(most: int | None = None) -> list[Study]:
    """All of them, of at most so many satellites."""
    count = SATELLITES if most is None else min(SATELLITES, most)
    tasks = tuple(partial(flown, number) for number in range(1, 1 + count))
    return [Study("calibration", tasks, conclude, has_flights=True)]


def conclude(flights: Sequence[Any]) -> list[ClaimOutcome]:
    """The values are right within their uncertainty, and good enough to fly by; all satellites tell them."""
    inside = Claim("calibration.inside", INSIDE, SOURCE, "1", low=0.95)
    beside = Claim("calibration.pointing", BESIDE, SOURCE, "1", high=MOST_WORSE)
    if untold := [f"satellite {one.number}: {one.reason}" for one in flights if one.reason]:
        return [claim.judge(nan, "; ".join(untold)) for claim in (inside, beside)]
    off = np.abs(np.array([one.off for one in flights]))
    worst = flights[int(np.argmax(off.max(axis=1)))]
    largest = f"worst: satellite {worst.number}: {off.max():.1f} sigma"
    part = nan if np.isnan(off).any() else float(np.mean(off < 3.0))
    ratios = np.array([one.found_deg / one.perfect_deg for one in flights])
    where = f"worst: satellite {flights[int(np.argmax(ratios))].number}; median {np.median(ratios):.3f}"
    return [inside.judge(part, largest), beside.judge(float(np.max(ratios)), where)]
