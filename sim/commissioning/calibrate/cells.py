"""Faces and full scales of Sun cells, by the Sun as the followed attitude has it.

A cell that sees the Sun gives full_scale (face . s): linear in the product, which is fitted robustly.
"""

from math import floor, log10
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.commissioning.recorded.along import Along
from sim.commissioning.telemetry.follow import Followed, directions_body
from sim.value_types import Array

LIT_PART = 0.4
"""Of the brightest rows: below, light of the Earth and shadows count as much as the Sun."""
BRIGHTEST_PERCENT, BEYOND = 99.0, 1.5
LEAST_ROWS = 12
ROUNDS = 8
DETERMINED_DEG, DETERMINED_PART = 10.0, 0.1
"""A cell is determined where face and full scale are known to this."""


class CellFit(NamedTuple):
    """A cell: face, body axes, and full scale, with their standard deviations; residual of ``rows`` rows."""

    name: str
    face_body: Array
    full_scale: float
    face_sigma_deg: float
    full_scale_sigma: float
    residual_rms: float
    rows: int

    @property
    def determined(self) -> bool:
        """Whether the data tell it."""
        return (
            self.face_sigma_deg <= DETERMINED_DEG
            and self.full_scale_sigma <= DETERMINED_PART * self.full_scale
        )

    @property
    def decimals(self) -> int:
        """Decimals that give the full scale, which may be in A, three digits at least."""
        return max(0, 2 - floor(log10(self.full_scale)))


def fit_cells(around: Along, followed: Followed, settled: int) -> list[CellFit]:
    """Every cell that saw the Sun often enough after the filter had settled."""
    sun = directions_body(followed, around.sun_eci)[settled:]
    rows = followed.rows[settled:]
    found = [
        fit_cell(name, current[rows], sun, around.lit[rows])
        for name, current in around.recorded.cells.items()
    ]
    return [one for one in found if one is not None]


def fit_cell(name: str, current: Array, sun_body: Array, lit: NDArray[np.bool_]) -> CellFit | None:
    """One cell; None where too few rows saw the Sun."""
    usable = lit & np.isfinite(current)
    if usable.sum() < LEAST_ROWS:
        return None
    middle = float(np.percentile(current[usable], BRIGHTEST_PERCENT))
    usable &= (current > LIT_PART * middle) & (current < BEYOND * middle)
    if usable.sum() < LEAST_ROWS:
        return None
    sun, measured = sun_body[usable], current[usable]
    weights = np.ones(len(measured))
    for _ in range(ROUNDS):
        weighted = sun * weights[:, None]
        product = np.linalg.lstsq(weighted, weights * measured, rcond=None)[0]
        residual = measured - sun @ product
        scale = max(1.4826 * float(np.median(np.abs(residual))), 1e-6)
        weights = (1.0 + (residual / (2.0 * scale)) ** 2) ** -0.25
    size = float(np.linalg.norm(product))
    spread = float(np.sqrt(np.mean(residual**2)))
    covariance = spread**2 * np.linalg.pinv(weighted.T @ weighted)
    face: Array = np.asarray(product / size, dtype=np.float64)
    across = np.eye(3) - np.outer(face, face)
    turn = np.degrees(np.sqrt(max(float(np.linalg.eigvalsh(across @ covariance @ across)[-1]), 0.0)) / size)
    along = float(np.sqrt(face @ covariance @ face))
    return CellFit(name, face, size, float(turn), along, spread, len(measured))
