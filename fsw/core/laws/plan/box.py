"""A quadratic programme in a box, by projected Newton steps.

    min 1/2 m^T H m + g^T m   over   |m_i| <= most,     H positive definite.

Each step holds the components that lie at a limit and are pushed against it, solves for the others, cuts what
goes beyond the limits, and is halved until the cost falls. It ends at the minimum after about as many steps
as sets of held components change.

Source: Bertsekas 1982, Projected Newton methods for optimization problems with simple constraints.
"""

import numpy as np

from fsw.core.laws.plan.riccati import Array

STEPS, HALVINGS = 60, 30
SETTLED = 1e-10
"""Largest slope at the end, relative to that at zero."""
FALL = 1e-4
"""Fraction of the decrease that the slope promises which a step must achieve."""


def box_minimum(h: Array, g: Array, most: float) -> Array:
    """The minimum, shape (n,).

    Args:
        h: H, shape (n, n), symmetric and positive definite.
        g: shape (n,).
        most: the limit, positive.
    """
    m: Array = np.clip(np.linalg.solve(h, -g), -most, most)
    enough = SETTLED * float(np.abs(g).max(initial=0.0))
    for _ in range(STEPS):
        slope = h @ m + g
        free = ~(((m >= most) & (slope < 0.0)) | ((m <= -most) & (slope > 0.0)))
        if np.abs(slope[free]).max(initial=0.0) <= enough:
            break
        change = np.zeros_like(m)
        change[free] = np.linalg.solve(h[np.ix_(free, free)], -slope[free])
        moved = _lower(h, slope, m, change, most)
        if moved is None:
            break
        m = moved
    return m


def _lower(h: Array, slope: Array, m: Array, change: Array, most: float) -> Array | None:
    """The first of the halved steps that lowers the cost; None if none does."""
    part = 1.0
    for _ in range(HALVINGS):
        moved = np.clip(m + part * change, -most, most)
        by = moved - m
        promised = float(slope @ by)
        if promised + 0.5 * float(by @ h @ by) <= FALL * promised < 0.0:
            return moved
        part *= 0.5
    return None
