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
from typing import final

import numpy as np
from numpy.typing import NDArray

from fsw.core.algebra.vector import Vec3

Matrix = NDArray[np.float64]
Numbers = tuple[float | tuple[float, ...], ...]
"""Numbers in a row, some of which may be in tuples of their own."""

try:
    from fsw.core.estimation import _kalman_kernel as _kernel

    BUILT = True
except ImportError:
    from fsw.core.estimation import filterpy_algebra as _kernel  # type: ignore[no-redef]

    BUILT = False


class Algebra(StrEnum):
    """What computes the filter's matrices."""

    KERNEL = "kernel"
    FILTERPY = "filterpy"


def available(wanted: Algebra) -> Algebra:
    """The algebra that flies where this one is wanted: filterpy's where the kernel is not built."""
    return wanted if BUILT else Algebra.FILTERPY


@final
class Update:
    """What an update gives.

    Attributes:
        error: x, the error state, (n).
        covariance: P, (n, n).
        variances: of the innovation, the diagonal of S, (m).
        nis: the normalised innovation squared, y^T S^-1 y.
        effect, sums: of a trace that goes with it; None without one.
    """

    __slots__ = ("covariance", "effect", "error", "nis", "sums", "variances")

    def __init__(
        self,
        error: tuple[float, ...],
        covariance: Matrix,
        variances: tuple[float, ...],
        nis: float,
        effect: Matrix | None,
        sums: Matrix | None,
    ) -> None:
        self.error = error
        self.covariance = covariance
        self.variances = variances
        self.nis = nis
        self.effect = effect
        self.sums = sums


def predict(
    covariance: Matrix, transition: Matrix, noise: Matrix, kicks: Numbers, algebra: Algebra
) -> Matrix:
    """The covariance P after a step, (n, n).

    Args:
        covariance: before, (n, n).
        transition: the first rows of F, (k, n); the others are those of the identity.
        noise: Q, (n, n), without the kicks.
        kicks: vectors v, at most three, each of which adds v v^T to the block of the rate in Q.
        algebra: what computes it.
    """
    if algebra is Algebra.KERNEL:
        return _kernel.predict(covariance, transition, noise, kicks)
    from fsw.core.estimation import filterpy_algebra  # noqa: PLC0415  (slow to load, and seldom flown)

    return filterpy_algebra.predict(covariance, transition, noise, kicks)


def update(
    covariance: Matrix,
    innovation: tuple[float, ...],
    noise: Matrix,
    sensitivity: Matrix,
    considered: slice | None,
    algebra: Algebra,
    trace: "Trace | None" = None,
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
        trace: to be carried along, u - K t and sums + t^T S^-1 t, t being H u and, last, the innovation; it
            stays as it is.
    """
    first, last = 0, 0
    if considered is not None:
        first, last = considered.start, considered.stop
    effect: Matrix | None = None
    sums: Matrix | None = None
    if trace is not None:
        effect, sums = trace.effect, trace.sums
    if algebra is Algebra.KERNEL:
        found = _kernel.update(covariance, innovation, noise, sensitivity, first, last, effect, sums)
    else:
        from fsw.core.estimation import filterpy_algebra  # noqa: PLC0415  (slow to load, and seldom flown)

        found = filterpy_algebra.update(covariance, innovation, noise, sensitivity, first, last, effect, sums)
    if found is None:
        return None
    error, after, variances, nis, effect, sums = found
    return Update(error, after, variances, nis, effect, sums)


def product(left: Matrix, right: Matrix) -> Matrix:
    """The product of two matrices, (k, m) and (m, n)."""
    return _kernel.product(left, right)


def inverse(m: Matrix) -> Matrix:
    """The inverse; NaN where it is singular."""
    return _kernel.inverse(m)


def diagonal(m: Matrix) -> tuple[float, ...]:
    """The numbers on the diagonal."""
    return _kernel.diagonal(m)


def total_variance(covariance: Matrix, uncertain: int) -> float:
    """The sum of the variances; infinite where one is negative, or one of the first ``uncertain`` zero."""
    return _kernel.total_variance(covariance, uncertain)


def largest_variance(covariance: Matrix, first: int, last: int) -> float:
    """The largest variance of the states from first to last."""
    return _kernel.largest_variance(covariance, first, last)


def linear(constant: Matrix, numbers: Numbers, rows: Matrix) -> Matrix:
    """A matrix that is linear in some numbers, (r, n), in its first w columns.

    Args:
        constant: what it is where all of them are zero, (r, n).
        numbers: (k).
        rows: what it gains by each, a matrix (r, w) by rows, (k, r w).
    """
    return _kernel.linear(constant, numbers, rows)


def bilinear(constant: Matrix, numbers: Numbers, rows: Matrix, others: Numbers, other_rows: Matrix) -> Matrix:
    """As ``linear``, by two groups of numbers, each with its rows."""
    return _kernel.linear(constant, numbers, rows, others, other_rows)


def sensitivity(
    constant: Matrix, directions: Numbers, omega: Vec3, ages_s: tuple[float, ...], places: tuple[int, ...]
) -> Matrix:
    """H of sensors that see directions u, (3 s, n), to first order in their ages.

    By the attitude when the sample was taken it is [u x]. By the attitude now, w being the rotation since,
    [u x] (1 + [w x]) = [u x] + w u^T - (u . w) 1. Along the rate it is exactly minus the derivative by the
    age, omega x u: no sample can tell the two apart.

    Args:
        constant: its constant part.
        directions: as each of the s sensors sees it, body axes.
        omega: rate, body axes.
        ages_s: of their samples.
        places: three for each sensor, as in ``MekfConfig``.
    """
    return _kernel.sensitivity(constant, directions, omega, ages_s, places)


def system_rows(constant: Matrix, turn: Vec3, inverse_h: Numbers, torque: Matrix) -> Matrix:
    """The rows of attitude and rate of 1 + A h, (6, n), A being the system matrix and h the step.

    Args:
        constant: what they are but for the following, (6, n).
        turn: -h omega, of which the derivative by the attitude consists.
        inverse_h: h J^-1 by rows.
        torque: the torque's derivative by the first w numbers of the error state, (3, w).
    """
    return _kernel.system_rows(constant, turn, inverse_h, torque)


def series(rows: Matrix, order: int) -> Matrix:
    """The rows of attitude and rate of exp(A h), from those of 1 + A h, (6, n), to second or fourth order.

    All other rows of A are zero. To second order: half of 1 + (1 + A h)^2.
    """
    return _kernel.series(rows, order)


def turn_along(
    covariance: Matrix,
    error: tuple[float, ...],
    first: int,
    factor: float,
    coordinates: Matrix,
    moving: Matrix,
) -> Matrix:
    """The covariance T P T^T, T = 1 + D W^T, symmetric.

    Args:
        covariance: P, (n, n).
        error: a correction, (n).
        first: number of the first row of D, (n, k), that is not zero; there are m.
        factor: of the last column of D.
        coordinates: W^T, (k, n), k at most 4.
        moving: what those rows gain per unit of each of the m numbers of the correction in their place, by
            rows, (m, m k).
    """
    return _kernel.turn_along(covariance, error, first, factor, coordinates, moving)


def move_along(covariance: Matrix, change: Numbers, first: int) -> Matrix:
    """The covariance with d e^T added to the error state's first rows, d being a change of them, (6).

    e is the mean of two states, at the place ``first`` and the next, that stay what they are.
    """
    return _kernel.move_along(covariance, change, first)


def fade(covariance: Matrix, prior: Matrix, place: slice, keep: float) -> Matrix:
    """The covariance after a decay of some states by this factor, their variances nearer to the prior's."""
    return _kernel.fade(covariance, prior, place.start, place.stop, keep)


def shear(covariance: Matrix, change: Matrix, places: tuple[int, ...]) -> Matrix:
    """The covariance T P T^T, symmetric, T being 1 with a change (k, n) of its rows at these k places."""
    return _kernel.shear(covariance, change, places)


def move_bodies(
    x: Matrix,
    step_s: float,
    acting: Numbers,
    dipoles_am2: Matrix,
    torques_nm: Matrix,
    inertias_kgm2: Matrix,
    responses: Matrix,
) -> Matrix:
    """Attitude and rate of many rigid bodies, (7, n), after a step of the fourth-order Runge-Kutta method.

        dq/dt = 1/2 q (0, w),  J dw/dt = m x b + 3 mu/r^3 e1 x J e1 - w x (J w + h) + torque

    Args:
        x: before, (7, n).
        step_s: length of the step.
        acting: on all of them: e1 and b, T, eci; h, N m s, body axes; 3 mu/r^3, 1/s^2.
        dipoles_am2: m, body axes, (3, n).
        torques_nm: body axes, (3, n).
        inertias_kgm2: J by rows, (9, n).
        responses: to a torque, J^-1 by rows, (9, n).
    """
    return _kernel.move_bodies(x, step_s, acting, dipoles_am2, torques_nm, inertias_kgm2, responses)


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
    """Carry the trace over a prediction with this transition, (k, n): the first rows of F."""
    trace.effect = _kernel.carry_trace(trace.effect, transition)


def unexplained(sums: Matrix) -> float:
    """The summed NIS that no deviation explains, the prior of each deviation being 0 +- 1.

    What an update adds is its NIS in a filter that solves for the deviations too. NaN of damaged sums.
    """
    return _kernel.unexplained(sums)
