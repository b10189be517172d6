"""floquet.csv: characteristic multipliers and degree of stability of the PD law."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from sim.campaign.claim import Threshold
from sim.design.theory.bodies import Body, diagonal
from sim.design.theory.floquet import degree_of_stability, monodromy, multipliers
from sim.design.theory.linear import Gains, closed_loop
from sim.validate.reference.comparison import ReferenceComparison, mismatch
from sim.validate.reference.reference_table import ReferenceTable

TOLERANCE = 1e-7
"""Of the degree, and of a multiplier relative to the greater of 1 and its modulus."""
CONSTANTS = 1e-12
"""Relative; w0 and B0 are closed formulas."""
NEUTRAL = 1e-9
"""Degrees of a smaller magnitude count as neutral."""
CLUSTER = 1e-3
"""Largest distance of multipliers in a cluster."""
STEPS = 2048

Complex = NDArray[np.complex128]


def check(table: ReferenceTable) -> Iterator[ReferenceComparison]:
    """Compare every case.

    Raises:
        HarnessError: a row is malformed.
    """
    moments = table.columns("A", "B", "C")
    orbits, gains = table.columns("altitude_km", "inclination_deg"), table.columns("k_omega", "k_a")
    theirs = np.stack(
        [table.column(f"mult_{k}_re") + 1j * table.column(f"mult_{k}_im") for k in range(1, 7)], axis=1
    )
    bodies = [
        Body(name, diagonal((a, b, c)), altitude, inclination)
        for name, (a, b, c), (altitude, inclination) in zip(
            table.texts("name"), moments.tolist(), orbits.tolist(), strict=True
        )
    ]
    turns = [
        monodromy(closed_loop(body, Gains(k_w, k_a)), STEPS)
        for body, (k_w, k_a) in zip(bodies, gains.tolist(), strict=True)
    ]
    degrees = np.array([float(degree_of_stability(turn)) for turn in turns])
    reference = table.column("degree_of_stability")
    yield ReferenceComparison(
        "degree", "Degree of stability", "1/rad", np.abs(degrees - reference), TOLERANCE
    )
    yield ReferenceComparison(
        "multipliers",
        "Multipliers, relative to max(1, modulus)",
        "1",
        np.array([apart(multipliers(turn), row) for turn, row in zip(turns, theirs, strict=True)]),
        TOLERANCE,
    )
    yield ReferenceComparison(
        "stable",
        "Cases called stable, neutral or unstable otherwise",
        "rows",
        np.array(
            [not _same_class(*row) for row in zip(degrees, table.column("stable"), strict=True)], dtype=float
        ),
        0.0,
    )
    rates, fields = (np.array([getattr(body, name) for body in bodies]) for name in ("rate_radps", "field_t"))
    for name, ours, column in (("w0", rates, "w0_rad_s"), ("b0", fields, "B0_T")):
        yield ReferenceComparison(
            name,
            f"{column}, relative",
            "1",
            np.abs(ours / table.column(column) - 1.0),
            CONSTANTS,
            Threshold.OWN,
            "a file may give twelve digits",
        )
    a, b, c = moments.T
    held = np.where((c > b) & (b > a), "stable", "unstable")
    yield ReferenceComparison(
        "gravity", "Bodies that the gravity gradient holds", "rows", mismatch(held, table.texts("gg")), 0.0
    )


def apart(ours: Complex, theirs: Complex) -> float:
    """The distance of two sets of multipliers, relative to the greater of 1 and the modulus.

    Paired so that the distance is least in sum. Multipliers that nearly coincide are ill conditioned, each by
    itself, but not their mean: of those nearer than ``CLUSTER`` to each other the mean is compared.
    """
    distance = np.abs(ours[:, None] - theirs[None, :])
    rows, columns = linear_sum_assignment(distance / np.maximum(1.0, np.abs(theirs)))
    difference = (ours[rows] - theirs[columns])[np.argsort(columns)]
    near = np.abs(theirs[:, None] - theirs[None, :]) < CLUSTER
    mean = (near @ difference) / near.sum(axis=1)
    deviation = np.where(np.abs(difference) < CLUSTER, np.abs(mean), np.abs(difference))
    return float((deviation / np.maximum(1.0, np.abs(theirs))).max())


def _same_class(degree: float, called: float) -> bool:
    """Whether a degree of stability, within its tolerance, is 1 stable, 0 neutral or -1 unstable."""
    low, high = degree - TOLERANCE, degree + TOLERANCE
    return bool(
        {1.0: low < -NEUTRAL, 0.0: low <= 0.0 <= high, -1.0: high > NEUTRAL}.get(float(called), False)
    )
