"""The replay that follows a flight in another process gives what a replay after the flight does."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from sim.errors import HarnessError
from sim.flight import virtual
from sim.record import run_dir
from sim.record.pace import LOCKSTEP
from sim.record.truth import RowsMissingError
from sim.report import conclude as conclude_module
from sim.report import follow as following
from sim.report.conclude import conclude, conclude_flight
from sim.report.follow import follow
from sim.scenario.schema import load

pytestmark = pytest.mark.long

TICKS = 300
LONG = 9000
"""More than two blocks of histories, so that one is handed over during the flight."""


@pytest.fixture
def started(monkeypatch):
    """The processes that are started."""
    processes, start_node = [], following.start_node

    def start(*arguments, **pipes):
        processes.append(start_node(*arguments, **pipes))
        return processes[-1]

    monkeypatch.setattr(following, "start_node", start)
    return processes


@pytest.fixture
def begin(tmp_path, monkeypatch):
    """Begins a run that is followed, although it is short."""
    monkeypatch.setattr(following, "LEAST_TICKS", TICKS)
    monkeypatch.setattr(os, "cpu_count", lambda: 2)

    def begin_run(ticks):
        run_dir.begin(tmp_path / "run", load("realsat"), 3, ticks, "virtual", LOCKSTEP)
        return tmp_path / "run"

    return begin_run


@pytest.fixture
def begun(begin):
    """A run that has been begun."""
    return begin(TICKS)


def fly(path):
    virtual.fly_virtual(path, run_dir.read_scenario(path), lambda tick: None)


def results(path):
    return [(path / name).read_bytes() for name in (run_dir.SUMMARY, run_dir.REPORT)]


@pytest.mark.slow
def test_its_results_are_those_of_a_replay_after_the_flight(begin):
    begun = begin(LONG)
    told = []
    with follow(begun, LONG) as conclude_run:
        fly(begun)
        summary = conclude_run(told.append)
    assert summary == json.loads((begun / run_dir.SUMMARY).read_text())
    assert summary["replay"] == {"bit_exact": True, "command_exact": True, "ticks": LONG}
    assert run_dir.read_run(begun)["complete"] is True
    assert told == sorted(told)
    assert all(0 <= tick <= LONG for tick in told)
    followed = results(begun)
    assert conclude(begun) == summary
    assert results(begun) == followed


def test_what_cannot_be_followed_is_concluded_after_the_flight(begun, monkeypatch):
    """A count of ticks that runs ahead of the plant's asks for rows that are not there yet."""
    left = [True, True]
    fly(begun)
    monkeypatch.setattr(conclude_module, "GrowingTruth", AheadOfPlant)
    summary = conclude_flight(begun, lambda: bool(left and left.pop()))
    assert (summary["ticks"], summary["replay"]["bit_exact"], left) == (TICKS, True, [])


class AheadOfPlant:
    """Histories without rows."""

    def __init__(self, path, ticks):
        self.complete = ticks

    def rows(self, first, past):
        raise RowsMissingError("not yet")


def test_a_short_flight_and_one_processor_need_no_other_process(begun, started, monkeypatch):
    with follow(begun, TICKS - 1):
        pass
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    with follow(begun, TICKS) as conclude_run:
        fly(begun)
        assert conclude_run(lambda tick: None)["replay"]["bit_exact"]
    assert started == []


def test_a_flight_that_fails_takes_the_process_with_it(begun, started):
    with pytest.raises(RuntimeError, match="the flight failed"), follow(begun, TICKS):
        raise RuntimeError("the flight failed")
    assert started[0].poll() is not None
    assert not (begun / run_dir.SUMMARY).exists()


def test_a_process_that_is_killed_is_told_and_the_run_can_be_concluded(begun, started):
    with follow(begun, TICKS) as conclude_run:
        started[0].kill()
        fly(begun)
        with pytest.raises(HarnessError, match=r"was ended by signal 9: torquer report .* concludes it"):
            conclude_run(lambda tick: None)
    assert conclude(begun)["replay"]["bit_exact"]


@pytest.mark.slow
def test_a_file_that_is_locked_while_it_is_written_is_read_after_the_flight(begin, monkeypatch):
    monkeypatch.setenv("HDF5_USE_FILE_LOCKING", "TRUE")
    path = begin(LONG)
    with follow(path, LONG) as conclude_run:
        fly(path)
        assert conclude_run(lambda tick: None)["replay"]["bit_exact"]
    assert run_dir.read_run(path)["complete"] is True


def test_a_run_that_cannot_be_replayed_is_told_before_the_flight_is_over(begun, started):
    """The process ends by itself, while it still waits for the end of the flight."""
    (begun / run_dir.SCENARIO).write_text("no = 'scenario'")
    with follow(begun, TICKS) as conclude_run:
        started[0].wait(30.0)
        with pytest.raises(HarnessError, match=r"scenario\.toml"):
            conclude_run(lambda tick: None)


def test_a_log_that_is_altered_during_the_flight_is_told_in_one_sentence(begun):
    with follow(begun, TICKS) as conclude_run:
        fly(begun)
        with (begun / run_dir.BUS_LOG).open("ab") as log:
            log.write(b"no line\n")
        with pytest.raises(HarnessError, match="is not a candump line") as refusal:
            conclude_run(lambda tick: None)
    assert "\n" not in str(refusal.value)


def test_without_the_flight_the_process_ends(begun):
    process = subprocess.Popen(
        [sys.executable, "-m", "sim.report.conclude_process", str(begun)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    time.sleep(1.0)
    assert process.poll() is None
    process.communicate(timeout=20.0)  # closes its input: who flew has gone
    assert process.returncode == -signal.SIGTERM
    assert not (begun / run_dir.SUMMARY).exists()
