"""Killing one of the processes of ``torquer sil``: one sentence, the other gone, what is written readable."""

import json
import os
import random
import signal
import time
from pathlib import Path

import h5py
import pytest

from fsw.wire.messages import Sync, TickDone

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="finds processes in /proc"),
]

PATIENCE_S = 120.0
"""In a guest that has just booted, three processes import for half a minute."""


def children_of(pid):
    """Module and process id of what a process has started."""
    found = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
                words = (entry / "cmdline").read_bytes().split(b"\0")
            except (OSError, IndexError):
                continue
            if parent == pid and b"-m" in words:
                found[words[words.index(b"-m") + 1].decode()] = int(entry.name)
    return found


def wait_until(condition):
    deadline = time.monotonic() + PATIENCE_S
    while not (result := condition()):
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.02)
    return result


class Flight:
    """A run of ``torquer sil`` that is under way."""

    def __init__(self, start, is_alive, run, *options, bus="loop"):
        self.run, self._is_alive = run, is_alive
        words = ("torquer", "sil", "--bus", bus, "--out", run, *options)
        self.sil = start(*words, start_new_session=True)
        self.nodes = wait_until(self._both_nodes)

    def _both_nodes(self):
        """The processes that it has started, among them the nodes; a long flight is replayed by one more."""
        assert self.sil.process.poll() is None, self.sil.stderr.read_text()
        found = children_of(self.sil.process.pid)
        return found if {"sim.flight.plant_process", "fsw"} <= set(found) else None

    def reach(self, lines):
        """Wait until so many lines have been logged."""
        log = self.run / "bus.log"
        wait_until(lambda: log.exists() and log.stat().st_size > 50 * lines)

    def is_gone(self):
        """Whether none of its processes is left."""
        return not any(map(self._is_alive, self.nodes.values()))

    def gone(self):
        wait_until(self.is_gone)


@pytest.fixture
def flight(start, is_alive, tmp_path):
    """Starts a flight that lasts longer than the test."""

    def begin(*options, bus="loop"):
        return Flight(start, is_alive, tmp_path / "run", "--orbits", "3", *options, bus=bus)

    return begin


def readable(run, bus, torquer):
    """What a flight that was cut short must leave; the last tick in the log."""
    assert json.loads((run / "run.json").read_text())["complete"] is False
    frames = bus(run).frames
    assert frames[-1].can_id == TickDone.ID, "not a whole tick"
    last = TickDone.decode(frames[-1].data).tick
    assert [Sync.decode(f.data).tick for f in frames if f.can_id == Sync.ID] == list(range(last + 1))
    with h5py.File(run / "truth.h5") as truth:
        assert truth["q_body_from_orbit"].shape[0] > last
    replayed = torquer("replay", run)
    assert replayed.code == 1
    assert replayed.out.startswith("bit-exact")
    assert f"at tick {last}" in replayed.out.splitlines()[-1]
    assert torquer("replay", run, "--plant").code == 1
    checked = torquer("check", run)
    assert checked.code == 1
    assert "VIOLATION" not in checked.out
    assert "incomplete" in checked.out
    return last


RANDOM = random.Random(20150327)


@pytest.mark.parametrize(
    ("victim", "signum", "lines"),
    [
        (victim, signum, RANDOM.randrange(20, 3000))
        for victim in ("sim.flight.plant_process", "fsw")
        for signum in (signal.SIGKILL, signal.SIGTERM)
    ],
    ids=lambda value: getattr(value, "name", value),
)
@pytest.mark.slow
def test_a_killed_node_ends_the_run(victim, signum, lines, flight, bus, torquer):
    sil_run = flight()
    sil_run.reach(lines)
    os.kill(sil_run.nodes[victim], signum)
    ended = sil_run.sil.wait()
    assert ended.code == 1
    assert ended.out == ""
    name = {"sim.flight.plant_process": "plant", "fsw": "flight software"}[victim]
    assert ended.sentence.startswith(f"torquer: the {name} ")
    sil_run.gone()
    last = readable(sil_run.run, bus, torquer)
    assert f"at tick {last}:" in ended.sentence
    assert str(sil_run.run) in ended.sentence
    if signum == signal.SIGTERM:
        return  # one report of each will do
    report = torquer("report", sil_run.run)
    assert report.code == 0
    assert "replay     bit-exact" in report.out
    assert {path.name for path in sil_run.run.iterdir()} >= {"summary.json", "report.html"}
    assert json.loads((sil_run.run / "run.json").read_text())["complete"] is False


@pytest.mark.parametrize("victim", ["sim.flight.plant_process", "fsw"])
def test_a_node_killed_before_the_first_tick_ends_the_run(victim, flight, torquer):
    sil_run = flight()
    os.kill(sil_run.nodes[victim], signal.SIGKILL)
    ended = sil_run.sil.wait()
    assert ended.code == 1
    assert "was ended by signal 9" in ended.sentence
    sil_run.gone()
    assert json.loads((sil_run.run / "run.json").read_text())["complete"] is False
    for command in ("replay", "check", "report"):
        done = torquer(command, sil_run.run)
        assert done.code == 2
        assert str(sil_run.run) in done.sentence


@pytest.mark.slow
def test_ctrl_c_is_one_sentence(flight, bus, torquer):
    sil_run = flight()
    sil_run.reach(500)
    os.killpg(sil_run.sil.process.pid, signal.SIGINT)  # a terminal interrupts the whole group
    ended = sil_run.sil.wait()
    assert (ended.code, ended.out) == (130, "")
    assert ended.sentence == "torquer: interrupted; what was written so far is kept"
    sil_run.gone()
    readable(sil_run.run, bus, torquer)


@pytest.mark.parametrize(
    ("signum", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129)], ids=["SIGTERM", "SIGHUP"]
)
@pytest.mark.slow
def test_who_is_asked_to_end_says_so_and_ends_its_nodes(signum, code, flight, bus, torquer):
    sil_run = flight()
    sil_run.reach(500)
    sil_run.sil.process.send_signal(signum)
    ended = sil_run.sil.wait()
    assert (ended.code, ended.out) == (code, "")
    assert ended.sentence == f"torquer: ended by {signum.name}; what was written so far is kept"
    assert sil_run.is_gone()
    readable(sil_run.run, bus, torquer)


@pytest.mark.slow
def test_nodes_end_by_themselves_when_sil_is_gone(flight):
    sil_run = flight()
    sil_run.sil.process.kill()
    ended = sil_run.sil.wait()
    assert (ended.code, ended.out) == (-signal.SIGKILL, "")
    assert "sim.report.conclude_process" in sil_run.nodes
    sil_run.gone()
    assert "Traceback" not in sil_run.sil.stderr.read_text()


def test_nodes_on_a_can_interface_end_with_sil(vcan0, flight, bus):
    """The bus lives on, and nothing on it tells them."""
    sil_run = flight("--orbits", "20", bus=f"socketcan:{vcan0}")
    sil_run.reach(100)
    sil_run.sil.process.kill()
    sil_run.sil.wait()
    sil_run.gone()
    assert bus(sil_run.run).frames[-1].can_id == TickDone.ID


@pytest.mark.slow
def test_flight_software_that_stands_still_for_a_second_is_waited_for(
    start, is_alive, tmp_path, bus, torquer, sil_run
):
    options = ("--orbits", "0.08", "--seed", "3")
    flight = Flight(start, is_alive, tmp_path / "run", *options)
    flight.reach(100)
    os.kill(flight.nodes["fsw"], signal.SIGSTOP)
    time.sleep(0.2)
    stood = (flight.run / "bus.log").stat().st_size
    time.sleep(0.8)
    assert (flight.run / "bus.log").stat().st_size == stood
    os.kill(flight.nodes["fsw"], signal.SIGCONT)
    assert flight.sil.wait().code == 0
    assert flight.is_gone()
    assert bus(flight.run) == bus(sil_run("realsat", *options, "--bus", "virtual"))
    assert torquer("replay", flight.run).code == 0
