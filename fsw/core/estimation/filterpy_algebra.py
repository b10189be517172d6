"""What the kernel computes, by filterpy and numpy: its reference, which also flies where there is none.

The functions are those of ``_kalman_kernel``; what they compute is described in ``kalman``.
"""

from math import inf

import numpy as np
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray

from fsw.core.estimation.components import crossed, directions_in_body, multiplied

Matrix = NDArray[np.float64]
Numbers = tuple[float | tuple[float, ...], ...]

MOVING = 6


def predict(covariance: Matrix, transition: Matrix, noise: Matrix, kicks: Numbers) -> Matrix:
    """Covariance after a step."""
    size = len(covariance)
    kalman, whole, whole_noise = KalmanFilter(dim_x=size, dim_z=1), np.eye(size), noise.copy()
    whole[: len(transition)] = transition
    for kick in _flat(kicks).reshape(-1, 3):
        whole_noise[3:6, 3:6] += np.outer(kick, kick)
    kalman.P = covariance
    kalman.predict(F=whole, Q=whole_noise)
    return _symmetric(kalman.P)


def update(
    covariance: Matrix,
    innovation: tuple[float, ...],
    noise: Matrix,
    sensitivity: Matrix,
    first: int,
    last: int,
    effect: Matrix | None,
    sums: Matrix | None,
) -> tuple[tuple[float, ...], Matrix, tuple[float, ...], float, Matrix | None, Matrix | None] | None:
    """Error, covariance, variances, NIS, effect and sums; None where the spread is singular.

    filterpy considers no states; with some, the covariance is Joseph's with the gain that is left.
    """
    kalman, y = KalmanFilter(dim_x=len(covariance), dim_z=len(innovation)), np.array(innovation)
    kalman.x, kalman.P = np.zeros(len(covariance)), covariance
    try:
        kalman.update(y, noise, sensitivity)
    except np.linalg.LinAlgError:
        return None
    error, after, gain = kalman.x, kalman.P, kalman.K
    if last > first:
        gain[first:last] = 0.0
        error, remains = gain.dot(y), np.eye(len(covariance)) - gain.dot(sensitivity)
        after = remains.dot(covariance).dot(remains.T) + gain.dot(noise).dot(gain.T)
    nis = float(y.dot(kalman.SI).dot(y))
    if effect is not None and sums is not None:
        traced = sensitivity.dot(effect)
        traced[:, -1] = innovation
        effect, sums = effect - gain.dot(traced), sums + traced.T.dot(kalman.SI).dot(traced)
    return tuple(error.tolist()), _symmetric(after), diagonal(kalman.S), nis, effect, sums


def product(left: Matrix, right: Matrix) -> Matrix:
    """Product of two matrices."""
    result: Matrix = left.dot(right)
    return result


def inverse(m: Matrix) -> Matrix:
    """Inverse, NaN of a singular matrix."""
    try:
        return np.asarray(np.linalg.inv(m), float)
    except np.linalg.LinAlgError:
        return np.full_like(m, np.nan)


def linear(
    constant: Matrix,
    numbers: Numbers,
    rows: Matrix,
    others: Numbers = (),
    other_rows: Matrix | None = None,
) -> Matrix:
    """Constant, its first columns plus the sum of each number times its row."""
    total = _flat(numbers).dot(rows)
    if other_rows is not None:
        total = total + _flat(others).dot(other_rows)
    result, part = constant.copy(), total.reshape(len(constant), -1)
    result[:, : part.shape[1]] += part
    return result


def sensitivity(
    constant: Matrix, directions: Numbers, omega: Numbers, ages_s: Numbers, places: tuple[int, ...]
) -> Matrix:
    """Rows of H of sensors that see directions."""
    rows, rate = constant.copy(), _flat(omega)
    for sensor, (u, age_s) in enumerate(zip(_flat(directions).reshape(-1, 3), ages_s, strict=True)):
        own, (age, turn, scale) = rows[3 * sensor : 3 * sensor + 3], places[3 * sensor : 3 * sensor + 3]
        since = age_s * rate
        own[:, 0:3] += _skew(u) + np.outer(since, u) - u.dot(since) * np.eye(3)
        if age >= 0:
            own[:, age] += np.cross(rate, u)
            own[:, 3:6] -= age_s * _skew(u)
        if turn >= 0:
            own[:, turn : turn + 3] += _skew(u)
        if scale >= 0:
            own[:, scale : scale + 3] += np.diag(u)
    return rows


def system_rows(constant: Matrix, turn: Numbers, inverse_h: Numbers, torque: Matrix) -> Matrix:
    """Rows of attitude and rate of 1 + A h."""
    rows = constant.copy()
    x, y, z = _flat(turn).tolist()
    rows[0:3, 0:3] = ((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0))
    rows[3:6, : torque.shape[1]] = _flat(inverse_h).reshape(3, 3).dot(torque)
    rows[:, 0:MOVING] += np.eye(MOVING)
    return rows


def series(rows: Matrix, order: int) -> Matrix:
    """Rows of attitude and rate of exp(A h) from those of 1 + A h, to this order."""
    identity = np.eye(*rows.shape)
    change = rows - identity
    total = change
    for place in range(order, 1, -1):
        total = change + change[:, 0:MOVING].dot(total) / place
    result: Matrix = total + identity
    return result


def diagonal(m: Matrix) -> tuple[float, ...]:
    """Numbers on the diagonal."""
    return tuple(m.diagonal().tolist())


def total_variance(covariance: Matrix, uncertain: int) -> float:
    """Sum of the variances, infinite where one is impossible."""
    variances = covariance.diagonal()
    impossible = (variances < 0.0).any() or not variances[:uncertain].all()
    return inf if impossible else float(variances.sum())


def largest_variance(covariance: Matrix, first: int, last: int) -> float:
    """Largest variance of some states."""
    return float(max(covariance.diagonal()[first:last]))


def carry_trace(effect: Matrix, transition: Matrix) -> Matrix:
    """Effect after a prediction."""
    after = effect.copy()
    after[: len(transition)] = transition.dot(effect)
    return after


def move_bodies(
    x: Matrix,
    step_s: float,
    acting: Numbers,
    dipoles_am2: Matrix,
    torques_nm: Matrix,
    inertias_kgm2: Matrix,
    responses: Matrix,
) -> Matrix:
    """Attitude and rate of many bodies after a step."""
    numbers, h = _flat(acting), step_s
    seen, wheel, gravity = numbers[0:6].reshape(2, 3, 1), numbers[6:9, None], numbers[9]
    inertia, response = inertias_kgm2.reshape(3, 3, -1), responses.reshape(3, 3, -1)

    def rates(x: Matrix) -> Matrix:
        scalar, vector, omega = x[0], x[1:4], x[4:7]
        e1, b = directions_in_body(scalar, vector, seen)
        turned = (inertia * np.stack((e1, omega))[:, None]).sum(axis=2)
        first = np.stack((gravity * e1, -omega, dipoles_am2))
        second = np.stack((turned[0], turned[1] + wheel, b))
        torque = crossed(first, second).sum(axis=0) + torques_nm
        q_rate = multiplied(scalar, vector, 0.5 * omega)
        return np.vstack((*q_rate, (response * torque).sum(axis=1)))

    k1 = rates(x)
    k2 = rates(x + 0.5 * h * k1)
    k3 = rates(x + 0.5 * h * k2)
    k4 = rates(x + h * k3)
    moved: Matrix = x + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
    moved[:4] /= np.sqrt((moved[:4] * moved[:4]).sum(axis=0))
    return moved


def unexplained(sums: Matrix) -> float:
    """The summed NIS that no deviation explains."""
    evidence = sums[:-1, -1]
    weights = inverse(sums[:-1, :-1] + np.eye(len(evidence)))
    return float(sums[-1, -1] - evidence.dot(weights).dot(evidence))


def turn_along(
    covariance: Matrix, error: Numbers, first: int, factor: float, coordinates: Matrix, moving: Matrix
) -> Matrix:
    """The covariance turned with directions that no sample shows."""
    moved = slice(first, first + len(moving))
    turns = _flat(error)[moved].dot(moving).reshape(-1, len(coordinates))
    turns[:, -1] *= factor
    turn = np.eye(len(covariance))
    turn[moved] += turns.dot(coordinates)
    return _symmetric(turn.dot(covariance).dot(turn.T))


def move_along(covariance: Matrix, change: Numbers, first: int) -> Matrix:
    """The covariance with the mean of two states carried along a change of the first six."""
    turn = np.eye(len(covariance))
    turn[0:MOVING, first : first + 2] += 0.5 * _flat(change)[:, None]
    return _symmetric(turn.dot(covariance).dot(turn.T))


def fade(covariance: Matrix, prior: Matrix, first: int, last: int, keep: float) -> Matrix:
    """The covariance with some states decayed."""
    left = np.ones(len(covariance))
    left[first:last] = keep
    decayed: Matrix = np.outer(left, left) * covariance
    own = range(first, last)
    decayed[own, own] += (1.0 - keep * keep) * prior.diagonal()[first:last]
    return decayed


def shear(covariance: Matrix, change: Matrix, places: tuple[int, ...]) -> Matrix:
    """The covariance with a change of some rows of T from those of the identity."""
    turn = np.eye(len(covariance))
    turn[list(places)] += change
    return _symmetric(turn.dot(covariance).dot(turn.T))


def _skew(u: Matrix) -> Matrix:
    return np.cross(u, np.eye(3)).T


def _flat(numbers: Numbers) -> Matrix:
    return np.concatenate([np.atleast_1d(np.array(part, float)) for part in numbers] or [np.zeros(0)])


def _symmetric(covariance: Matrix) -> Matrix:
    result: Matrix = 0.5 * (covariance + covariance.T)
    return result
