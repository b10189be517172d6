"""Percentiles of a sample with bounds that hold for any distribution.

Of n independent values in order, the number below the p-quantile of the distribution is binomial (n, p). So
the k-th value is an upper bound of the quantile with confidence P(B <= k - 1), and a lower bound with
P(B >= k) (David and Nagaraja, Order Statistics, 2003, section 7.1).
"""

from dataclasses import dataclass
from math import ceil, isfinite, log
from typing import NamedTuple

import numpy as np

from sim.value_types import Array


@dataclass(frozen=True, slots=True)
class Percentile:
    """A percentile of a sample and its bounds; None where there are too few values for one."""

    probability: float
    value: float
    low: float | None
    high: float | None


def percentile(values: Array, probability: float, confidence: float) -> Percentile:
    """A percentile with two-sided bounds, half of the remaining probability on each side."""
    side = 0.5 * (1.0 + confidence)
    estimate = quantile(values, probability)
    low, high = lower_bound(values, probability, side), upper_bound(values, probability, side)
    return Percentile(probability, estimate, low, high)


def quantile(values: Array, probability: float, middles: bool = False) -> float:
    """The quantile of a sample that may hold infinite values, linear between its values.

    Where one of the two is infinite, the least value that is not exceeded by the fraction of the sample.

    Args:
        values: at least one.
        probability: of the quantile.
        middles: the k-th of n values is the quantile of (k - 0.5) / n; otherwise of (k - 1) / (n - 1).
    """
    last = len(values) - 1
    place = len(values) * probability - 0.5 if middles else last * probability
    place = min(max(round(place, 9), 0.0), float(last))
    below = int(place)
    reached = max(ceil(round(len(values) * probability, 9)) - 1, 0)
    ordered = np.partition(values, sorted({below, min(below + 1, last), reached}))
    low, high = float(ordered[below]), float(ordered[min(below + 1, last)])
    if not isfinite(low) or not isfinite(high):
        return float(ordered[reached])
    return low + (place - below) * (high - low)


def upper_bound(values: Array, probability: float, confidence: float) -> float | None:
    """The least value of the sample that bounds the quantile from above with the confidence."""
    from scipy.special import bdtr  # noqa: PLC0415  (slow to load)

    count = len(values)
    enough = bdtr(np.arange(count), count, probability) >= confidence
    return float(np.sort(values)[np.argmax(enough)]) if enough.any() else None


def lower_bound(values: Array, probability: float, confidence: float) -> float | None:
    """The largest value of the sample that bounds the quantile from below with the confidence."""
    below = upper_bound(-np.asarray(values), 1.0 - probability, confidence)
    return None if below is None else -below


def least_part_bounded(count: int, confidence: float, above: int = 0) -> float:
    """The fraction of the distribution that a value bounds with the confidence.

    It is the largest of ``count`` values but for ``above``; of all, (1 - confidence)^(1 / count).
    """
    from scipy.special import betaincinv  # noqa: PLC0415  (slow to load)

    return float(betaincinv(count - above, above + 1, 1.0 - confidence)) if above < count else 0.0


def runs_needed(probability: float, confidence: float) -> int:
    """The least number of values whose largest bounds the quantile with the confidence (Wilks 1941)."""
    return ceil(log(1.0 - confidence) / log(probability) - 1e-9)


# --- How a percentile settles as runs are added

CONVERGENCE_STEPS = 60


class Convergence(NamedTuple):
    """A percentile with its bounds by number of runs; NaN where there are too few for a bound."""

    runs: Array
    value: Array
    low: Array
    high: Array


def convergence(values: Array, probability: float, confidence: float) -> Convergence:
    """The percentile of the first n values, for some ``CONVERGENCE_STEPS`` n."""
    counts = np.unique(np.geomspace(min(2, len(values)), len(values), CONVERGENCE_STEPS).round().astype(int))
    found = [percentile(values[:count], probability, confidence) for count in counts]
    bounds = [
        np.array([np.nan if bound is None else bound for bound in side])
        for side in ([each.low for each in found], [each.high for each in found])
    ]
    return Convergence(counts.astype(float), np.array([each.value for each in found]), *bounds)
