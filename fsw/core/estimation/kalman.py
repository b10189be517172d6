"""filterpy's Kalman filter without the copies that it keeps for inspection, for mostly constant states.

With it, a trace of what unmodelled deviations would do to errors and innovations (Friedland 1969).
"""

import struct
from math import nan
from typing import NamedTuple

import numpy as np
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray
from scipy.linalg.lapack import dgesv

Matrix = NDArray[np.float64]


class LeanKalmanFilter(KalmanFilter):  # type: ignore[misc]  # filterpy has no types
    """filterpy's ``KalmanFilter`` for one prediction or one update of an error state, which is zero before.

    The operations of ``predict`` and ``update`` are filterpy's own, x = 0:

        predict  P <- F P F^T + Q
        update   y = z,  S = H P H^T + R,  K = P H^T S^-1,
                 x <- K y,  P <- (1 - K H) P (1 - K H)^T + K R K^T

    Most states are constants: only the first rows of F differ from those of the identity, and only they are
    given. The triple product in the update is expanded from the left, then from the right, so that no
    product of two (n, n) matrices is needed. There is no fading memory, no control input, and no copy of
    prior, posterior and measurement; the constructor allocates nothing, while filterpy's takes longer than a
    prediction. No method changes an array in place, so arrays may be shared. The likelihoods are filterpy's.

    Attributes:
        x: error state after an update, (n).
        P: its covariance, (n, n).
        y: innovation of the update, (m).
        K: gain, (n, m).
        SI: inverse of the innovation's covariance, (m, m).
    """

    _log_likelihood = _likelihood = _mahalanobis = None
    """Not computed yet: filterpy computes each when it is read."""

    def __init__(self, P: Matrix) -> None:
        self.P = P

    def predict(self, *, F: Matrix, Q: Matrix) -> None:
        """Carry the covariance over a step.

        Args:
            F: the first rows of the transition, (k, n); the others are those of the identity.
            Q: process noise, (n, n).
        """
        moving = len(F)
        covariance, rows = self.P.copy(), F.dot(self.P)
        covariance[:moving, :moving] = rows.dot(F.T)
        covariance[:moving, moving:] = crossed = rows[:, moving:]
        covariance[moving:, :moving] = crossed.T
        covariance += Q
        self.P = covariance

    def update(self, z: Matrix, R: Matrix, H: Matrix, considered: slice | None = None) -> None:
        """Take a measurement z, (m), with noise R, (m, m), and sensitivity H, (m, n).

        States that are ``considered`` keep their values: their rows of K are zero, and P remains the
        covariance of the errors (Schmidt 1966).
        """
        self.y = z
        pht = self.P.dot(H.T)
        self.S = H.dot(pht) + R
        self.SI = inverse(self.S)
        self.K = pht.dot(self.SI)
        if considered is not None:
            self.K[considered] = 0.0
        self.x = self.K.dot(z)
        left = self.P - self.K.dot(pht.T)
        self.P = left - left.dot(H.T).dot(self.K.T) + self.K.dot(R).dot(self.K.T)


_UNITS = {size: np.eye(size) for size in (1, 3, 6)}


def inverse(m: Matrix) -> Matrix:
    """The inverse by LAPACK alone, in a fifth of numpy's time; NaN if it is singular, where numpy raises."""
    _, _, inverted, failure = dgesv(m, _UNITS[len(m)])
    return np.full_like(m, np.nan) if failure else inverted


class Cause(NamedTuple):
    """A deviation: its number, and the fraction of a unit that the filter took into account.

    ``uncertain``: relative standard deviation of a unit that no measurement reduces.
    """

    number: int
    assumed: float
    uncertain: float


class Trace(NamedTuple):
    """What unmodelled deviations would do to the errors and innovations of the filter.

    ``causes``: the k deviations. ``effect`` (n, k + 1): what a unit of each leaves in the error state; the
    last column only makes room for the innovation. ``sums`` (k + 1, k + 1): t^T S^-1 t over all updates, t
    being the effects on the measurement, the innovation last; ``measured``: how many numbers were measured.
    """

    causes: tuple[Cause, ...]
    effect: Matrix
    sums: Matrix
    measured: int

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers of the causes."""
        return tuple([cause.number for cause in self.causes])

    def packed(self) -> bytes:
        """For the checksum of the state."""
        shape = "<q" + "q2d" * len(self.causes)
        causes = struct.pack(shape, self.measured, *[number for cause in self.causes for number in cause])
        return causes + self.effect.tobytes() + self.sums.tobytes()


def carried(trace: Trace, transition: Matrix) -> Trace:
    """The trace after a prediction with this transition, (6, n)."""
    effect = trace.effect.copy()
    effect[0:6] = transition.dot(trace.effect)
    return trace._replace(effect=effect)


def unexplained(sums: Matrix) -> float:
    """The summed NIS that no deviation explains, the prior of each deviation being 0 +- 1.

    What an update adds is its NIS in a filter that solves for the deviations too. NaN of damaged sums.
    """
    evidence = sums[:-1, -1]
    try:
        explained = evidence.dot(np.linalg.solve(sums[:-1, :-1] + np.eye(len(evidence)), evidence))
    except np.linalg.LinAlgError:
        return nan
    return float(sums[-1, -1] - explained)
