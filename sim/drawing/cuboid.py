"""A body as it is drawn: the sides of a cuboid that has its inertia."""

import numpy as np

from sim.value_types import Array

LEAST_SIDE = 0.3
"""Shortest side of the body as it is drawn, relative to its longest."""


def sides(inertia_kgm2: Array) -> Array:
    """The sides of a cuboid of uniform density with these moments of inertia, the longest 1, (3,).

    J_1 = m (a_2^2 + a_3^2) / 12 and so on, thus a_1^2 ~ J_2 + J_3 - J_1; none is drawn very short.
    """
    moments = np.diag(inertia_kgm2)
    squares = np.maximum(moments.sum() - 2.0 * moments, 0.0)
    result: Array = np.maximum(np.sqrt(squares / squares.max()), LEAST_SIDE).round(3)
    return result
