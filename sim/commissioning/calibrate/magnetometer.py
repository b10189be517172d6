"""The magnetometer against the strength of the field along the orbit, whatever the attitude.

    |M (m - b)| = |B|,  M symmetric: 9 numbers. A turn of the sensor changes no strength: of 12 numbers it is
    the three that need directions.

The fit is robust (soft L1), and starts from the best bias of an undistorted sensor. Every number has a wide
prior, so that one that the data cannot tell stays near it with the prior's uncertainty.

Source: Alonso and Shuster 2002 (TWOSTEP); Gebre-Egziabher et al. 2006, with the distortion symmetric.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import polar
from scipy.optimize import least_squares

from sim.value_types import Array

UT_PER_NT = 1e-3
BIAS_SIGMA_UT, MATRIX_SIGMA = 200.0, 0.1
"""Priors: of a bias component about the best one of an undistorted sensor, of each number of M about 1."""
LEAST = 1e-12
"""In place of the size of a field that is zero, which has no direction."""
DETERMINED_NT = 1500.0
"""A number is determined if one standard deviation of it moves the field by at most this: 3 deg in 30 uT."""
NAMES = ("b_x", "b_y", "b_z", "m_xx", "m_yy", "m_zz", "m_xy", "m_xz", "m_yz")
TURN_NAMES = ("turn_x", "turn_y", "turn_z")
_PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


class MagnetometerFit(NamedTuple):
    """A fit: the field is matrix (raw - offset).

    Attributes:
        offset_nt: b, sensor axes, (3).
        matrix: M, symmetric and positive, (3, 3).
        sigma: of the offset, nT, then of xx, yy, zz, xy, xz, yz of M, (9).
        determined: whether the data tell each, (9).
        residual_nt: |M (m - b)| - |B|, of the rows that lack no number, (n).
        weakest_axis: direction along which the offset is least certain, (3); ``weakest_nt``: its deviation.
        correlation_rows: how many neighbouring residuals count as one.
    """

    offset_nt: Array
    matrix: Array
    sigma: Array
    determined: NDArray[np.bool_]
    residual_nt: Array
    weakest_axis: Array
    weakest_nt: float
    correlation_rows: float

    @property
    def values(self) -> list[float]:
        """Offset, nT, and numbers of the matrix, in the order of ``NAMES``."""
        return [*self.offset_nt.tolist(), *(float(self.matrix[place]) for place in _PLACES)]

    @property
    def rms_nt(self) -> float:
        """RMS of the residuals."""
        return float(np.sqrt(np.mean(self.residual_nt**2)))


def fit_magnetometer(mag_nt: Array, strength_nt: Array) -> MagnetometerFit:
    """Fit offset and symmetric matrix to samples in the order of time.

    Args:
        mag_nt: samples, sensor axes, (n, 3); a row that lacks a number counts for nothing.
        strength_nt: of the field at each, (n).
    """
    finite = np.isfinite(mag_nt).all(axis=1)
    samples, strength = UT_PER_NT * mag_nt[finite], UT_PER_NT * strength_nt[finite]
    first = _undistorted(samples, strength)
    scale_ut = 1.0
    for _ in range(3):
        found = least_squares(
            _residuals,
            first,
            args=(samples, strength, first, scale_ut),
            loss=_robust(len(samples)),
            x_scale="jac",
        )
        residual = _errors(found.x, samples, strength)
        scale_ut = max(1.4826 * float(np.median(np.abs(residual))), 1e-3)
    rows = _correlated_rows(residual)
    covariance = _covariance(found.x, samples, scale_ut, rows)
    return _as_positive(found.x, covariance, residual / UT_PER_NT, float(strength.mean()), rows)


def _undistorted(samples: Array, strength: Array) -> Array:
    """The bias of a sensor of one scale: |m|^2 = 2 m b + |B|^2 / s^2 - |b|^2, linear in b and s^-2."""
    middle = samples.mean(axis=0)
    near = samples - middle
    columns = np.column_stack((2.0 * near, strength**2, np.ones(len(near))))
    b, inverse_square = np.split(np.linalg.lstsq(columns, np.sum(near**2, axis=1), rcond=1e-6)[0][:4], [3])
    if not 0.25 < inverse_square[0] < 4.0 or np.linalg.norm(b) > BIAS_SIGMA_UT:
        b = np.zeros(3)
    return np.concatenate((middle + b, np.ones(3), np.zeros(3)))


def _matrix(numbers: Array) -> Array:
    xx, yy, zz, xy, xz, yz = numbers
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _errors(x: Array, samples: Array, strength: Array) -> Array:
    turned = (samples - x[:3]) @ _matrix(x[3:])
    errors: Array = np.sqrt(np.sum(turned**2, axis=1)) - strength
    return errors


def _residuals(x: Array, samples: Array, strength: Array, prior: Array, scale_ut: float) -> Array:
    """The errors in standard deviations, and behind them how far the numbers are from their priors.

    The noise is of the samples, and M carries it: |M u| of it shows along the field u. Without the division a
    sensor would fit best that hardly feels where the field hardly changes.
    """
    sigma = np.concatenate((np.full(3, BIAS_SIGMA_UT), np.full(6, MATRIX_SIGMA)))
    turned = (samples - x[:3]) @ _matrix(x[3:])
    size = np.maximum(np.sum(turned**2, axis=1), LEAST)
    felt = np.maximum(np.sqrt(np.sum((turned @ _matrix(x[3:])) ** 2, axis=1) / size), LEAST)
    return np.concatenate((_errors(x, samples, strength) / (felt * scale_ut), (x - prior) / sigma))


def _robust(samples: int) -> Any:  # noqa: ANN401  (a function, as least_squares wants it)
    """Soft L1 of the samples, the square of the priors (Triggs et al. 1999)."""

    def loss(z: Array) -> Array:
        rho = np.vstack((z, np.ones_like(z), np.zeros_like(z)))
        inner = 1.0 + z[:samples] / 9.0  # a third as heavy beyond 3 standard deviations
        rho[0, :samples] = 18.0 * (np.sqrt(inner) - 1.0)
        rho[1, :samples] = inner**-0.5
        rho[2, :samples] = -(inner**-1.5) / 18.0
        return rho

    return loss


def _covariance(x: Array, samples: Array, scale_ut: float, rows: float) -> Array:
    """Of the numbers, with so many rows of samples counted as one."""
    slope = sensitivity(x[:3], _matrix(x[3:]), samples)
    sigma = np.concatenate((np.full(3, BIAS_SIGMA_UT), np.full(6, MATRIX_SIGMA)))
    information = slope.T @ slope / (scale_ut**2 * rows) + np.diag(sigma**-2.0)
    covariance: Array = np.asarray(np.linalg.inv(information), dtype=np.float64)
    return covariance


def sensitivity(offset: Array, matrix: Array, samples: Array) -> Array:
    """How |M (m - b)| of samples, (n, 3), goes with b and with xx, yy, zz, xy, xz, yz of M, (n, 9)."""
    near = samples - offset
    turned = near @ matrix
    along = turned / np.maximum(np.sqrt(np.sum(turned**2, axis=1)), LEAST)[:, None]
    columns = [-along @ matrix]
    for i, j in _PLACES:
        change = np.zeros((3, 3))
        change[i, j] = change[j, i] = 1.0
        columns.append(np.sum(along * (near @ change), axis=1)[:, None])
    return np.hstack(columns)


def _correlated_rows(residual: Array) -> float:
    """1 + 2 sum of the autocorrelation up to where it first is not positive: model errors change slowly."""
    centred = residual - residual.mean()
    power, total = float(centred @ centred), 1.0
    for lag in range(1, len(centred) // 3):
        part = float(centred[lag:] @ centred[:-lag]) / power if power > 0.0 else 0.0
        if part <= 0.0:
            break
        total += 2.0 * part
    return total


def _as_positive(
    x: Array, covariance: Array, residual_nt: Array, strength_ut: float, rows: float
) -> MagnetometerFit:
    """The fit with that matrix, of all that give these strengths, which neither turns nor mirrors."""
    positive = np.asarray(polar(_matrix(x[3:]), side="right")[1])
    matrix = 0.5 * (positive + positive.T)
    sigma = np.sqrt(covariance.diagonal())
    sigma[:3] /= UT_PER_NT
    moved_nt = np.concatenate((sigma[:3], sigma[3:] * strength_ut / UT_PER_NT))
    values, axes = np.linalg.eigh(covariance[:3, :3])
    weakest = axes[:, -1] * np.copysign(1.0, axes[np.argmax(np.abs(axes[:, -1])), -1])
    return MagnetometerFit(
        offset_nt=x[:3] / UT_PER_NT,
        matrix=matrix,
        sigma=sigma,
        determined=moved_nt <= DETERMINED_NT,
        residual_nt=residual_nt,
        weakest_axis=weakest,
        weakest_nt=float(np.sqrt(values[-1])) / UT_PER_NT,
        correlation_rows=rows,
    )
