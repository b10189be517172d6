"""Runs studies, their tasks in parallel; the outcome does not depend on the number of processes."""

import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import forkserver
from multiprocessing.context import BaseContext
from threading import current_thread, main_thread
from typing import Any

from sim.campaign.claim import ClaimOutcome, Study, Task
from sim.errors import HarnessError
from sim.progress import note

Watch = Callable[[int], None]
LOST = "ended from outside, out of memory, or crashed"
"""Why a worker may be gone: the system does not tell these apart."""


class WorkerLostError(HarnessError):
    """A worker process was lost before all tasks were done."""

    exit_code = 1


@dataclass(frozen=True, slots=True)
class StudyResult:
    """A completed study: outcomes, results of its tasks, and the sum of their wall times."""

    study: Study
    outcomes: tuple[ClaimOutcome, ...]
    results: tuple[Any, ...]
    wall_s: float


def run(
    studies: Sequence[Study],
    workers: int,
    watch: Watch,
    report: Callable[[StudyResult], None],
) -> list[StudyResult]:
    """Run all tasks and conclude every study.

    Args:
        studies: what to do.
        workers: processes; 1 for this one alone.
        watch: called with the number of tasks done.
        report: called with each study when it is done.

    Returns:
        The studies in their order.

    Raises:
        HarnessError: a task failed with a message for the user, or a worker was lost; the rest is cancelled.
    """
    waiting = {place: len(study.tasks) for place, study in enumerate(studies)}
    results: dict[tuple[int, int], tuple[float, Any]] = {}
    finished: dict[int, StudyResult] = {}

    def conclude(place: int) -> None:
        study = studies[place]
        mine = [results.pop((place, number)) for number in range(len(study.tasks))]
        task_results = tuple(result for _, result in mine)
        wall_s = sum(wall_s for wall_s, _ in mine)
        finished[place] = StudyResult(study, tuple(study.conclude(task_results)), task_results, wall_s)
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
    shared = [one for one in tasks if not studies[one[0]].here]
    alone = workers == 1 or len(tasks) < 2 or not shared
    started = None if alone else start_pool(min(workers, len(shared)))
    if started is None:
        for place, number, task in tasks:
            yield place, number, _run_timed(task)
        return
    with started as pool:
        with children_ignore_interrupt():
            places: dict[Future[tuple[float, Any]], tuple[int, int]] = {
                pool.submit(_run_timed, task): (place, number) for place, number, task in shared
            }
        try:
            for place, number, task in tasks:
                if studies[place].here:
                    yield place, number, _run_timed(task)
            for future in as_completed(places):
                yield *places[future], future.result()
        except BrokenProcessPool:
            end_workers(pool)
            done = sum(future.done() and future.exception() is None for future in places)
            raise WorkerLostError(
                f"a worker process was lost ({LOST}): {done} of {len(places)} tasks were done"
            ) from None
        except BaseException:
            end_workers(pool)  # breaks the pool, which then cancels waiting tasks and is joined
            raise


def start_pool(workers: int, begin: Callable[[], None] | None = None) -> ProcessPoolExecutor | None:
    """A pool of processes, each of which calls ``begin`` first; None, with a note, where there can be none.

    It needs semaphores, shared memory that can be written, and room for one process: a system, a container or
    a limit may refuse each.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # one task, one core
    pool = None
    try:
        with children_ignore_interrupt():
            pool = ProcessPoolExecutor(workers, worker_context(), initializer=begin)
            pool.submit(os.getpid).result()
            return pool
    except (OSError, ImportError, NotImplementedError, BrokenProcessPool) as error:
        if pool is not None:
            end_workers(pool)
            pool.shutdown()
        why = f"the first was {LOST}" if isinstance(error, BrokenProcessPool) else _reason(error)
        note(f"no worker processes can be started ({why}): this process does all, one after the other")
        return None


def _reason(error: Exception) -> str:
    return (isinstance(error, OSError) and error.strerror) or str(error)


def worker_context() -> BaseContext:
    """How workers start: as copies of a process that has imported what a flight needs; on Windows, anew.

    That process is started once, and lives as long as this one.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["sim.campaign.one_run"])
    # it would look for packages in the working directory first, which workers do not
    safe_path = os.environ.get("PYTHONSAFEPATH")
    os.environ["PYTHONSAFEPATH"] = "1"
    try:
        with children_ignore_interrupt():
            forkserver.ensure_running()
    finally:
        if safe_path is None:
            del os.environ["PYTHONSAFEPATH"]
        else:
            os.environ["PYTHONSAFEPATH"] = safe_path
    return context


@contextmanager
def children_ignore_interrupt() -> Iterator[None]:
    """Processes started in the block ignore Ctrl-C: this one ends them.

    Only the main thread can arrange for that; what another thread starts ignores it once it has begun.
    """
    if current_thread() is not main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def end_workers(pool: ProcessPoolExecutor) -> None:
    """End the processes of a pool, and no other child of this process; the pool is broken then."""
    workers = list((pool._processes or {}).values())  # public from Python 3.14 on: terminate_workers()
    for process in workers:
        process.terminate()
    for process in workers:
        process.join()


def _run_timed(task: Task) -> tuple[float, Any]:
    began = time.monotonic()
    result = task()
    return time.monotonic() - began, result
