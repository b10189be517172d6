"""Memory through a run: growth that was planted is found, and what cannot be judged is not."""

import os
import subprocess
import sys

import pytest

from sim.bench import memory
from sim.bench.memory import MemoryMonitor, growth_percent, resident_kib, scheduling


@pytest.fixture
def resident(monkeypatch):
    """What each process has, by its id; to be changed as it runs."""
    kib = {1: 1000, 2: 5000}
    monkeypatch.setattr(memory, "resident_kib", kib.get)
    return kib


def watched(ticks=1000, warm_s=20.0, grain=None):
    return MemoryMonitor({"fsw": 1, "coil": 2}, ticks, 10, warm_s, grain)


def test_growth_counts_from_when_all_is_warm(resident):
    history = watched()
    for tick in range(1000):
        resident[1] = 500 + min(tick, 200) * 5 // 2 + (30 if tick >= 900 else 0)
        history.sample(tick)
    assert history.growth_percent() == pytest.approx({"fsw": 3.0, "coil": 0.0})


def test_a_peak_counts_though_it_is_given_back(resident):
    history = watched()
    for tick in range(1000):
        resident[2] = 5250 if tick == 500 else 4000 if tick > 500 else 5000
        history.sample(tick)
    assert history.growth_percent()["coil"] == pytest.approx(5.0)


def test_a_process_that_is_gone_is_not_kept_to_be_flat(resident):
    history = watched()
    for tick in range(1000):
        if tick == 150:
            del resident[1]
        history.sample(tick)
    assert history.growth_percent() == {"fsw": float("inf"), "coil": 0.0}


def test_a_process_that_ended_and_is_not_waited_for_is_gone():
    with subprocess.Popen(["true"]) as ended:
        os.waitid(os.P_PID, ended.pid, os.WEXITED | os.WNOWAIT)
        assert resident_kib(ended.pid) is None
        history = MemoryMonitor({"this": os.getpid(), "ended": ended.pid}, 100, 10, 2.0)
        for tick in range(100):
            history.sample(tick)
    assert history.growth_percent()["ended"] == float("inf")


@pytest.mark.parametrize(("ticks", "judged"), [(210, False), (211, True)])
def test_a_run_that_ends_before_it_is_warm_is_not_judged(resident, ticks, judged):
    history = watched(ticks)
    for tick in range(ticks):
        history.sample(tick)
    assert bool(history.growth_percent()) is judged


def test_where_the_system_tells_nothing_nothing_is_judged(resident):
    resident.clear()
    history = watched()
    for tick in range(1000):
        history.sample(tick)
    assert history.growth_percent() == {}


@pytest.mark.parametrize(("grain", "every_s", "samples"), [(None, 41.0, 244), (64, 38.4, 261)])
def test_a_long_run_has_no_more_samples_than_can_be_looked_at(resident, grain, every_s, samples):
    history = watched(100_000, 0.0, grain)
    for tick in range(0, 100_000, grain or 1):
        history.sample(tick)
    samples_of_run = history.history()
    assert (samples_of_run["every_s"], len(samples_of_run["kib"]["fsw"])) == (every_s, samples)


def test_growth_is_relative_to_the_sample_that_is_warm():
    assert growth_percent([1, 200, 210, 205], 1) == pytest.approx(5.0)
    assert growth_percent([500, 200, 100], 1) == pytest.approx(-50.0)
    assert growth_percent([1, 200], 1) == float("inf")


def test_this_process_and_one_that_really_grows():
    grower = "import sys\nfor line in sys.stdin: kept = bytes([1]) * 50_000_000; print(flush=True)"
    with subprocess.Popen(
        [sys.executable, "-c", grower], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        before = resident_kib(process.pid)
        process.stdin.write(b"\n")
        process.stdin.flush()
        process.stdout.readline()
        after = resident_kib(process.pid)
        process.stdin.close()
    assert after - before > 40_000
    assert resident_kib(process.pid) is None
    assert resident_kib(os.getpid()) > 5000
    assert scheduling().startswith(("ordinary, nice ", "real time, priority "))
