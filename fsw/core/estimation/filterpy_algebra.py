"""Prediction and update by filterpy: the reference of the kernel, which also flies where there is none."""

import numpy as np
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray

Matrix = NDArray[np.float64]


def predict(covariance: Matrix, transition: Matrix, noise: Matrix) -> Matrix:
    """As in ``kalman``."""
    size = len(covariance)
    kalman, whole = KalmanFilter(dim_x=size, dim_z=1), np.eye(size)
    whole[: len(transition)] = transition
    kalman.P = covariance
    kalman.predict(F=whole, Q=noise)
    return _symmetric(kalman.P)


def update(
    covariance: Matrix,
    innovation: tuple[float, ...],
    noise: Matrix,
    sensitivity: Matrix,
    considered: slice | None,
) -> tuple[Matrix, Matrix, Matrix, Matrix, Matrix] | None:
    """Error, covariance, gain, spread and weight, as in ``kalman``.

    filterpy considers no states; with some, the covariance is Joseph's with the gain that is left.
    """
    kalman = KalmanFilter(dim_x=len(covariance), dim_z=len(innovation))
    kalman.x, kalman.P = np.zeros(len(covariance)), covariance
    try:
        kalman.update(np.array(innovation), noise, sensitivity)
    except np.linalg.LinAlgError:
        return None
    error, after, gain = kalman.x, kalman.P, kalman.K
    if considered is not None:
        gain[considered] = 0.0
        error, remains = gain.dot(innovation), np.eye(len(covariance)) - gain.dot(sensitivity)
        after = remains.dot(covariance).dot(remains.T) + gain.dot(noise).dot(gain.T)
    return error, _symmetric(after), gain, kalman.S, kalman.SI


def _symmetric(covariance: Matrix) -> Matrix:
    return 0.5 * (covariance + covariance.T)
