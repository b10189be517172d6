"""MPE and RPE of a history of errors, over all of it or block by block in constant memory.

Whole windows follow each other from the first error on. Where a rest is left, a last window ends with the
history and overlaps the one before: each mean is over the same time, and every error has one deviation, from
the mean of the first window that it is in. A history that is shorter than a window is one.
"""

import numpy as np

from sim.value_types import Array


class Windows:
    """Takes errors in blocks, and gives the indices of the windows that are complete.

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
