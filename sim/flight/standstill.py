"""Whether a flight goes on, seen from outside: by the growth of its log."""

import time
from pathlib import Path


class Standstill:
    """Looks at a log that another process writes.

    Args:
        log: the file.
        first_s: how long it may take to its first line, and before that to be there.
        next_s: how long it may stand between two.
    """

    def __init__(self, log: Path, first_s: float, next_s: float) -> None:
        self._log = log
        self._first_s = first_s
        self._next_s = next_s
        self._size = -1
        self._since = time.monotonic()

    def lasts_s(self) -> float:
        """For how long nothing has been written; 0 while that is not too long."""
        try:
            size = self._log.stat().st_size
        except OSError:
            size = -1
        now = time.monotonic()
        if size != self._size:
            self._size, self._since = size, now
        stood_s = now - self._since
        return stood_s if stood_s > (self._next_s if size > 0 else self._first_s) else 0.0
