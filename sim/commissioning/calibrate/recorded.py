"""Calibration from a recorded pass: magnetometer first, then motion, body, and Sun cells by the motion."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sim.commissioning.calibrate.body import BodyFit, declared_axes, fit_body
from sim.commissioning.calibrate.cells import CellFit, fit_cells
from sim.commissioning.calibrate.magnetometer import MagnetometerFit, fit_magnetometer, sensitivity
from sim.commissioning.recorded.along import Along, sampled
from sim.commissioning.recorded.calibration import KnownCell, PassCalibration
from sim.commissioning.telemetry.follow import Noise
from sim.commissioning.telemetry.judge import Judged, judge
from sim.commissioning.telemetry.spin import spin_axis
from sim.value_types import Array

# --- Whether the magnetometer's bias moves: over the pass, with the shadow of the Earth, with temperature


BLOCK_S, LEAST_BLOCK = 200.0, 60
"""Length of the stretches whose biases are compared, and rows in each."""
LEAST_PART = 0.1
"""Sun and shadow are compared where each has this part of the rows."""
LEAST_DEGC = 2.0


@dataclass(frozen=True, slots=True)
class Drift:
    """How the bias moves, sensor axes, nT.

    Attributes:
        middle_s: of each stretch, (k); ``bias_nt``, less the mean of all, and ``sigma_nt``, (k, 3).
        eclipse_nt: bias in shadow less in the Sun, and its standard deviation, (2, 3); None: not both.
        per_degc_nt: slope with temperature, and its standard deviation, (2, 3); None: no temperature.
    """

    middle_s: Array
    bias_nt: Array
    sigma_nt: Array
    eclipse_nt: Array | None
    per_degc_nt: Array | None

    @property
    def largest_nt(self) -> float:
        """The largest component that is known to 3 standard deviations; 0: none."""
        known = np.abs(self.bias_nt) > 3.0 * self.sigma_nt
        return float(np.max(np.abs(self.bias_nt) * known, initial=0.0))


def bias_drift(around: Along, fit: MagnetometerFit) -> Drift:
    """The drift that the residuals of a fit show, to first order, with the matrix estimated once more.

    A matrix that was fitted to a bias that moves has taken a part of the motion. Of a pass shorter than
    ``BLOCK_S`` there is one stretch, which shows no drift.
    """
    finite = np.isfinite(around.recorded.mag_nt).all(axis=1)
    slope = sensitivity(fit.offset_nt, fit.matrix, around.recorded.mag_nt[finite])
    rows, errors = fit.correlation_rows, -fit.residual_nt
    t_s, dark = around.t_s[finite], (~around.lit[finite]).astype(float)
    middle_s, bias_nt, sigma_nt = _by_stretch(t_s, slope, errors, rows)
    shared = LEAST_PART < dark.mean() < 1.0 - LEAST_PART
    per_degc = None
    if around.recorded.temperature_degc is not None:
        warm = around.recorded.temperature_degc[finite]
        if np.isfinite(warm).all() and float(np.ptp(warm)) > LEAST_DEGC:
            per_degc = _with(warm - warm.mean(), slope, errors, rows)
    return Drift(middle_s, bias_nt, sigma_nt, _with(dark, slope, errors, rows) if shared else None, per_degc)


def _by_stretch(t_s: Array, slope: Array, errors: Array, correlated: float) -> tuple[Array, Array, Array]:
    """Middles of the stretches, and their biases less the mean of all, with standard deviations."""
    count = max(1, round(float(t_s[-1] - t_s[0]) / BLOCK_S))
    edges = np.linspace(t_s[0], t_s[-1] + 1.0, count + 1)
    members = [(t_s >= low) & (t_s < high) for low, high in pairwise(edges)]
    members = [one for one in members if one.sum() >= LEAST_BLOCK]
    if len(members) < 2:
        return np.array([]), np.empty((0, 3)), np.empty((0, 3))
    by_stretch = [slope[:, :3] * one[:, None] for one in members]
    solution, sigma = _solved(np.hstack((*by_stretch, slope[:, 3:])), errors, correlated)
    bias_nt = solution[:-6].reshape(-1, 3)
    middle_s = np.array([float(t_s[one].mean()) for one in members])
    return middle_s, bias_nt - bias_nt.mean(axis=0), sigma[:-6].reshape(-1, 3)


def _with(weight: Array, slope: Array, errors: Array, correlated: float) -> Array:
    """How the bias goes with a weight of each row, beside a constant: values and deviations, (2, 3)."""
    solution, sigma = _solved(np.hstack((slope[:, :3] * weight[:, None], slope)), errors, correlated)
    return np.array([solution[:3], sigma[:3]])


def _solved(columns: Array, values: Array, correlated: float) -> tuple[Array, Array]:
    """Least squares of the values, with standard deviations; infinite ones where the columns do not tell."""
    size = np.sqrt(np.mean(columns**2, axis=0))
    size[size == 0.0] = 1.0
    found = np.linalg.lstsq(columns / size, values, rcond=None)
    solution: Array = np.asarray(found[0] / size, dtype=np.float64)
    variance = float(np.mean((values - columns @ solution) ** 2)) * correlated
    if found[2] < columns.shape[1]:
        return solution, np.full(columns.shape[1], np.inf)
    scaled = columns / size
    return solution, np.sqrt(variance * np.linalg.inv(scaled.T @ scaled).diagonal()) / size


LEAST_ROWS = 15
"""With a field sample, that may tell the nine numbers of the magnetometer."""
LEAST_FOLLOWED_S = 60.0
"""A shorter pass tells no motion."""


@dataclass(frozen=True, slots=True)
class RecordedCalibration:
    """What a pass tells. Without a motion that can be believed, body and cells are None and empty."""

    around: Along
    magnetometer: MagnetometerFit
    drift: Drift
    judged: Judged | None
    body: BodyFit | None
    cells: tuple[CellFit, ...]

    @property
    def calibration(self) -> PassCalibration:
        """The values, for the filter; only of cells that are determined."""
        cells = tuple(
            KnownCell(one.name, one.face_body, one.full_scale) for one in self.cells if one.determined
        )
        inertia = np.eye(3) if self.body is None else self.body.inertia
        return PassCalibration(self.magnetometer.offset_nt, self.magnetometer.matrix, cells, inertia)


def calibrate_pass(around: Along, ratios: Array, noise: Noise) -> RecordedCalibration:
    """Calibrate by a pass; ``ratios``: declared moments of inertia, of which a sphere's mean that none are.

    Rows that the filter leaves out are left out of the whole, which begins anew without them.

    Raises:
        HarnessError: a gap between samples is too long.
    """
    magnetometer = fit_magnetometer(around.recorded.mag_nt, around.strength_nt)
    drift = bias_drift(around, magnetometer)
    first = PassCalibration(magnetometer.offset_nt, magnetometer.matrix, (), np.eye(3))
    rows = sampled(around)
    if not magnetometer.determined[:3].all() or float(np.ptp(around.t_s[rows])) < LEAST_FOLLOWED_S:
        return RecordedCalibration(around, magnetometer, drift, None, None, ())
    axis = spin_axis(first.field_nt(around.recorded.mag_nt)[rows])
    if np.ptp(ratios) > 0.0:
        axes = declared_axes(ratios, axis)
        first = first._replace(inertia=axes @ np.diag(ratios / ratios.max()) @ axes.T)
    judged = judge(around, first, noise)
    if judged.around is not around:
        return calibrate_pass(judged.around, ratios, noise)
    if not judged.verdict.converged:
        return RecordedCalibration(around, magnetometer, drift, judged, None, ())
    followed = judged.best.followed
    body = fit_body(around, first, ratios, axis, followed.start, noise) if np.ptp(ratios) > 0.0 else None
    return RecordedCalibration(
        around, magnetometer, drift, judged, body, tuple(fit_cells(around, followed, judged.best.settled))
    )
