"""What the filter did not use, beside what it says: Sun cells, gyros, and samples to come."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.commissioning.recorded.along import Along, sample_hz
from sim.commissioning.recorded.calibration import KnownCell, PassCalibration
from sim.commissioning.telemetry.follow import Followed, directions_body, without_sample
from sim.progress import progress
from sim.value_types import Array

HORIZONS_S = (10, 30, 60, 120)
"""Times without a sample after which the prediction is judged."""
COASTS = 30
"""Starts of such predictions, at most."""
LIT_PART = 0.37
"""A cell sees the Sun above this part of its full scale; what the Earth's light gives stays below."""
BRIGHTEST_PERCENT, BEYOND = 98.0, 2.0
"""Percentile of a current that is its full scale in a pass; ``BEYOND`` times that is no current."""


class Azimuths(NamedTuple):
    """Where the Sun stands about the spin axis by two cells, less where the filter has it, deg.

    ``rows``: places among the samples offered to the filter.
    """

    rows: NDArray[np.int64]
    off_deg: Array

    def within(self, first: int, last: int) -> "Azimuths":
        """Of these samples alone."""
        kept = (self.rows >= first) & (self.rows < last)
        return Azimuths(self.rows[kept], self.off_deg[kept])

    @property
    def median_deg(self) -> float:
        """The median; NaN of none."""
        return float(np.median(self.off_deg)) if len(self.off_deg) else float("nan")

    @property
    def scatter_deg(self) -> float:
        """The RMS about the median; NaN of none."""
        return (
            float(np.sqrt(np.mean((self.off_deg - self.median_deg) ** 2)))
            if len(self.off_deg)
            else float("nan")
        )

    @property
    def rms_deg(self) -> float:
        """The RMS about zero; infinite of none."""
        return float(np.sqrt(np.mean(self.off_deg**2))) if len(self.off_deg) else float("inf")


NO_AZIMUTHS = Azimuths(np.array([], dtype=np.int64), np.array([]))


def azimuth_cells(known: PassCalibration, around: Along, axis: Array) -> tuple[KnownCell, KnownCell] | None:
    """The two cells of the pass that look most across the spin axis and not the same way; None without."""
    present = [cell for cell in known.cells if cell.name in around.recorded.cells]
    across = sorted(present, key=lambda cell: abs(float(cell.face_body @ axis)))
    for first, second in pairwise(across):
        if abs(float(np.cross(first.face_body, second.face_body) @ axis)) > 0.3:
            return first, second
    return None


def sun_azimuths(around: Along, known: PassCalibration, followed: Followed, axis: Array) -> Azimuths:
    """Rows in which two cells see the Sun: its azimuth by both, less that by the filter.

    The height of the Sun over the spin axis is the filter's, which the cells hardly tell. Full scales are
    those of the pass, in the ratio of the calibration: the current of all cells changes over the years.
    """
    pair = azimuth_cells(known, around, axis)
    if pair is None:
        return NO_AZIMUTHS
    parts = np.column_stack([_parts_of_full_scale(around, cell) for cell in pair])[followed.rows]
    lit = around.lit[followed.rows] & (parts > LIT_PART).all(axis=1) & (parts < BEYOND).all(axis=1)
    rows = np.flatnonzero(lit)
    if not len(rows):
        return NO_AZIMUTHS
    sun = directions_body(followed, around.sun_eci)[rows]
    first = np.cross(np.cross(axis, pair[0].face_body), axis)
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    faces = np.array([[cell.face_body @ first, cell.face_body @ second] for cell in pair])
    height = np.outer(sun @ axis, [cell.face_body @ axis for cell in pair])
    seen = np.linalg.solve(faces, (parts[rows] - height).T)
    by_cells, by_filter = np.arctan2(seen[1], seen[0]), np.arctan2(sun @ second, sun @ first)
    off_deg: Array = (np.degrees(by_cells - by_filter) + 180.0) % 360.0 - 180.0
    return Azimuths(rows, off_deg)


def _parts_of_full_scale(around: Along, cell: KnownCell) -> Array:
    """The current of a cell as a part of its full scale in this pass."""
    current = np.nan_to_num(around.recorded.cells[cell.name])
    sane = current[around.lit & (current < 4.0 * cell.full_scale)]
    brightest = float(np.percentile(sane, BRIGHTEST_PERCENT)) if len(sane) else cell.full_scale
    return current / min(max(brightest, 0.5 * cell.full_scale), 1.2 * cell.full_scale)


def coasts_deg(around: Along, known: PassCalibration, followed: Followed, settled: int) -> dict[int, Array]:
    """By time without a sample, s, the angles between predicted and measured field of several starts.

    Where no sample is due at that time, the next one counts.

    Args:
        around: the pass.
        known: its calibration.
        followed: the pass as followed.
        settled: place of the first sample from which a prediction starts.
    """
    found: dict[int, list[float]] = {horizon: [] for horizon in HORIZONS_S}
    half_s, apart_s = 0.5 * around.tick_s, 1.0 / sample_hz(around)
    span_s = float(around.t_s[followed.rows[-1]] - around.t_s[followed.rows[settled]])
    starts = np.linspace(
        settled, len(followed.ticks) - 1, min(COASTS, max(2, int(span_s / 20.0))), endpoint=False
    )
    with progress(f"{around.recorded.name}, coasting", len(starts)) as watch:
        for done, start in enumerate(starts.astype(int).tolist()):
            for ticks, angle_deg in without_sample(around, known, followed.ticks[start], followed.config):
                beyond_s = [ticks * around.tick_s - horizon for horizon in HORIZONS_S]
                if beyond_s[-1] > apart_s:
                    break
                for horizon, late_s in zip(HORIZONS_S, beyond_s, strict=True):
                    if 0.0 <= late_s + half_s < apart_s:
                        found[horizon].append(angle_deg)
            watch(done)
    return {horizon: np.array(angles) for horizon, angles in found.items()}
