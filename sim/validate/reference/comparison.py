"""Deviations from reference rows, and the worst of them."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.campaign.claim import Claim, ClaimOutcome, ClaimVerdict, Threshold
from sim.validate.reference.reference_table import ReferenceTable
from sim.value_types import Array


@dataclass(frozen=True, slots=True)
class ReferenceComparison:
    """The deviation of our code from the reference in each row, or in some of them.

    Attributes:
        id: last word of the claim's id.
        statement: what is compared.
        unit: of deviation and tolerance.
        deviation: one a row, (n,); of none, the data to judge by are missing.
        tolerance: for all of these rows or one a row.
        threshold: whose it is.
        wide: why it is far from what is found, if it is known.
        rows: of the table, from 0, (n,); None: all.
    """

    id: str
    statement: str
    unit: str
    deviation: Array
    tolerance: ArrayLike
    threshold: Threshold = Threshold.REFERENCE
    wide: str = ""
    rows: NDArray[np.int64] | None = None

    def outcome(self, table: ReferenceTable) -> ClaimOutcome:
        """The verdict on the row with the largest ratio of deviation to tolerance."""
        claim = Claim(
            id=f"reference.{table.path.stem}.{self.id}",
            statement=self.statement,
            source=f"{table.path.name}: {table.comments[0]}" if table.comments else table.path.name,
            unit=self.unit,
            threshold=self.threshold,
            wide=self.wide,
        )
        if not len(self.deviation):
            return ClaimOutcome(claim, ClaimVerdict.ABSENT)
        tolerance = np.broadcast_to(np.asarray(self.tolerance, dtype=np.float64), self.deviation.shape)
        excess = np.where(self.deviation == 0.0, 0.0, self.deviation / np.maximum(tolerance, 1e-300))
        excess = np.where(np.isnan(excess), np.inf, excess)
        worst = int(np.argmax(excess))
        claim = replace(claim, high=float(tolerance[worst]))
        row = worst if self.rows is None else int(self.rows[worst])
        where = "" if claim.high == self.deviation[worst] == 0.0 else table.label(row)
        return claim.judge(float(self.deviation[worst]), where)


def largest(differences: Array) -> Array:
    """The largest magnitude in each row of (n, ...), (n,)."""
    worst: Array = np.abs(differences).max(axis=tuple(range(1, differences.ndim)))
    return worst


def mismatch(ours: ArrayLike, theirs: ArrayLike) -> Array:
    """1 in the rows where two columns differ, else 0: for columns that must agree exactly."""
    differs: Array = (np.asarray(ours) != np.asarray(theirs)).astype(np.float64)
    return differs


def angle_rad(a: Array, b: Array) -> Array:
    """The angle between directions, (n, 3) each, exact for small ones too."""
    angle: Array = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1))
    return angle
