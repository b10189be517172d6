"""The sensitivity of a sensor that sees a direction, as a linear map."""

import numpy as np

from fsw.core.algebra.vector import skew
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.parameters import Layout

_BY_ATTITUDE, _DIRECTION, _PASSING, _SINCE = slice(0, 9), slice(9, 12), slice(12, 15), slice(15, 18)
_NUMBERS = 18
_AXES = np.eye(3)
_SKEW = np.array([skew((x, y, z)) for x, y, z in _AXES.tolist()]).transpose(1, 2, 0)


def sensitivity_map(parts: Layout, sensor: int, turn: slice | None, scale: slice | None) -> Matrix:
    """The map to the entries of H, (3, n), by rows, from 18 numbers, (18, 3 n).

    They are the derivative by the attitude (9) and the components of the direction u as the sensor sees it,
    of omega x u, and of -delay u; body axes.

    Args:
        parts: layout of the error state.
        sensor: its place among the ages of the samples.
        turn: place of its misalignment.
        scale: place of its scale errors.
    """
    rows = np.zeros((3, parts.size, _NUMBERS))
    rows[:, 0:3, _BY_ATTITUDE] = np.eye(9).reshape(3, 3, 9)
    if parts.delay is not None:
        rows[:, parts.delay.start + sensor, _PASSING] = _AXES
        rows[:, 3:6, _SINCE] = _SKEW
    if turn is not None:
        rows[:, turn, _DIRECTION] = _SKEW
    if scale is not None:
        rows[:, scale, _DIRECTION] = _AXES[:, :, None] * _AXES[:, None]
    return np.ascontiguousarray(rows.reshape(-1, _NUMBERS).T)
