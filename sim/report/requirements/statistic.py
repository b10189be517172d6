"""The number that is limited, of the values of an index over a window."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sim.report.figures.mean import Mean

Array = NDArray[np.float64]

LEAST, MOST, STEP = 1e-7, 1e4, 1.005
"""Range and ratio of the steps in which a percentile is found; it is rounded up to the next."""
EDGES = np.geomspace(LEAST, MOST, 1 + round(np.log(MOST / LEAST) / np.log(STEP)))


@dataclass(slots=True)
class Statistic:
    """Root mean square, or what a fraction of the values does not exceed, in constant memory.

    Attributes:
        probability: that fraction; None: the root mean square.
    """

    probability: float | None
    mean: Mean = field(default_factory=Mean)
    counts: NDArray[np.int64] = field(default_factory=lambda: np.zeros(len(EDGES) + 1, np.int64))

    def take(self, values: Array) -> None:
        """Take further values."""
        self.mean.take(values)
        if self.probability is not None:
            self.counts += np.bincount(np.searchsorted(EDGES, values), minlength=len(EDGES) + 1)

    @property
    def value(self) -> float | None:
        """None if there are no values."""
        if not self.mean.count:
            return None
        if self.probability is None:
            return self.mean.rms
        needed = int(np.ceil(self.probability * self.mean.count))
        place = int(np.searchsorted(np.cumsum(self.counts), needed))
        return min(float(EDGES[min(place, len(EDGES) - 1)]), self.mean.most)

    @property
    def words(self) -> str:
        """What it is, in words."""
        if self.probability is None:
            return "RMS"
        return (
            "at all times" if self.probability == 1.0 else f"for {100.0 * self.probability:g} % of the time"
        )
