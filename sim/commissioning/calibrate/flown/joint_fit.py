"""Magnetometer by twelve numbers: offset o, and M of scale, non-orthogonality, turn against the Sun sensor.

    b_body = M (z - o)
    |b_body| = |B|,   s_body . b_body = S . B

z the reading, s_body the reading of the Sun sensor, B and S field and Sun of the models: two numbers of a
sample that do not depend on the attitude. Without the Sun only |b_body| counts, which leaves any turn of M
open. Each sample's two residuals are weighted by their common covariance; what is known beforehand of M and o
counts as measured.

The noise n of a reading is M n in b_body. With weights that do not depend on M the sum of squares would be
least with an M too small. So each residual is divided by the noise that M gives it, which makes the squares
of n itself least.

Source: Merayo et al. 2000, Scalar calibration of vector magnetometers, for the first; Alonso, Shuster 2002,
TWOSTEP, for the start; the second is the dot-product constraint of Lerner, Shuster 1981; the weights are
those of Sampson 1982, Fitting conic sections to very scattered data.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from sim.commissioning.calibrate.flown.samples import whole
from sim.value_types import Array

MOST_STEPS = 40
"""Of a fit; one to samples that it can explain takes 5 to 16, one to a Sun that is none does not end."""
LEAST_REST = 1e-3
"""Of the variance of the second residual, what is left without the first where field and Sun are parallel."""


@dataclass(frozen=True, slots=True)
class FreeSamples:
    """Samples without the coils' field.

    Attributes:
        field_nt: readings of the magnetometer, (n, 3).
        sun: readings of the Sun sensor at the age of those of the field, NaN where there is none, (n, 3).
        b_eci_nt, sun_eci: of the models, (n, 3).
        field_sigma_nt: noise of a channel.
        sun_sigma_rad: noise of the Sun direction.
    """

    field_nt: Array
    sun: Array
    b_eci_nt: Array
    sun_eci: Array
    field_sigma_nt: float
    sun_sigma_rad: float

    def rows(self, chosen: slice | NDArray[np.bool_]) -> "FreeSamples":
        """Some of them."""
        parts = (self.field_nt[chosen], self.sun[chosen], self.b_eci_nt[chosen], self.sun_eci[chosen])
        return FreeSamples(*parts, self.field_sigma_nt, self.sun_sigma_rad)

    def every(self, step: int) -> "FreeSamples":
        """Every so many of them."""
        return self.rows(slice(None, None, step))


@dataclass(frozen=True, slots=True)
class FitPrior:
    """What is known beforehand: M near ``matrix`` within ``matrix_sigma``, o near zero within so many nT."""

    matrix: Array
    matrix_sigma: float
    offset_sigma_nt: float


@dataclass(frozen=True, slots=True)
class FieldFit:
    """M, o and their covariance, (12, 12): M by rows, then o.

    ``chi2`` is the sum of the squares of the whitened residuals and of what is off the prior, ``numbers`` of
    so many; ``residual`` are the whitened ones, by sample, of strength and of angle (NaN without the Sun),
    ``residual_nt`` those of strength and of the component along the Sun as they are.
    """

    matrix: Array
    offset_nt: Array
    covariance: Array
    chi2: float
    numbers: int
    residual: Array
    residual_nt: Array


def joint_fit(observed: FreeSamples, prior: FitPrior) -> FieldFit:
    """The fit of both numbers."""
    centre = np.concatenate([prior.matrix.ravel(), np.zeros(3)])
    sigma = np.concatenate([np.full(9, prior.matrix_sigma), np.full(3, prior.offset_sigma_nt)])
    lit = whole(observed.sun)

    def errors(x: Array) -> Array:
        first, second = _whitened(observed, x).T
        return np.concatenate([first, second[lit], (x - centre) / sigma])

    start = np.concatenate([prior.matrix.ravel(), _first_offset(observed, prior)])
    found = least_squares(errors, start, "3-point", x_scale="jac", max_nfev=MOST_STEPS)
    slopes = np.asarray(found.jac, np.float64)
    covariance: Array = np.asarray(np.linalg.inv(slopes.T @ slopes), np.float64)
    first, second = _whitened(observed, found.x).T
    residual = np.column_stack([first, np.where(lit, second, np.nan)])
    matrix, offset = found.x[:9].reshape(3, 3), found.x[9:]
    return FieldFit(
        matrix=matrix,
        offset_nt=offset,
        covariance=covariance,
        chi2=2.0 * float(found.cost),
        numbers=int(np.isfinite(residual).sum()),
        residual=residual,
        residual_nt=_left_nt(observed, matrix, offset),
    )


def _left_nt(observed: FreeSamples, matrix: Array, offset: Array) -> Array:
    """What the fit leaves of strength and of the component along the Sun."""
    body, b = (observed.field_nt - offset) @ matrix.T, observed.b_eci_nt
    strength = np.linalg.norm(body, axis=1) - np.linalg.norm(b, axis=1)
    along = np.sum(observed.sun * body, axis=1) - np.sum(observed.sun_eci * b, axis=1)
    return np.column_stack([strength, along])


def _first_offset(observed: FreeSamples, prior: FitPrior) -> Array:
    """An offset to begin with: |z|^2 - 2 z . o + |o|^2 = |B|^2 and s . M (z - o) = S . B are linear in it."""
    z, b = observed.field_nt, observed.b_eci_nt
    strength = np.linalg.norm(b, axis=1)
    rows = np.hstack([z / strength[:, None], -0.5 / strength[:, None]])
    values = (np.sum(z * z, axis=1) - strength**2) / (2.0 * strength)
    lit = whole(observed.sun)
    turned = observed.sun[lit] @ prior.matrix
    angle = np.hstack([turned, np.zeros((int(lit.sum()), 1))])
    known = np.sum(turned * z[lit], axis=1) - np.sum(b[lit] * observed.sun_eci[lit], axis=1)
    sigma = 0.05 * float(strength.mean())  # as exact as M is known
    a = np.vstack([rows, angle]) / sigma
    y = np.concatenate([values, known]) / sigma
    limits = np.array([*[prior.offset_sigma_nt**-2] * 3, 1e-30])
    found: Array = np.asarray(np.linalg.solve(a.T @ a + np.diag(limits), a.T @ y), float)
    return found[:3]


def _whitened(observed: FreeSamples, x: Array) -> Array:
    """By sample both residuals, (n, 2); in the dark the first alone counts.

    The noise of a reading is in both. With u the direction of b_body, s that of the Sun, q the noise of the
    Sun's direction times the field across it, in parts of sigma, their covariance is

        sigma^2 [[|M^T u|^2, (M^T u) . (M^T s)], [(M^T u) . (M^T s), |M^T s|^2 + q^2]],

    which is taken out by its Cholesky factor.
    """
    matrix, offset = x[:9].reshape(3, 3), x[9:]
    body = (observed.field_nt - offset) @ matrix.T
    size = np.maximum(np.linalg.norm(body, axis=1), 1.0)
    b, s = observed.b_eci_nt, observed.sun_eci
    strength = np.linalg.norm(b, axis=1)
    along = np.sum(b * s, axis=1)
    sun = np.where(whole(observed.sun)[:, None], observed.sun, 0.0)
    of_strength, of_angle = body @ matrix / size[:, None], sun @ matrix
    sigma = observed.field_sigma_nt
    across = np.sqrt(np.maximum(strength**2 - along**2, 0.0)) * observed.sun_sigma_rad / sigma
    own = np.linalg.norm(of_strength, axis=1)
    shared = np.sum(of_strength * of_angle, axis=1) / own
    rest = np.sqrt(np.maximum(np.sum(of_angle**2, axis=1) + across**2 - shared**2, LEAST_REST))
    first = (size - strength) / sigma / own
    second = ((np.sum(sun * body, axis=1) - along) / sigma - shared * first) / rest
    return np.column_stack([first, second])
