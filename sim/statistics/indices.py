"""Pointing error indices of ECSS-E-ST-60-10C, and their percentiles under its three interpretations.

With e the pointing error and k the knowledge error, both as rotation vectors, and a time window:
APE = |e|, MPE = |mean of e over the window|, RPE = |e - that mean|, AKE = |k|.
A requirement on one of them holds with probability P

- temporal: for a fraction P of the time in the worst run;
- ensemble: at all times in a fraction P of the runs;
- mixed: for a fraction P of all times of all runs.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import inf, sqrt

import numpy as np

from sim.statistics.order_statistics import least_part_bounded, quantile, upper_bound
from sim.value_types import Array

# --- MPE and RPE of a history of errors, over all of it or block by block in constant memory


class Windows:
    """Takes errors in blocks, and gives the indices of the windows that are complete.

    Whole windows follow each other from the first error on. Where a rest is left, a last window ends with the
    history and overlaps the one before: each mean is over the same time, and every error has one deviation,
    from the mean of the first window that it is in. A history that is shorter than a window is one.

    Args:
        rows: length of a window.
    """

    def __init__(self, rows: int) -> None:
        self._rows = rows
        self._recent: Array | None = None  # errors of the last window, at most
        self._waiting = 0  # how many of them are in no window yet

    def take(self, error: Array) -> tuple[Array, Array]:
        """MPE, one value per window that these (n, k) errors complete, and RPE of the errors in them."""
        rows = error if self._recent is None else np.concatenate((self._recent, error))
        waiting = self._waiting + len(error)
        self._waiting = waiting % self._rows
        first, end = len(rows) - waiting, len(rows) - self._waiting
        self._recent = rows[-self._rows :]
        parts = rows[first:end].reshape(-1, self._rows, error.shape[1])
        means = parts.mean(axis=1)
        return np.linalg.norm(means, axis=1), np.linalg.norm(parts - means[:, None], axis=2).ravel()

    def rest(self) -> tuple[Array, Array]:
        """After all errors: MPE of the last window, and RPE of the errors in no other; else empty."""
        if self._recent is None or not self._waiting:
            return np.empty(0), np.empty(0)
        mean = self._recent.mean(axis=0)
        left = self._recent[-self._waiting :]
        return np.linalg.norm(mean[None], axis=1), np.linalg.norm(left - mean, axis=1)


def mean_and_relative(error: Array, rows: int) -> tuple[Array, Array]:
    """MPE, one value per window of ``rows``, and RPE, one value per error, of a whole history, (n, k)."""
    windows = Windows(rows)
    mean, relative = windows.take(error)
    last_mean, last_relative = windows.rest()
    return np.concatenate((mean, last_mean)), np.concatenate((relative, last_relative))


# --- The indices, and their percentiles under three interpretations

INDICES = ("ape", "mpe", "rpe", "ake")
POINTS = 256
"""Numbers that represent the distribution of an index over a run, the last being its largest value."""

LAST_KEPT = 1.0 - 0.5 / (POINTS - 1)
"""Probability of the last quantile among them; above it the largest value stands for the percentile."""


class Interpretation(StrEnum):
    """How a probability is meant."""

    TEMPORAL = "temporal"
    ENSEMBLE = "ensemble"
    MIXED = "mixed"


def index_histories(error: Array, knowledge_error: Array, window: int) -> dict[str, Array]:
    """Each index over the time of a run; MPE has one value per window, the last of which ends with the run.

    Args:
        error: rotation vectors of the pointing error, (n, 3).
        knowledge_error: those of the estimate, (n, 3).
        window: its length in rows; fewer rows are one window.
    """
    mpe, rpe = mean_and_relative(error, window)
    return {"ape": magnitudes(error), "mpe": mpe, "rpe": rpe, "ake": magnitudes(knowledge_error)}


def magnitudes(error: Array) -> Array:
    """APE of pointing errors, AKE of knowledge errors: |e| of each row, (n,)."""
    result: Array = np.linalg.norm(error, axis=1)
    return result


def profile(values: Array) -> Array:
    """The distribution over time: quantiles at the middles of ``POINTS`` - 1 steps, then the largest."""
    middles = (np.arange(POINTS - 1) + 0.5) / (POINTS - 1)
    return np.append(np.quantile(values, middles, method="hazen"), values.max())


@dataclass(frozen=True, slots=True)
class IndexPercentile:
    """A percentile over a campaign.

    Attributes:
        value: the estimate; infinite where it falls on runs that failed.
        bound: one-sided upper bound of it with the confidence; None where there are too few runs for one.
        held: for the temporal interpretation, the fraction of the ensemble that is at most ``value`` with the
            confidence; otherwise the probability.
    """

    value: float
    bound: float | None
    held: float

    def within(self, limit: float) -> bool | None:
        """Whether the percentile is at most the limit; None if it takes more runs to decide."""
        if self.value > limit:
            return False
        return True if self.bound is not None and self.bound <= limit else None


def percentile(
    profiles: Array, interpretation: Interpretation, probability: float, confidence: float, failed: int = 0
) -> IndexPercentile:
    """A percentile of an index over runs, from their profiles, (runs, ``POINTS``).

    ``failed`` more runs have none: their index is infinite at all times. Temporal has no bound then, since
    one of them may be the worst, and is infinite where they are more than 1 - ``probability`` of all.

    Temporal takes the worst of the runs, which bounds a fraction of the ensemble. Ensemble takes the largest
    value of each run, its bound from order statistics. Mixed pools all runs with equal weight; its bound is
    that of Woodruff (1952), runs being the clusters, and allows for runs of a kind that is not among them.
    """
    if interpretation is Interpretation.TEMPORAL:
        return _worst(profiles, probability, confidence, failed)
    profiles = np.vstack((profiles, np.full((failed, POINTS), np.inf)))
    if interpretation is Interpretation.ENSEMBLE:
        largest = profiles[:, -1]
        bound = upper_bound(largest, probability, confidence)
        return IndexPercentile(quantile(largest, probability), bound, probability)
    value = _pooled(profiles, probability)
    return IndexPercentile(value, _woodruff(profiles, value, probability, confidence), probability)


def _worst(profiles: Array, probability: float, confidence: float, failed: int) -> IndexPercentile:
    """The largest of the runs' percentiles over time."""
    runs = len(profiles) + failed
    held = least_part_bounded(runs, confidence, failed)
    if failed > (1.0 - probability) * runs + 1e-9:
        return IndexPercentile(inf, None, held)
    if probability > LAST_KEPT:
        worst = float(profiles[:, -1].max())
    else:
        worst = float(np.quantile(profiles[:, :-1], probability, axis=1, method="hazen").max())
    return IndexPercentile(worst, None if failed else worst, held)


def _pooled(profiles: Array, probability: float) -> float:
    """The quantile over all times of the runs; above the last one that is kept, the largest value of all."""
    quantiles = profiles[:, :-1]
    if probability > 1.0 - 0.5 / quantiles.size:
        return float(profiles[:, -1].max())
    return quantile(quantiles.ravel(), probability, middles=True)


def _woodruff(profiles: Array, value: float, probability: float, confidence: float) -> float | None:
    """The pooled quantile at P + t s / sqrt(n), s the deviation between runs of the fraction <= ``value``.

    t is Student's quantile with n - 1 degrees of freedom. Where a few runs have small fractions, the term of
    Johnson (1978) for their third moment is added. With the confidence C a part u of all runs, (1 - u)^n =
    1 - C, may be of a kind that none of these is, and worse at all times: the bound is at P / (1 - u) at
    least, and there is none where that is beyond all times, with fewer runs than their largest value needs.
    """
    from scipy.special import stdtrit  # noqa: PLC0415  (slow to load)

    runs = len(profiles)
    if runs < 2:
        return None
    seen = (1.0 - confidence) ** (1.0 / runs)
    parts = np.mean(profiles[:, :-1] <= value, axis=1)
    deviation, student = float(parts.std(ddof=1)), float(stdtrit(runs - 1, confidence))
    shifted = probability + student * deviation / sqrt(runs)
    third = float(np.mean((parts - parts.mean()) ** 3))
    if third < 0.0:
        shifted -= third * (1.0 + 2.0 * student**2) / (6.0 * deviation**2 * runs)
    shifted = max(shifted, probability / seen)
    return _pooled(profiles, shifted) if shifted < 1.0 else None


def table(
    profiles: Mapping[str, Array], probability: float, confidence: float, failed: int = 0
) -> dict[str, dict[Interpretation, IndexPercentile]]:
    """Every index under every interpretation; ``failed`` runs have no profile."""
    return {
        name: {how: percentile(values, how, probability, confidence, failed) for how in Interpretation}
        for name, values in profiles.items()
    }
