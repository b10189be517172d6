"""A satellite's calibration from its log: magnetometer, coils' field and delay, coils' dipoles.

The wiring is found first, then the delay by the edges of the pulses, then twelve numbers of the magnetometer
on smoothed samples, so that their noise does not shrink what they are multiplied by. The axes of the body are
those of the Sun sensor: what both share of a turn no sample tells.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fsw.table.calibration import MagnetometerTable, largest_field_nt
from fsw.table.estimator import field_noise_nt, sun_noise_rad
from fsw.table.table import FlightTable
from sim.commissioning.calibrate.flown.coil_axes import CoilAxes, coil_axes
from sim.commissioning.calibrate.flown.coil_field import CoilResponse, coil_response
from sim.commissioning.calibrate.flown.expected import Expected, expected
from sim.commissioning.calibrate.flown.joint_fit import FieldFit, FitPrior, FreeSamples, joint_fit
from sim.commissioning.calibrate.flown.samples import Samples, in_time, whole
from sim.commissioning.calibrate.flown.sensor_axes import sensor_axes, without_outliers
from sim.commissioning.calibrate.flown.wiring import Wiring, channels_from_body
from sim.errors import HarnessError
from sim.value_types import Array, Flags

NEAR_TICKS = 3
SMOOTHED = 5
"""Samples before and after, over which a cubic smooths."""
EVERY = 4
"""Of the smoothed samples the fit takes every so many."""
MATRIX_SIGMA, OFFSET_SIGMA_NT = 0.1, 1e5
LONGEST_LAG, LEAST_VALUES = 100, 20
"""Of the residuals by which the deviations are widened."""


@dataclass(frozen=True, slots=True)
class RunCalibration:
    """What a log tells of a satellite.

    Attributes:
        wiring: of the magnetometer.
        field: M, o and their covariance, made wider by how the residuals scatter and hang together.
        response: of the channels to the outputs.
        field_nt_per_am2, field_sigma: F by output, body axes.
        coils: true dipoles by output; None where the attitude is not known well enough.
        widened: by which factor the standard deviations of the fit were.
        tick: of the samples that were fitted.
        residual_nt: of strength and of the component along the Sun (NaN without it), by sample.
        left_out: part of the samples that were outliers.
        strongest_nt: the field of the log, and
        measurable_nt: the field that saturates no axis, whatever its direction.
    """

    wiring: Wiring
    field: FieldFit
    response: CoilResponse
    field_nt_per_am2: Array
    field_sigma: Array
    coils: CoilAxes | None
    widened: float
    tick: NDArray[np.int64]
    residual_nt: Array
    left_out: float
    strongest_nt: float
    measurable_nt: float


def calibrated(samples: Samples, table: FlightTable) -> RunCalibration:
    """The calibration that a log with pulses tells.

    Raises:
        HarnessError: no wiring of the magnetometer explains it, or several do.
    """
    response = coil_response(samples, table.coils.levels_am2)
    moved = in_time(samples, response.delay_ticks or 0.0)
    along = expected(table, moved.unix_s)
    free = moved.free(NEAR_TICKS)
    found = sensor_axes(_observed(moved, along, table, free, 1.0))
    if found.reason:
        raise HarnessError(f"the log cannot tell the magnetometer: {found.reason}")
    if len(found.candidates) > 1:
        raise HarnessError(
            f"the log cannot tell the magnetometer: {len(found.candidates)} wirings explain it alike; it "
            "needs more attitudes, in sunlight"
        )
    wiring = found.candidates[0].wiring
    smooth, taken, gain = _smoothed(moved, free)
    observed = _observed(smooth, along, table, taken, gain)
    field, kept = _robust(observed, wiring)
    widened = _widening(field)
    field = replace(field, covariance=field.covariance * widened**2)
    by_output = field.matrix @ response.nt_per_am2
    sigma = field_sigma_nt_per_am2(field, response)
    b_body_nt = (moved.field_nt - field.offset_nt) @ field.matrix.T
    coils = coil_axes(moved, b_body_nt, free, along, table) if min(response.pulses) else None
    ticks = moved.tick[taken]
    left_out = 1.0 - float(kept.mean())
    return RunCalibration(
        wiring,
        field,
        response,
        by_output,
        sigma,
        coils,
        widened,
        ticks[kept],
        field.residual_nt,
        left_out,
        float(np.linalg.norm(along.b_eci_nt, axis=1).max()),
        _measurable_nt(field, table),
    )


def field_sigma_nt_per_am2(field: FieldFit, response: CoilResponse) -> Array:
    """Standard deviations of the coils' field in body axes, F = M D: by those of D and those of M.

    A log that tells the pulses well and the magnetometer badly tells the product badly.
    """
    rows = [field.covariance[first : first + 3, first : first + 3] for first in (0, 3, 6)]
    of_matrix = np.einsum("kj,ikl,lj->ij", response.nt_per_am2, np.array(rows), response.nt_per_am2)
    sigma: Array = np.sqrt(field.matrix**2 @ response.sigma**2 + of_matrix)
    return sigma


def _measurable_nt(field: FieldFit, table: FlightTable) -> float:
    range_nt = (table.calibration.magnetometer or MagnetometerTable()).most_nt
    first, second, third = (tuple(row) for row in field.matrix.tolist())
    return largest_field_nt(tuple(field.offset_nt.tolist()), (first, second, third), range_nt)


def _observed(samples: Samples, along: Expected, table: FlightTable, rows: Flags, gain: float) -> FreeSamples:
    tuning = table.estimator
    return FreeSamples(
        samples.field_nt[rows],
        samples.sun[rows],
        along.b_eci_nt[rows],
        along.sun_eci[rows],
        gain * field_noise_nt(tuning),
        gain * sun_noise_rad(tuning),
    )


def _smoothed(samples: Samples, free: Flags) -> tuple[Samples, Flags, float]:
    """Field and Sun as the middle of a cubic through 11 samples, every fourth, and what is left of the noise.

    Source: Savitzky, Golay 1964.
    """
    x = np.arange(-SMOOTHED, SMOOTHED + 1) / SMOOTHED
    weights = np.linalg.pinv(np.vander(x, 4))[-1]
    field_nt = _convolved(np.where(free[:, None], samples.field_nt, np.nan), weights)
    sun = _convolved(samples.sun, weights)
    rows = whole(field_nt) & (samples.tick % EVERY == 0)
    return replace(samples, field_nt=field_nt, sun=sun), rows, float(np.linalg.norm(weights))


def _convolved(rows: Array, weights: Array) -> Array:
    smooth = np.full_like(rows, np.nan)
    if len(rows) >= len(weights):
        windows = np.lib.stride_tricks.sliding_window_view(rows, len(weights), axis=0)
        smooth[SMOOTHED:-SMOOTHED] = windows @ weights
    return smooth


def _robust(observed: FreeSamples, wiring: Wiring) -> tuple[FieldFit, Flags]:
    """The fit, once more without the samples that lie far off."""
    prior = FitPrior(channels_from_body(wiring).T, MATRIX_SIGMA, OFFSET_SIGMA_NT)
    first = joint_fit(observed, prior)
    kept = without_outliers(first)
    return (first if kept.all() else joint_fit(observed.rows(kept), prior)), kept


def _widening(field: FieldFit) -> float:
    """By how much the residuals scatter more than the noise, and by how much fewer they are than they seem.

    Of n residuals with autocorrelation r(k) only n / (1 + 2 sum r(k)) count; r(k) is summed while positive.
    """
    factors = []
    for column in field.residual.T:
        values = column[np.isfinite(column)]
        if len(values) < LEAST_VALUES:
            continue
        off = values - values.mean()
        variance = float(off @ off) / len(off)
        together = 1.0
        for lag in range(1, min(LONGEST_LAG, len(values) // 2)):
            r = float(off[lag:] @ off[:-lag]) / len(off) / variance
            if r <= 0.0:
                break
            together += 2.0 * r
        factors.append(float(np.mean(values**2)) * together)
    return float(np.sqrt(max([1.0, *factors])))
