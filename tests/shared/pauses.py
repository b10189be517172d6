"""Tests in real time on a machine that may stand still: a run that it has disturbed is made again.

What fails by a fault of the code fails in each run, and only after a pause of the machine is there another.
"""

import os
import threading
import time

RUNS = 3
MOST_PAUSE_S = 0.05
"""A frame passes up to five processes within a tick of half a second: each may wait for so long."""
ASKED_S = 0.005


class PauseWatch:
    """While it is entered, a thread on each processor asks to be woken every 5 ms; ``longest_s``: the most
    by which one of them woke late.
    """

    def __init__(self):
        self.longest_s = 0.0

    def __enter__(self):
        self._over = threading.Event()
        self._threads = [threading.Thread(target=self._watch, args=(cpu,)) for cpu in os.sched_getaffinity(0)]
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_):
        self._over.set()
        for thread in self._threads:
            thread.join()

    def _watch(self, cpu):
        os.sched_setaffinity(threading.get_native_id(), {cpu})
        while not self._over.is_set():
            since_s = time.monotonic()
            time.sleep(ASKED_S)
            self.longest_s = max(self.longest_s, time.monotonic() - since_s - ASKED_S)


def run_undisturbed(run, is_as_expected):
    """The result of ``run()``: the first as expected or without a pause of the machine, or the last."""
    for _ in range(RUNS):
        with PauseWatch() as watch:
            result = run()
        if is_as_expected(result) or watch.longest_s < MOST_PAUSE_S:
            break
    return result
