"""Worker processes give the rows of one process, whatever their number, and outlive no one."""

import multiprocessing
import os
import signal
import time
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from sim.campaign.executors.processes import Processes
from sim.campaign.one_run import Keep, RunTask
from sim.campaign.results.store import RunRow, Status

pytestmark = pytest.mark.long


def untimed(row):
    return replace(row, wall_s=0.0, worker="")


@dataclass(frozen=True, slots=True)
class KillsItself(RunTask):
    """Kills the worker of run 1 by SIGKILL, and with it the runs that were handed out then."""

    def fly(self, run: int) -> RunRow:
        if run == 1:
            os.kill(os.getpid(), signal.SIGKILL)
        return RunRow(run, Status.DONE, "", 0, True, "", {})


@pytest.mark.slow
def test_rows_are_those_of_one_process_and_workers_end_with_the_campaign(small):
    task, runs = RunTask(small, Keep.NONE, Path()), [4, 1, 2, 5, 0, 3]
    rows = Processes(2).rows(task, runs)
    found = [next(rows) for _ in range(3)]
    assert [untimed(row) for row in found] == [untimed(task.fly(row.run)) for row in found]
    assert len({row.run for row in found}) == 3
    assert str(os.getpid()) not in {row.worker.rpartition(":")[2] for row in found}
    assert multiprocessing.active_children()
    rows.close()
    assert not multiprocessing.active_children()


def test_a_lost_worker_loses_no_run_and_flies_none_twice(small, monkeypatch):
    monkeypatch.setattr("sim.campaign.executors.processes.MOST_LOSSES", 2)
    rows = list(Processes(1).rows(KillsItself(small, Keep.NONE, Path()), range(6)))
    assert sorted(row.run for row in rows) == list(range(6))
    failed = [row for row in rows if row.status is Status.FAILED]
    assert [row.run for row in failed] == [1]
    assert (
        failed[0].failure
        == "its worker process was lost 2 times (ended from outside, out of memory, or crashed)"
    )


def test_without_worker_processes_this_one_flies_all_runs(small, monkeypatch, capsys):
    def refuse(*words, **options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("multiprocessing.synchronize.SemLock.__init__", refuse)
    task = RunTask(small, Keep.NONE, Path())
    rows = list(Processes(2).rows(task, [1, 0]))
    assert [untimed(row) for row in rows] == [untimed(task.fly(run)) for run in (1, 0)]
    assert "no worker processes can be started (Permission denied)" in capsys.readouterr().err


@dataclass(frozen=True, slots=True)
class Sleeps(RunTask):
    """A minute for every run but 0."""

    def fly(self, run: int) -> RunRow:
        time.sleep(60.0 * (run > 0))
        return RunRow(run, Status.DONE, "", 0, True, "", {})


def test_a_campaign_that_is_given_up_waits_for_no_run(small):
    rows = Processes(1).rows(Sleeps(small, Keep.NONE, Path()), range(4))
    assert next(rows).run == 0
    began = time.monotonic()
    rows.close()
    assert time.monotonic() - began < 30.0


def test_a_process_that_the_campaign_did_not_start_outlives_it(small):
    """One of another thread, say, that is started while the campaign flies."""
    rows = Processes(1).rows(Sleeps(small, Keep.NONE, Path()), range(4))
    next(rows)
    other = multiprocessing.get_context("spawn").Process(target=time.sleep, args=(60.0,))
    other.start()
    try:
        rows.close()
        assert other.is_alive()
        assert multiprocessing.active_children() == [other]
    finally:
        other.terminate()
        other.join()


def test_no_run_needs_no_worker(small):
    assert list(Processes(2).rows(RunTask(small, Keep.NONE, Path()), [])) == []
