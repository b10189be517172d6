"""Times as counted, not gathered: however long a bench runs, they take no more memory."""

from collections import Counter
from collections.abc import Iterable
from math import ceil, log, log1p

LEAST_S = 1e-6
STEP = 0.01
"""Times that differ by less, relative, are counted as one."""


class Times:
    """Times above 0; percentiles are true to 1 %, rounded up, and the longest is exact."""

    def __init__(self, seconds: Iterable[float] = ()) -> None:
        self._counts: Counter[int] = Counter()
        self._number = 0
        self._longest_s = 0.0
        for one_s in seconds:
            self.add(one_s)

    def add(self, seconds: float) -> None:
        """Count one."""
        self._counts[_class(seconds)] += 1
        self._number += 1
        self._longest_s = max(self._longest_s, seconds)

    def at(self, part: float) -> float:
        """The time that no more than a ``part`` of all stay below; infinite where nothing was counted."""
        passed = min(self._number - 1, int(part * self._number))
        for number in sorted(self._counts):
            passed -= self._counts[number]
            if passed < 0:
                return min(LEAST_S * (1.0 + STEP) ** number, self._longest_s)
        return float("inf")


def _class(seconds: float) -> int:
    """Of the times from a step below ``LEAST_S * (1 + STEP)^class`` up to that."""
    return ceil(log(seconds / LEAST_S) / log1p(STEP)) if seconds > LEAST_S else 0
