"""Rows that the others do not bear out, by the strength of the field and by how far a value stands alone.

The strength: |M (m - b)|^2 = |B|^2 is linear in the numbers of M'M, in M'M b and in |M b|^2, so that least
trimmed squares find the fit of nine rows in ten that fit best, whatever the tenth holds, by concentration
from many small subsets (Rousseeuw and Van Driessen 2006). From there rows beyond six robust standard
deviations are left out, and the rest is fitted again, until the same rows stay: the rows that are kept are
those that fit what is kept. A row that decides alone what no other can check is left out too (leverage over
one half, Huber 1981, section 7.2).
"""

import numpy as np
from numpy.typing import NDArray

from sim.value_types import Array

Mask = NDArray[np.bool_]

MOST_PART = 0.1
"""Of the rows that may be left out; beyond it, nothing tells which rows are wrong."""
FAR = 6.0
"""Standard deviations, by the median, beyond which a value is none of its kind."""
GAUSSIAN = 1.4826
"""Standard deviation of a normal distribution over its median deviation."""
RAYLEIGH = 0.8493
"""Standard deviation of each of two errors across a direction over the median angle."""
LEAST_PART = 0.01
"""Of the median, which a standard deviation is at least: channels that stand still have none."""
STARTS, START_ROWS, BEST_STARTS, MOST_ROUNDS = 200, 10, 5, 50
MATRIX_SIGMA, LINEAR_SIGMA, NOISE = 0.3, 3.0, 0.02
"""Wide priors: of the numbers of M'M about 1, of the others about 0, and the noise of a row, as parts of the
strength and of its square; without them what a spin does not show would be free."""
MOST_LEVERAGE = 0.5
MOST_REACH = 2.0
"""From the middle of all samples, of what four of five reach, that samples at the start have."""


def most_left_out(rows: int) -> int:
    """How many of so many rows may be left out."""
    return int(MOST_PART * rows)


def stray_values(values: Array) -> Mask:
    """Which numbers of a column stand far from the others; NaN does not, nor does any if too many do."""
    finite = np.isfinite(values)
    kept = finite.copy()
    for _ in range(MOST_ROUNDS):
        if not kept.any():
            break
        middle = float(np.median(values[kept]))
        off = np.abs(values - middle)
        scale = max(GAUSSIAN * float(np.median(off[kept])), LEAST_PART * abs(middle))
        before, kept = kept, finite & (off <= FAR * scale)
        if np.array_equal(before, kept):
            break
    return _few(finite & ~kept)


def stray_sizes(sizes: Array) -> Mask:
    """Which sizes of errors, (n), are far beyond what the median of them makes likely."""
    strays = np.zeros(len(sizes), dtype=np.bool_)
    for _ in range(MOST_ROUNDS):
        before = strays
        strays = sizes > FAR * RAYLEIGH * float(np.median(sizes[~before]))
        if np.array_equal(before, strays) or strays.all():
            break
    return _few(strays)


def stray_currents(currents: Array, lit: Mask) -> Mask:
    """Which currents of a cell, (n), are far beyond what a tenth of the rows in the Sun have.

    A spin hides most of a current, so that only its size tells.
    """
    finite = np.isfinite(currents)
    sizes = np.abs(currents[finite & lit])
    bright = float(np.percentile(sizes, 100.0 * (1.0 - MOST_PART))) if len(sizes) else 0.0
    far = np.abs(np.where(finite, currents, 0.0)) > FAR * bright
    return _few(far) if bright > 0.0 else np.zeros_like(finite)


def stray_strengths(mag_nt: Array, strength_nt: Array) -> Mask:
    """Which samples, (n, 3), do not show the strength of the field, (n), as the others do.

    A sample that lacks a number is none of them.
    """
    finite = np.isfinite(mag_nt).all(axis=1)
    strays = np.zeros(len(mag_nt), dtype=np.bool_)
    if finite.sum() >= START_ROWS:
        strays[finite] = _few(_strays(mag_nt[finite], strength_nt[finite]))
    return strays


def _few(strays: Mask) -> Mask:
    return strays if strays.sum() <= most_left_out(len(strays)) else np.zeros_like(strays)


def _strays(mag_nt: Array, strength_nt: Array) -> Mask:
    unit = float(np.median(strength_nt))
    columns, values = _linear((mag_nt - np.median(mag_nt, axis=0)) / unit, strength_nt / unit)
    kept = within(mag_nt)
    kept[kept] = _best_start(columns[kept], values[kept])
    for _ in range(MOST_ROUNDS):
        residual = np.abs(values - columns @ _fitted(columns, values, kept))
        scale = GAUSSIAN * float(np.median(residual))
        before, kept = kept, residual <= FAR * scale
        if np.array_equal(before, kept):
            break
    return ~(kept & (_leverage(columns, kept) <= MOST_LEVERAGE))


def within(mag_nt: Array) -> Mask:
    """Which samples, (n, 3), are not far outside the ball that a turning field fills.

    Those outside would be fitted by what no other sample shows, and begin nothing; later they are judged as
    all others.
    """
    reach_nt = np.linalg.norm(mag_nt - np.median(mag_nt, axis=0), axis=1)
    near: Mask = reach_nt <= MOST_REACH * np.percentile(reach_nt, 100.0 * (1.0 - 2.0 * MOST_PART))
    return near


def _linear(near: Array, strength: Array) -> tuple[Array, Array]:
    """Columns and values of the linear fit, divided by what a standard deviation of each number is."""
    x, y, z = near.T
    squares = MATRIX_SIGMA * np.column_stack((x * x, y * y, z * z, x * y, x * z, y * z))
    linear = LINEAR_SIGMA * np.column_stack((near, np.ones(len(near))))
    row = 0.5 / strength
    columns = np.hstack((squares, linear)) * row[:, None]
    values: Array = (strength**2 - np.sum(near**2, axis=1)) * row
    return columns / NOISE, values / NOISE


def _fitted(columns: Array, values: Array, kept: Mask) -> Array:
    chosen, width = columns[kept], columns.shape[1]
    normal = chosen.T @ chosen + np.eye(width)
    return np.asarray(np.linalg.solve(normal, chosen.T @ values[kept]), dtype=np.float64)


def _best_start(columns: Array, values: Array) -> Mask:
    """The nine rows of ten that are fitted best, as far as concentration from random subsets finds them."""
    rows, width = columns.shape
    random = np.random.default_rng(0)
    count = rows - most_left_out(rows)
    subsets = np.array([random.choice(rows, min(START_ROWS, rows), replace=False) for _ in range(STARTS)])
    chosen = columns[subsets]
    normal = np.einsum("sni,snj->sij", chosen, chosen) + np.eye(width)
    towards = np.einsum("sni,sn->si", chosen, values[subsets])
    begun = np.linalg.solve(normal, towards[:, :, None])[:, :, 0]
    sizes = np.partition(np.abs(values - begun @ columns.T), count - 1, axis=1)[:, :count]
    best, least = np.ones(rows, dtype=np.bool_), np.inf
    for start in begun[np.argsort(np.sum(sizes**2, axis=1))[:BEST_STARTS]]:
        fitted, objective = start, np.inf
        for _ in range(MOST_ROUNDS):
            squares = (values - columns @ fitted) ** 2
            kept = np.zeros(rows, dtype=np.bool_)
            kept[np.argsort(squares, kind="stable")[:count]] = True
            fitted = _fitted(columns, values, kept)
            now = float(np.sum((values - columns @ fitted)[kept] ** 2) + fitted @ fitted)
            if now >= objective:
                break
            objective = now
        if objective < least:
            best, least = kept, objective
    return best


def _leverage(columns: Array, kept: Mask) -> Array:
    """Of each row among those that are kept."""
    chosen = columns[kept]
    inverse = np.linalg.inv(chosen.T @ chosen + np.eye(columns.shape[1]))
    leverage: Array = np.einsum("ni,ij,nj->n", columns, inverse, columns)
    return leverage
