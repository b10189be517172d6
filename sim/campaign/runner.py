"""Runs studies, their tasks side by side on the machine's cores; the outcome does not depend on how many."""

import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.process import BaseProcess
from typing import Any

from sim.campaign.claim import Outcome, Study, Task
from sim.errors import HarnessError

Watch = Callable[[int], None]


class WorkerLostError(HarnessError):
    """Not all was done, and through no fault of what was asked for."""

    exit_code = 1


@dataclass(frozen=True, slots=True)
class Finished:
    """A study that is done: outcomes, what its tasks gave, and how long these took together."""

    study: Study
    outcomes: tuple[Outcome, ...]
    results: tuple[Any, ...]
    wall_s: float


def run(
    studies: Sequence[Study], workers: int, watch: Watch, report: Callable[[Finished], None]
) -> list[Finished]:
    """Run all tasks and conclude every study.

    Args:
        studies: what to do.
        workers: processes; 1 for this one alone.
        watch: called with the number of tasks done.
        report: called with each study when it is done.

    Returns:
        The studies in their order.

    Raises:
        HarnessError: a task met what a user can mend, or a worker was ended; the rest is given up.
    """
    waiting = {place: len(study.tasks) for place, study in enumerate(studies)}
    results: dict[tuple[int, int], tuple[float, Any]] = {}
    finished: dict[int, Finished] = {}

    def conclude(place: int) -> None:
        study = studies[place]
        mine = [results.pop((place, number)) for number in range(len(study.tasks))]
        given = tuple(result for _, result in mine)
        wall_s = sum(wall_s for wall_s, _ in mine)
        finished[place] = Finished(study, tuple(study.conclude(given)), given, wall_s)
        report(finished[place])

    for place in [place for place, count in waiting.items() if not count]:
        conclude(place)
    for done, (place, number, result) in enumerate(_results(studies, workers), start=1):
        results[place, number] = result
        watch(done)
        waiting[place] -= 1
        if not waiting[place]:
            conclude(place)
    return [finished[place] for place in range(len(studies))]


def _results(studies: Sequence[Study], workers: int) -> Iterator[tuple[int, int, tuple[float, Any]]]:
    """(study, task, (wall seconds, result)), as they come."""
    tasks = [
        (place, number, task)
        for place, study in enumerate(studies)
        for number, task in enumerate(study.tasks)
    ]
    if workers == 1 or len(tasks) < 2:
        for place, number, task in tasks:
            yield place, number, _timed(task)
        return
    others = multiprocessing.active_children()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one task, one core
    with ProcessPoolExecutor(min(workers, len(tasks)), multiprocessing.get_context("spawn")) as pool:
        with _deaf_children():
            places: dict[Future[tuple[float, Any]], tuple[int, int]] = {
                pool.submit(_timed, task): (place, number) for place, number, task in tasks
            }
        try:
            for future in as_completed(places):
                yield *places[future], future.result()
        except BrokenProcessPool:
            _end(others)
            done = sum(future.done() and future.exception() is None for future in places)
            raise WorkerLostError(
                f"a worker process was ended from outside: {done} of {len(places)} tasks were done"
            ) from None
        except BaseException:
            _end(others)  # that breaks the pool, which then gives up what waits, and is waited for
            raise


@contextmanager
def _deaf_children() -> Iterator[None]:
    """Processes started meanwhile leave Ctrl-C to this one, which ends them."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _end(others: Sequence[BaseProcess]) -> None:
    """End the processes of this one that are not among the others."""
    mine = [process for process in multiprocessing.active_children() if process not in others]
    for process in mine:
        process.terminate()
    for process in mine:
        process.join()


def _timed(task: Task) -> tuple[float, Any]:
    began = time.monotonic()
    result = task()
    return time.monotonic() - began, result
