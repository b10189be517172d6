"""Detects a stalled flight from outside: its log does not grow."""

import time
from pathlib import Path

from sim.record import run_dir


class StallDetector:
    """Observes a log that another process writes.

    Args:
        path: the run directory.
        first_s: longest time until its first line [s].
        next_s: longest time between two of its lines [s].
    """

    def __init__(self, path: Path, first_s: float, next_s: float) -> None:
        self._path = path
        self._first_s = first_s
        self._next_s = next_s
        self._size = -1
        self._since = time.monotonic()

    def stalled_s(self) -> float:
        """The time for which nothing has been written [s]; 0 while it is within the limit."""
        try:
            size = run_dir.bus_log(self._path).stat().st_size
        except OSError:
            size = -1
        now = time.monotonic()
        if size != self._size:
            self._size, self._since = size, now
        quiet_s = now - self._since
        return quiet_s if quiet_s > (self._next_s if size > 0 else self._first_s) else 0.0
