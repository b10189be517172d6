"""The explicit form of predictive control within limits: its pieces, and how many there are.

The programme of ``mpc_box`` depends on the state through g = G x. Where the same dipoles lie at the same
limits, the solution is one linear function of the state,

    m_free = -H_ff^-1 (G_f x + H_fh m_held),    m_held = +- m_max,

so that the law could be tabulated: a set of held components, its gain, and the region of states for which it
holds. The pieces met by states drawn from a box are counted. They are for one field only: along the orbit the
field changes, and each step of it needs a table of its own.

Source: Krogstad, Gravdahl, Tondel 2005, as in Ovchinnikov, Roldugin 2019, section 3.3; the explicit form:
Bemporad, Morari, Dua, Pistikopoulos 2002.
"""

from typing import NamedTuple

import numpy as np

from fsw.core.laws.plan.box import box_minimum
from fsw.core.laws.plan.riccati import Array

Held = tuple[int, ...]
"""For each component -1, 0 or 1: at the lower limit, free, at the upper one."""
AT_LIMIT = 1e-9


class Piece(NamedTuple):
    """A linear piece, m = gain x + offset."""

    gain: Array
    offset: Array


def held_of(m: Array, most: float) -> Held:
    """Which components of a solution lie at a limit."""
    return tuple(int(side) for side in np.sign(m) * (np.abs(m) >= most * (1.0 - AT_LIMIT)))


def piece(h: Array, g: Array, held: Held, most: float) -> Piece:
    """The linear piece of a set of held components.

    Args:
        h: H, shape (n, n).
        g: G, shape (n, states): the linear part of the programme is G x.
        held: the set.
        most: the limit.
    """
    sides = np.array(held, dtype=np.float64)
    free = sides == 0.0
    gain, offset = np.zeros_like(g), most * sides
    inner = h[np.ix_(free, free)]
    gain[free] = -np.linalg.solve(inner, g[free])
    offset[free] = -np.linalg.solve(inner, h[np.ix_(free, ~free)] @ offset[~free])
    return Piece(gain, offset)


def pieces(h: Array, g: Array, states: Array, most: float) -> dict[Held, Piece]:
    """The pieces that are met by states, shape (k, states)."""
    found: dict[Held, Piece] = {}
    for x in states:
        held = held_of(box_minimum(h, g @ x, most), most)
        if held not in found:
            found[held] = piece(h, g, held, most)
    return found


def evaluate(table: dict[Held, Piece], h: Array, g: Array, x: Array, most: float) -> Array | None:
    """The solution by the table alone: the piece that meets limits and slopes; None where none does.

    Without any solving: for each piece the free components must be within the limits, and the slope of the
    cost must press the held ones against theirs.
    """
    for held, (gain, offset) in table.items():
        m, sides = gain @ x + offset, np.array(held)
        slope = h @ m + g @ x
        largest = float(np.abs(g @ x).max())
        within = np.all(np.abs(m[sides == 0]) <= most * (1.0 + AT_LIMIT))
        if within and np.all(slope[sides != 0] * sides[sides != 0] <= 1e-9 * largest):
            return np.asarray(m, dtype=np.float64)
    return None
