"""How results depend on inputs, by ranks."""

from dataclasses import dataclass
from math import atanh, sqrt, tanh

import numpy as np
from scipy.special import ndtri

from sim.value_types import Array

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

    Results may be infinite, those of runs that failed: as ranks they are the greatest or least. Bounds by
    Fisher's transformation with the variance (1 + r^2 / 2) / (n - 3) (Bonett and Wright 2000); where all
    ranks agree, r counts as half of the way to the next smaller one, 1 - 6 / (n^3 - n).
    """
    known = ~(np.isnan(inputs) | np.isnan(results))
    count = int(known.sum())
    if count < LEAST_RUNS or min(len(np.unique(inputs[known])), len(np.unique(results[known]))) < 2:
        return None
    value = float(np.corrcoef(ranks(inputs[known]), ranks(results[known]))[0, 1])
    most = 1.0 - 6.0 / (count**3 - count)
    inner = min(max(value, -most), most)
    half = float(ndtri(0.5 * (1.0 + confidence))) * sqrt((1.0 + 0.5 * inner * inner) / (count - 3))
    return RankCorrelation(value, tanh(atanh(inner) - half), min(tanh(atanh(inner) + half), 1.0))


def ranks(values: Array) -> Array:
    """The rank of each value from 1 on; equal ones share their mean rank."""
    _, place, counts = np.unique(values, return_inverse=True, return_counts=True)
    mean: Array = np.cumsum(counts) - 0.5 * (counts - 1)
    return mean[place]
