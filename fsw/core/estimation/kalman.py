"""The matrices of the Kalman filter: prediction, update, and the products beside them.

Two algebras compute the same: a small kernel in C, whose sums have a fixed order, so that a log replays to
the same bits on every machine; and filterpy's ``KalmanFilter``, the reference, which also flies where the
kernel is not built. The error state is zero before each prediction and each update:

    predict  P <- F P F^T + Q
    update   S = H P H^T + R,  K = P H^T S^-1,  x = K y,  P <- (1 - K H) P (1 - K H)^T + K R K^T

No function changes an array in place, so arrays may be shared. P is symmetric and stays exactly so.

With them, a trace of what unmodelled deviations would do to errors and innovations (Friedland 1969).
"""

from dataclasses import dataclass
from enum import StrEnum
from math import nan
from typing import final

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]


try:
    from fsw.core.estimation import _kalman_kernel as _kernel
except ImportError:  # it is not built
    _kernel = None  # type: ignore[assignment]


class Algebra(StrEnum):
    """What computes the filter's matrices."""

    KERNEL = "kernel"
    FILTERPY = "filterpy"


def available(wanted: Algebra) -> Algebra:
    """The algebra that flies where this one is wanted: filterpy's where the kernel is not built."""
    return wanted if _kernel is not None else Algebra.FILTERPY


@final
class Update:
    """What an update gives.

    Attributes:
        error: x, the error state, (n).
        covariance: P, (n, n).
        gain: K, (n, m).
        spread: S, the covariance of the innovation, (m, m).
        weight: S^-1, (m, m).
    """

    __slots__ = ("covariance", "error", "gain", "spread", "weight")

    def __init__(
        self, error: Matrix, covariance: Matrix, gain: Matrix, spread: Matrix, weight: Matrix
    ) -> None:
        self.error = error
        self.covariance = covariance
        self.gain = gain
        self.spread = spread
        self.weight = weight


def predict(covariance: Matrix, transition: Matrix, noise: Matrix, algebra: Algebra) -> Matrix:
    """The covariance P after a step, (n, n).

    Args:
        covariance: before, (n, n).
        transition: the first rows of F, (k, n); the others are those of the identity.
        noise: Q, (n, n).
        algebra: what computes it.
    """
    if algebra is Algebra.KERNEL and _kernel is not None:
        return _kernel.predict(covariance, transition, noise)
    from fsw.core.estimation import filterpy_algebra  # noqa: PLC0415  (slow to load, and seldom flown)

    return filterpy_algebra.predict(covariance, transition, noise)


def update(
    covariance: Matrix,
    innovation: tuple[float, ...],
    noise: Matrix,
    sensitivity: Matrix,
    considered: slice | None,
    algebra: Algebra,
) -> Update | None:
    """The update by a measurement; None where the covariance of its innovation is singular.

    Args:
        covariance: P before, (n, n).
        innovation: y, (m).
        noise: R, (m, m).
        sensitivity: H, (m, n).
        considered: states that keep their values: their rows of K are zero, and P remains the covariance of
            the errors (Schmidt 1966).
        algebra: what computes it.
    """
    if algebra is Algebra.KERNEL and _kernel is not None:
        first, last = (considered.start, considered.stop) if considered is not None else (0, 0)
        found = _kernel.update(covariance, innovation, noise, sensitivity, first, last)
        return None if found is None else Update(*found)
    from fsw.core.estimation import filterpy_algebra  # noqa: PLC0415  (slow to load, and seldom flown)

    by_filterpy = filterpy_algebra.update(covariance, innovation, noise, sensitivity, considered)
    return None if by_filterpy is None else Update(*by_filterpy)


def product(left: Matrix, right: Matrix) -> Matrix:
    """The product of two matrices, (k, m) and (m, n)."""
    return left.dot(right) if _kernel is None else _kernel.product(left, right)


def combine(numbers: tuple[float, ...], rows: Matrix) -> Matrix:
    """The sum of each number times its row, (n), of rows (k, n)."""
    return np.array(numbers).dot(rows) if _kernel is None else _kernel.combine(numbers, rows)


def inverse(m: Matrix) -> Matrix:
    """The inverse; NaN where it is singular."""
    if _kernel is None:
        try:
            return np.asarray(np.linalg.inv(m), float)
        except np.linalg.LinAlgError:
            return np.full_like(m, nan)
    found = _kernel.inverse(m)
    return np.full_like(m, nan) if found is None else found


@final
@dataclass(frozen=True, slots=True)
class Cause:
    """A deviation: its number, and the fraction of a unit that the filter took into account.

    ``uncertain``: relative standard deviation of a unit that no measurement reduces.
    """

    number: int
    assumed: float
    uncertain: float


@final
@dataclass(slots=True)
class Trace:
    """What unmodelled deviations would do to the errors and innovations of the filter.

    ``causes``: the k deviations. ``effect`` (n, k + 1): what a unit of each leaves in the error state; the
    last column only makes room for the innovation. ``sums`` (k + 1, k + 1): t^T S^-1 t over all updates, t
    being the effects on the measurement, the innovation last; ``measured``: how many numbers were measured.
    """

    causes: tuple[Cause, ...]
    effect: Matrix
    sums: Matrix
    measured: int

    def copy(self) -> "Trace":
        """A trace that goes on by itself from here; the arrays are shared, since none is changed."""
        return Trace(self.causes, self.effect, self.sums, self.measured)

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers of the causes."""
        return tuple([cause.number for cause in self.causes])


def carry_trace(trace: Trace, transition: Matrix) -> None:
    """Carry the trace over a prediction with this transition, (6, n)."""
    effect = trace.effect.copy()
    effect[0:6] = product(transition, trace.effect)
    trace.effect = effect


def unexplained(sums: Matrix) -> float:
    """The summed NIS that no deviation explains, the prior of each deviation being 0 +- 1.

    What an update adds is its NIS in a filter that solves for the deviations too. NaN of damaged sums.
    """
    evidence = sums[:-1, -1:]
    weights = inverse(sums[:-1, :-1] + np.eye(len(evidence)))
    return float(sums[-1, -1] - product(evidence.T, product(weights, evidence))[0, 0])
