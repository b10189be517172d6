"""A histogram of times: however long a bench runs, it takes no more memory."""

from collections import Counter
from collections.abc import Iterable
from math import ceil, log, log1p

LEAST_S = 1e-6
STEP = 0.01
"""Relative width of a class."""


class TimeHistogram:
    """Counts times above 0 in classes; quantiles are true to 1 %, rounded up, and the longest is exact."""

    def __init__(self, seconds: Iterable[float] = ()) -> None:
        self._counts: Counter[int] = Counter()
        self._number = 0
        self._longest_s = 0.0
        for time_s in seconds:
            self.add(time_s)

    def add(self, seconds: float) -> None:
        """Count one time."""
        self._counts[_class(seconds)] += 1
        self._number += 1
        self._longest_s = max(self._longest_s, seconds)

    def quantile(self, fraction: float) -> float:
        """The time that no more than a ``fraction`` of all stay below; infinite where none was counted."""
        passed = min(self._number - 1, int(fraction * self._number))
        for number in sorted(self._counts):
            passed -= self._counts[number]
            if passed < 0:
                return min(LEAST_S * (1.0 + STEP) ** number, self._longest_s)
        return float("inf")


def _class(seconds: float) -> int:
    """The class of a time: the k with LEAST_S (1 + STEP)^(k - 1) < t <= LEAST_S (1 + STEP)^k, at least 0."""
    return ceil(log(seconds / LEAST_S) / log1p(STEP)) if seconds > LEAST_S else 0
