"""Calibration from a recorded pass: magnetometer first, then motion, body, and Sun cells by the motion."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sim.commissioning.calibrate.body import BodyFit, declared_axes, fit_body
from sim.commissioning.calibrate.cells import CellFit, fit_cells
from sim.commissioning.calibrate.drift import Drift, bias_drift
from sim.commissioning.calibrate.magnetometer import MagnetometerFit, fit_magnetometer
from sim.commissioning.recorded.along import Along, sampled
from sim.commissioning.recorded.calibration import KnownCell, PassCalibration
from sim.commissioning.telemetry.follow import Noise
from sim.commissioning.telemetry.judge import Judged, judge
from sim.commissioning.telemetry.spin import spin_axis

Array = NDArray[np.float64]

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
        """The values, for the filter; only of cells that are told."""
        cells = tuple(KnownCell(one.name, one.face_body, one.full_scale) for one in self.cells if one.told)
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
    if not magnetometer.told[:3].all() or float(np.ptp(around.t_s[rows])) < LEAST_FOLLOWED_S:
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
