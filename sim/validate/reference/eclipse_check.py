"""eclipse.csv: the visible fraction of the Sun."""

from collections.abc import Iterator

import numpy as np

from fsw.core.orbit.sun import lit
from sim.plant.environment.sun import illumination
from sim.validate.reference.comparison import ReferenceComparison, mismatch
from sim.validate.reference.reference_table import ReferenceTable, names_of
from sim.value_types import Array

SAME_MODEL = 1e-7
"""The planar two-circle formula; arccos near full shadow costs half the digits."""
OTHER_MODEL = 5e-3
"""The Earth's limb is not a plane circle: the exact fraction differs by up to 2e-4 in low orbits."""


def check(table: ReferenceTable) -> Iterator[ReferenceComparison]:
    """Compare fraction, class and cylinder at every row.

    Raises:
        HarnessError: a row is malformed.
    """
    r_m = 1e3 * table.columns(*names_of("sat_", "xyz", "_km"))
    sun_m = 1e3 * table.columns(*names_of("sun_", "xyz", "_km"))
    fraction = illumination(r_m, sun_m)
    planar, exact = table.column("frac_planar"), table.column("frac_exact")
    classes = table.texts("class")
    yield ReferenceComparison(
        "planar", "Plant's lit fraction, plane circles", "1", np.abs(fraction - planar), SAME_MODEL
    )
    yield ReferenceComparison(
        "exact", "Plant's lit fraction against the exact one", "1", np.abs(fraction - exact), OTHER_MODEL
    )
    yield ReferenceComparison(
        "class",
        "Rows where the plant's fraction is not of the class sunlit, umbra or between",
        "rows",
        mismatch([_class(value) for value in fraction], [_CLASSES.get(name, "partial") for name in classes]),
        0.0,
    )
    yield ReferenceComparison(
        "cylinder",
        "Rows where the onboard cylindrical shadow differs",
        "rows",
        _cylinder_mismatch(r_m, sun_m, table.column("lit_cylinder")),
        0.0,
    )


def _cylinder_mismatch(r_m: Array, sun_m: Array, reference: Array) -> Array:
    """1 where the shadow differs both for a cylinder along Earth to Sun and for one along satellite to Sun.

    The two are 0.3 km apart at the shadow's edge in low orbits, and a reference may mean either.
    """
    differs = np.ones(len(r_m))
    for towards_m in (sun_m, sun_m - r_m):
        directions = towards_m / np.linalg.norm(towards_m, axis=1)[:, None]
        ours = [
            lit((x, y, z), (sx, sy, sz))
            for (x, y, z), (sx, sy, sz) in zip(r_m.tolist(), directions.tolist(), strict=True)
        ]
        differs *= mismatch(ours, reference)
    return differs


_CLASSES = {"sunlit": "sunlit", "umbra": "umbra"}


def _class(fraction: float) -> str:
    return {0.0: "umbra", 1.0: "sunlit"}.get(float(fraction), "partial")
