"""The direction of the Sun from three lit cells: coarse, since it includes the Earth's light."""

from collections.abc import Sequence

from fsw.core.algebra.vector import Mat3, Vec3, cross, dot, inverse, norm, transform
from fsw.core.estimation.cells.cell_set import CellSet

BRIGHT = 0.12
"""Fraction of full sunlight above which a cell is taken to see the Sun; the Earth alone seldom gives this."""
LENGTHS = (0.7, 1.4)
"""Limits for the vector: a shorter one is the Earth's light alone, a longer one contains too much of it."""
LEAST_VOLUME = 0.3
"""Of the solid that three normals span: below it, errors of the currents change the direction too much."""


def coarse_sun(currents: Sequence[float | None], cells: CellSet) -> Vec3 | None:
    """The vector s with n . s = c for the three brightest cells that span space; None without three.

    Its length is 1 where the cells are as the table has them and no other light falls on them; None where it
    is outside ``LENGTHS``. While a cell may be in a shade, one of the three brightest could see the Earth in
    its place: each must then show more than a cell in a shade can.

    Args:
        currents: by cell, fractions of full sunlight; None: not to be used.
        cells: as the table has them.
    """
    known = [(current, cell) for cell, current in enumerate(currents) if current is not None]
    in_doubt = any([cells.may_be_shaded(cell, current) for current, cell in known])
    least = max(BRIGHT, cells.most_shaded) if in_doubt else BRIGHT
    bright = [one for one in known if one[0] > least]
    rows: list[Vec3] = []
    values: list[float] = []
    for current, cell in sorted(bright, reverse=True):
        normal = cells.normals_body[cell]
        if _spans(rows, normal):
            rows, values = [*rows, normal], [*values, current]
        if len(rows) == 3:
            normals: Mat3 = (rows[0], rows[1], rows[2])
            sun = transform(inverse(normals), (values[0], values[1], values[2]))
            return sun if LENGTHS[0] <= norm(sun) <= LENGTHS[1] else None
    return None


def _spans(rows: list[Vec3], normal: Vec3) -> bool:
    """Whether a normal points well out of the span of those before."""
    if not rows:
        return True
    if len(rows) == 1:
        out = cross(rows[0], normal)
        return dot(out, out) > LEAST_VOLUME**2
    return abs(dot(cross(rows[0], rows[1]), normal)) > LEAST_VOLUME
