"""Algebra of many attitudes and vectors at once, by components along the last axis but one."""

import numpy as np
from numpy.typing import NDArray

Components = NDArray[np.float64]

AFTER, BEFORE = [1, 2, 0], [2, 0, 1]
"""The axes after and before each one."""


def directions_in_body(scalar: Components, vector: Components, directions: Components) -> Components:
    """Directions, (k, 3, 1), seen in the body at each attitude, (k, 3, n)."""
    along = (directions * vector).sum(axis=1)[:, None]
    square = scalar * scalar - (vector * vector).sum(axis=0)
    turned: Components = square * directions + 2.0 * (along * vector - scalar * crossed(vector, directions))
    return turned


def crossed(a: Components, b: Components) -> Components:
    """The cross products."""
    product: Components = a[..., AFTER, :] * b[..., BEFORE, :] - a[..., BEFORE, :] * b[..., AFTER, :]
    return product


def multiplied(scalar: Components, vector: Components, v: Components) -> tuple[Components, Components]:
    """Scalar and vector of q (x) (0, v)."""
    return -(vector * v).sum(axis=0), scalar * v + crossed(vector, v)
