"""A history of many samples as least and largest value of each of some bins, gathered block by block."""

import numpy as np
from numpy.typing import NDArray

from sim.value_types import Array

BINS = 700
"""Bins along a time axis; a longer history is drawn as the envelope of each."""


class Envelope:
    """Of histories of so many samples, side by side; a short one is kept as it is.

    NaN are passed over; a bin of nothing else stays NaN. Each bin gives two points, in the order in which the
    history goes from its first to its last sample.

    Args:
        length: number of samples.
        width: number of histories.
        bins: how many.
    """

    def __init__(self, length: int, width: int, bins: int = BINS) -> None:
        whole = length <= 2 * bins
        self._starts = (
            np.arange(length) if whole else np.linspace(0, length, bins, endpoint=False).astype(int)
        )
        self._ends = np.append(self._starts[1:], length)
        self._least, self._largest, self._first, self._last = np.full((4, len(self._starts), width), np.nan)
        self._taken = 0
        self._whole = whole

    def take(self, samples: Array) -> None:
        """The next samples, (n, width)."""
        begin, end = self._taken, self._taken + len(samples)
        touched = slice(
            int(np.searchsorted(self._ends, begin, side="right")), int(np.searchsorted(self._starts, end))
        )
        cuts = np.maximum(self._starts[touched], begin) - begin
        for bound, extreme in ((self._least, np.fmin), (self._largest, np.fmax)):
            bound[touched] = extreme(bound[touched], extreme.reduceat(samples, cuts))
        self._pick(self._first, self._starts, samples)
        self._pick(self._last, self._ends - 1, samples)
        self._taken = end

    def _pick(self, into: Array, places: NDArray[np.int_], samples: Array) -> None:
        """The samples at these places of the history, as far as they are among these."""
        here = (places >= self._taken) & (places < self._taken + len(samples))
        into[here] = samples[places[here] - self._taken]

    @property
    def places(self) -> NDArray[np.int_]:
        """Which sample each point stands at, (points,)."""
        if self._whole:
            return self._starts
        return np.stack((self._starts, (self._starts + self._ends) // 2), axis=1).ravel()

    @property
    def points(self) -> Array:
        """The points to draw, (points, width)."""
        if self._whole:
            return self._first
        both = np.stack((self._least, self._largest), axis=1)
        falling = ~(self._first <= self._last)
        both = np.where(falling[:, None], both[:, ::-1], both)
        return both.reshape(2 * len(self._starts), -1)
