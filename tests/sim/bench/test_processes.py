"""The processes of a bench end with it, also those that do not react."""

import os
import signal
import subprocess
import time

import pytest

from sim.bench import processes
from sim.bench.processes import BenchProcesses, hub_of


@pytest.mark.long
def test_a_hub_that_does_not_react_is_killed(monkeypatch):
    monkeypatch.setattr(processes, "GRACE_S", 0.5)
    began = time.monotonic()
    with hub_of("loop") as served:
        os.kill(served.hub_pid, signal.SIGSTOP)
    assert time.monotonic() - began < 20.0
    assert not os.path.exists(f"/proc/{served.hub_pid}")


def test_a_process_that_does_not_react_is_killed(monkeypatch):
    monkeypatch.setattr(processes, "GRACE_S", 0.5)
    with BenchProcesses() as processes_started:
        process = processes_started.start("waiting", "http.server", "0")
        os.kill(process.popen.pid, signal.SIGSTOP)
    assert process.popen.returncode < 0


def test_a_process_that_was_killed_is_said_to_be_whatever_it_wrote_before():
    with BenchProcesses() as processes_started:
        killed = processes_started.start("killed", "http.server", "0")
        wrong = processes_started.start("wrong", "http.server", "--no-such-option")
        killed.errors.write(b"it began\n")
        killed.errors.flush()
        assert killed.last_error() == "it began"
        killed.popen.kill()
        for process in (killed, wrong):
            process.popen.wait(20.0)
        assert killed.last_error() == "by signal 9 (Killed)"
        assert "--no-such-option" in wrong.last_error()


@pytest.mark.parametrize(
    ("may_end", "command", "lost"),
    [(True, "exit 0", False), (True, "exit 4", True), (False, "exit 0", True), (False, "sleep 9", False)],
)
def test_a_process_is_lost_that_ends_before_it_may_or_with_an_error(tmp_path, may_end, command, lost):
    (tmp_path / "errors").touch()
    with BenchProcesses() as processes:
        popen = subprocess.Popen(["sh", "-c", command])
        process = processes.take("fsw", popen, tmp_path / "errors")
        process.may_end = may_end
        if command.startswith("exit"):
            popen.wait()
        assert process.is_lost == lost
