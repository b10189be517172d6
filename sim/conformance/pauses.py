"""How long this computer stood still: what comes late then is not the board's fault."""

import os
import sys
import threading
import time
from contextlib import suppress
from types import TracebackType
from typing import Self

ASKED_S = 0.02


class PauseWatch:
    """While it is entered, a thread on each processor asks to be woken every 20 ms.

    Where threads cannot be bound to a processor, one looks for all.
    """

    def __init__(self) -> None:
        self._longest_s = 0.0
        self._over = threading.Event()
        self._threads: list[threading.Thread] = []

    def __enter__(self) -> Self:
        self._threads = [
            threading.Thread(target=self._watch, args=(processor,), daemon=True)
            for processor in (os.sched_getaffinity(0) if sys.platform == "linux" else {0})
        ]
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        for thread in self._threads:
            thread.join()

    def take_longest_s(self) -> float:
        """The longest time by which one of them woke late, since this was last asked."""
        longest_s, self._longest_s = self._longest_s, 0.0
        return longest_s

    def _watch(self, processor: int) -> None:
        if sys.platform == "linux":
            with suppress(OSError):
                os.sched_setaffinity(threading.get_native_id(), {processor})
        while not self._over.is_set():
            since_s = time.monotonic()
            time.sleep(ASKED_S)
            self._longest_s = max(self._longest_s, time.monotonic() - since_s - ASKED_S)
