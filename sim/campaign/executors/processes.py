"""Runs in processes of this machine, which stay warm from one run to the next."""

import multiprocessing
import os
import signal
import sys
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Thread
from types import ModuleType

from sim.campaign.one_run import RunTask, lost_run
from sim.campaign.results.store import RunRow
from sim.campaign.runner import children_ignore_interrupt, end_workers, start_pool

MOST_LOSSES = 3
"""A run whose worker was ended this many times is given up."""
HANDED_OUT = 2
"""Runs for each worker: one in flight and one to follow."""


@dataclass(frozen=True, slots=True)
class Processes:
    """``workers`` processes. When one is killed, the runs that were handed out are flown again.

    Where no process can be started, this one flies the runs, one after the other.
    """

    workers: int

    def rows(self, task: RunTask, runs: Sequence[int]) -> Iterator[RunRow]:
        """The rows of the runs, as they come."""
        waiting, losses = deque(runs), Counter[int]()
        while waiting:
            with _without_script():
                pool = start_pool(min(self.workers, len(waiting)), _begin_worker)
            if pool is None:
                yield from map(task.fly, waiting)
                return
            flying: dict[Future[RunRow], int] = {}
            yield from self._until_lost(pool, task, waiting, losses, flying)
            losses.update(flying.values())
            for run in sorted(flying.values(), reverse=True):
                if losses[run] < MOST_LOSSES:
                    waiting.appendleft(run)
                else:
                    yield lost_run(task.campaign, run, losses[run])

    def _until_lost(
        self,
        started: ProcessPoolExecutor,
        task: RunTask,
        waiting: deque[int],
        losses: Counter[int],
        flying: dict[Future[RunRow], int],
    ) -> Iterator[RunRow]:
        """Rows until no run is left or a worker is lost; then ``flying`` holds the runs without a row.

        Runs that were in flight at a loss are flown one at a time, which shows the one that causes it.
        """
        workers = min(self.workers, len(waiting))
        with started as pool:
            try:
                while waiting or flying:
                    while waiting and len(flying) < (1 if losses[waiting[0]] else HANDED_OUT * workers):
                        with children_ignore_interrupt(), _without_script():
                            flying[pool.submit(task.fly, waiting[0])] = waiting[0]
                        waiting.popleft()
                    for future in wait(flying, return_when=FIRST_COMPLETED).done:
                        row = future.result()
                        del flying[future]
                        yield row
            except BrokenProcessPool:
                return
            finally:
                end_workers(pool)  # breaks the pool, which is then joined


@contextmanager
def _without_script() -> Iterator[None]:
    """Processes started in the block do not run the script of this one: it may lack a ``__main__`` guard."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


def _begin_worker() -> None:
    """End this worker when the campaign's process has ended, even by SIGKILL: nobody waits for its rows."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, daemon=True).start()
