"""The tables that a calibration gives the onboard table: [calibration] and [uncertainty]."""

from math import ceil, degrees, hypot
from typing import Any

import numpy as np

from fsw.table.estimator import table_bounds
from fsw.table.table import FlightTable
from sim.commissioning.calibrate.flown.run_fit import RunCalibration
from sim.commissioning.calibrate.flown.verdicts import (
    SIGMAS,
    are_coils,
    offset_sigma_nt,
    part_sigma,
    turn_sigma_rad,
)
from sim.commissioning.calibrate.flown.wiring import RIGHT
from sim.errors import HarnessError
from sim.value_types import Array, Json

LEAST_BIAS_NT, LEAST_SCALE_PERCENT, LEAST_TURN_DEG = 100.0, 0.05, 0.02
"""What moves in the days after a calibration."""
MOST_BIAS_NT, MOST_PERCENT, MOST_DEG = 3000.0, 10.0, 10.0
"""That the onboard table takes."""
LONGEST_S = 3.0


def tables(found: RunCalibration, table: FlightTable) -> Json:
    """Both tables, as values.

    The coils' dipoles are given only where they are known better than the table says, or are others.

    Raises:
        HarnessError: the magnetometer is not known so well that a satellite may fly by it, or is too late.
    """
    known = table_bounds(table)
    bias_nt = _up(max(LEAST_BIAS_NT, SIGMAS * float(offset_sigma_nt(found).max())), 0)
    percent = _up(max(LEAST_SCALE_PERCENT, 100.0 * SIGMAS * float(part_sigma(found).max())), 2)
    turn_deg = hypot(SIGMAS * degrees(float(turn_sigma_rad(found).max())), degrees(known.sun_turn_rad))
    if bias_nt > MOST_BIAS_NT or percent > MOST_PERCENT or turn_deg > MOST_DEG:
        raise HarnessError(
            f"no table is written: the offset is known within {bias_nt:.0f} nT, the matrix within "
            f"{percent:.1f} %; a satellite flies by at most {MOST_BIAS_NT:.0f} nT and {MOST_PERCENT:.0f} %"
        )
    uncertainty = {
        "magnetometer_bias_nt": bias_nt,
        "magnetometer_scale_percent": percent,
        "magnetometer_misalignment_deg": _up(max(LEAST_TURN_DEG, turn_deg), 3),
    }
    calibration: Json = {
        "magnetometer": {
            "offset_nt": _rounded(found.field.offset_nt, 1),
            "matrix": _rounded(found.field.matrix, 7),
        }
    }
    if table.calibration.magnetometer is not None and table.calibration.magnetometer.range_nt is not None:
        calibration["magnetometer"]["range_nt"] = table.calibration.magnetometer.range_nt
    coils = _coils(found, 1.0 / table.time.tick_hz)
    late, sigma = found.response.delay_ticks, found.response.delay_sigma
    if late is not None and sigma is not None:
        oldest_s = _up((late + SIGMAS * sigma) / table.time.tick_hz, 3)
        if oldest_s > LONGEST_S:
            raise HarnessError(
                f"no table is written: a sample of the field is up to {oldest_s:.2f} s old; a satellite "
                f"flies by at most {LONGEST_S:.0f} s"
            )
        uncertainty["latency_s"] = oldest_s
    dipoles, within = _dipoles(found, known.coil_gain_part)
    if dipoles is not None:
        coils["matrix"] = _rounded(dipoles, 4)
        uncertainty["coil_gain_percent"] = _up(100.0 * within, 1)
        uncertainty["coil_misalignment_deg"] = _up(degrees(within), 2)
    if coils:
        calibration["coils"] = coils
    return {"calibration": calibration, "uncertainty": uncertainty}


def _coils(found: RunCalibration, tick_s: float) -> Json:
    response = found.response
    if response.delay_ticks is None or not min(response.pulses):
        return {}
    return {
        "field_nt_per_am2": _rounded(found.field_nt_per_am2, 1),
        "field_delay_s": round(response.delay_ticks * tick_s, 4),
    }


def _dipoles(found: RunCalibration, declared: float) -> tuple[Array | None, float]:
    """The coils' dipoles, if they are worth a place in the table, and how well they are known."""
    if found.coils is None or not are_coils(found.coils.matrix):
        return None, 0.0
    within = SIGMAS * float(np.sqrt(found.coils.covariance.diagonal().max()))
    nearest = np.argmax(np.abs(found.coils.matrix), axis=0)
    wired = tuple((np.sign(found.coils.matrix[nearest, range(3)]) * (nearest + 1)).astype(int).tolist())
    worth = wired != RIGHT or within < declared
    return (found.coils.matrix, within) if worth and within < 0.3 else (None, within)


def _up(value: float, digits: int) -> float:
    """Rounded up."""
    return ceil(value * 10.0**digits) / 10.0**digits


def _rounded(values: Array, digits: int) -> list[Any]:
    rounded: list[Any] = np.round(values, digits).tolist()
    return rounded
