"""Runs on a Dask scheduler with a worker, each a process started by hand, as on a cluster."""

import builtins
import os
import signal
import socket
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from sim.campaign.code_digest import code_digest
from sim.campaign.executors.cluster import Cluster, ClusterLostError
from sim.campaign.one_run import Keep, RunTask
from sim.campaign.results.store import RunRow, Status
from sim.errors import HarnessError

ROOT = Path(__file__).resolve().parents[4]


def started(*words):
    path = {
        "PYTHONPATH": os.pathsep.join([str(ROOT), str(Path(__file__).parent)]),
        "OPENBLAS_NUM_THREADS": "1",
    }
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    command = [sys.executable, "-m", f"distributed.cli.{words[0]}", *words[1:]]
    return subprocess.Popen(command, env={**os.environ, **path}, **quiet)


@pytest.fixture
def cluster(tmp_path):
    """(scheduler file, scheduler process); one worker."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    file = tmp_path / "scheduler.json"
    common = ("--scheduler-file", str(file), "--no-dashboard")
    scheduler = started("dask_scheduler", "--host", "127.0.0.1", "--port", port, *common)
    worker = started("dask_worker", "--nthreads", "1", "--no-nanny", *common)
    try:
        while not file.exists():
            assert scheduler.poll() is None
            time.sleep(0.05)
        yield file, scheduler
    finally:
        for process in (worker, scheduler):
            process.kill()
            process.wait()


@dataclass(frozen=True, slots=True)
class Sleeps(RunTask):
    """A run that lasts as long as it is told."""

    def fly(self, run: int) -> RunRow:
        time.sleep(0.4)
        return RunRow(run, Status.DONE, "", 0, True, "", {})


@pytest.mark.long
@pytest.mark.slow
def test_rows_are_those_of_one_process_until_the_scheduler_is_lost(small, cluster, monkeypatch):
    monkeypatch.setattr("sim.campaign.executors.cluster.CONNECT_S", 3.0)
    file, scheduler = cluster
    task, runs = RunTask(small, Keep.NONE, Path()), [5, 0, 3]
    found = {row.run: replace(row, wall_s=0.0, worker="") for row in Cluster(str(file)).rows(task, runs)}
    assert found == {run: replace(task.fly(run), wall_s=0.0, worker="") for run in runs}
    rows = Cluster(str(file)).rows(Sleeps(small, Keep.NONE, Path()), range(100))
    assert next(rows).run in range(100)
    scheduler.send_signal(signal.SIGKILL)
    with pytest.raises(
        ClusterLostError, match=r"was lost after \d+ of 100 runs; what is done is kept"
    ) as caught:
        list(rows)
    assert caught.value.exit_code == 1


@pytest.mark.long
def test_no_scheduler_is_one_sentence(small, monkeypatch):
    monkeypatch.setattr("sim.campaign.executors.cluster.CONNECT_S", 0.5)
    rows = Cluster("tcp://127.0.0.1:9").rows(RunTask(small, Keep.NONE, Path()), [0])
    with pytest.raises(
        HarnessError, match=r"--scheduler tcp://127\.0\.0\.1:9: no scheduler answers"
    ) as caught:
        next(rows)
    assert "\n" not in str(caught.value)


def test_without_the_package_it_says_what_to_install(small, monkeypatch):
    original = builtins.__import__

    def missing(name, *arguments):
        if name.startswith("distributed"):
            raise ImportError(name)
        return original(name, *arguments)

    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(HarnessError, match=r"torquer\[cluster\]"):
        next(Cluster("tcp://127.0.0.1:9").rows(RunTask(small, Keep.NONE, Path()), [0]))


class OneWorker:
    """A client whose worker has the version and the code that it is told."""

    def __init__(self, digest):
        self.digest = digest

    def wait_for_workers(self, count, timeout):
        assert count == 1

    def run(self, function, *arguments):
        return {"tcp://w": self.digest if function is code_digest else function(*arguments)}

    def nthreads(self):
        return {"tcp://w": 4}


def test_a_worker_with_other_code_of_the_same_version_is_refused():
    assert Cluster("s")._ready(OneWorker(code_digest())) == 4
    with pytest.raises(HarnessError, match=r"tcp://w has other code of torquer .*, of digest 0123, this is "):
        Cluster("s")._ready(OneWorker("0123"))
