"""How results depend on inputs, by ranks."""

from dataclasses import dataclass
from math import atanh, sqrt, tanh

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

Array = NDArray[np.float64]

LEAST_RUNS = 4


@dataclass(frozen=True, slots=True)
class RankCorrelation:
    """Spearman's coefficient with two-sided bounds."""

    value: float
    low: float
    high: float

    @property
    def significant(self) -> bool:
        """Whether the bounds exclude zero."""
        return self.low > 0.0 or self.high < 0.0


def spearman(inputs: Array, results: Array, confidence: float) -> RankCorrelation | None:
    """The rank correlation of an input with a result; None if one does not vary, or with too few runs.

    Bounds by Fisher's transformation with the variance 1.06 / (n - 3) (Fieller, Hartley and Pearson 1957).
    """
    known = np.isfinite(inputs) & np.isfinite(results)
    count = int(known.sum())
    if count < LEAST_RUNS or np.ptp(inputs[known]) == 0.0 or np.ptp(results[known]) == 0.0:
        return None
    value = float(np.corrcoef(ranks(inputs[known]), ranks(results[known]))[0, 1])
    centre = atanh(min(max(value, -1.0 + 1e-12), 1.0 - 1e-12))
    half = float(ndtri(0.5 * (1.0 + confidence))) * sqrt(1.06 / (count - 3))
    return RankCorrelation(value, tanh(centre - half), tanh(centre + half))


def ranks(values: Array) -> Array:
    """The rank of each value from 1 on; equal ones share their mean rank."""
    _, place, counts = np.unique(values, return_inverse=True, return_counts=True)
    mean: Array = np.cumsum(counts) - 0.5 * (counts - 1)
    return mean[place]
