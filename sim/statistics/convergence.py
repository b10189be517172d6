"""How a percentile settles as runs are added."""

from typing import NamedTuple

import numpy as np

from sim.statistics.order_statistics import percentile
from sim.value_types import Array

STEPS = 60


class Convergence(NamedTuple):
    """A percentile with its bounds by number of runs; NaN where there are too few for a bound."""

    runs: Array
    value: Array
    low: Array
    high: Array


def convergence(values: Array, probability: float, confidence: float) -> Convergence:
    """The percentile of the first n values, for some ``STEPS`` n."""
    counts = np.unique(np.geomspace(min(2, len(values)), len(values), STEPS).round().astype(int))
    found = [percentile(values[:count], probability, confidence) for count in counts]
    bounds = [
        np.array([np.nan if bound is None else bound for bound in side])
        for side in ([each.low for each in found], [each.high for each in found])
    ]
    return Convergence(counts.astype(float), np.array([each.value for each in found]), *bounds)
