"""Attitude, field, Sun and position of a flight as samples for a moving picture, gathered block by block."""

import numpy as np
from numpy.typing import NDArray

from sim.record.truth import Histories

Array = NDArray[np.float64]

MOST_SAMPLES = 3000
COLUMNS = {"q_body_from_orbit": 4, "b_body_t": 3, "sun_body": 3, "r_eci_m": 3, "lit": 1}
"""Histories that are sampled, and their widths."""


class MotionSamples:
    """Of a flight of ``ticks`` ticks, from its blocks in order; memory does not grow with its length."""

    def __init__(self, ticks: int) -> None:
        self.places = np.unique(np.linspace(0, ticks - 1, min(ticks, MOST_SAMPLES)).round().astype(int))
        """The tick of each sample."""
        self._samples = {name: np.full((len(self.places), width), np.nan) for name, width in COLUMNS.items()}
        self._taken = 0

    def take(self, truth: Histories) -> None:
        """The next block."""
        begin, end = self._taken, self._taken + len(truth["lit"])
        first, past = np.searchsorted(self.places, (begin, end))
        for name, samples in self._samples.items():
            samples[first:past] = truth[name][self.places[first:past] - begin].reshape(-1, samples.shape[1])
        self._taken = end

    def samples(self, name: str) -> Array:
        """A history at each place, (samples, width)."""
        return self._samples[name]
