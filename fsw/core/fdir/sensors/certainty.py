"""How far the attitude of an estimate may be off, and whether its samples can be judged by linear equations.

A small turn theta of the attitude moves what a sensor should show by [v x] theta, v being a direction times
its length; what these equations leave out is at most |v| theta^2 / 2, theta across v. The filter's covariance
knows nothing of that. So at ``SIGMAS`` standard deviations what is left out is more than the noise hides once

    SIGMAS^2 / 2 |v| var(theta across v) > SIGMAS sigma,

sigma being the standard deviation of the innovation along v. A sample that such an estimate refuses shows
nothing against its sensor.

Beyond ``UNSURE_RAD`` the estimate itself is no longer what has been proven: 1 - cos(4 x 0.1) is 8 %, as much
as the table allows a Sun cell. A turn about the field, which the magnetometer alone does not show, may have
led it to another attitude by then, which fits both field and one cell.

Source: Athans, Wishner, Bertolini 1968, on the second-order terms of a filter.
"""

from math import sqrt
from typing import Final

import numpy as np

from fsw.core.algebra.vector import Vec3
from fsw.core.estimation.kalman import Matrix, diagonal
from fsw.core.estimation.measurement import Prediction
from fsw.core.estimation.mekf import Estimate
from fsw.core.fdir.evidence import SIGMAS

UNSURE_RAD: Final = 0.1
"""Standard deviation of the attitude, all axes together, beyond which it has to be proven again."""


def is_unsure(estimate: Estimate) -> bool:
    """Whether the attitude is more uncertain than the filter's linear equations hold for."""
    return not _total(estimate) <= UNSURE_RAD**2


def turn_variance(estimate: Estimate, about: Vec3) -> float:
    """Variance of ``about`` . theta, theta being the error of the attitude; body axes, rad^2."""
    axis = np.array(about)
    return max(0.0, float(axis.dot(estimate.covariance[0:3, 0:3]).dot(axis)))


def across_variance(estimate: Estimate, direction: Vec3) -> float:
    """Variance of a direction fixed in space, a unit vector, by the error of the attitude, rad^2."""
    return max(0.0, _total(estimate) - turn_variance(estimate, direction))


def _total(estimate: Estimate) -> float:
    """Variance of the attitude, all axes together, rad^2."""
    about_1, about_2, about_3 = diagonal(estimate.covariance)[:3]
    return about_1 + about_2 + about_3


def is_linear(estimate: Estimate, prediction: Prediction, noise: Matrix) -> bool:
    """Whether what the linear equations leave out of a vector is hidden by the noise of its innovation.

    Args:
        estimate: of this tick.
        prediction: the vector v, and H, (3, n).
        noise: of the sample, (3, 3).
    """
    v, sensitivity = np.array(prediction[0]), prediction[1]
    turned = sensitivity[:, 0:3]
    left_out = 0.5 * SIGMAS * float(np.trace(turned.dot(estimate.covariance[0:3, 0:3]).dot(turned.T)))
    along = v.dot(sensitivity)
    return left_out <= sqrt(max(0.0, float(along.dot(estimate.covariance).dot(along) + v.dot(noise).dot(v))))


def is_linear_cosine(estimate: Estimate, cosine: float, s_body: Vec3, row: Matrix, sigma: float) -> bool:
    """The same of a cell that sees the Sun at an angle with this cosine.

    Args:
        estimate: of this tick.
        cosine: of the angle between its normal and the Sun.
        s_body: to the Sun, a unit vector.
        row: H of the cell, (1, n).
        sigma: of its white noise, fraction of full sunlight.
    """
    variance = float(row[0].dot(estimate.covariance).dot(row[0])) + sigma**2
    left_out = 0.5 * SIGMAS * abs(cosine) * across_variance(estimate, s_body)
    return left_out <= sqrt(max(0.0, variance))
