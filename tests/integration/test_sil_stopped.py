"""A plant or flight software that stands still: one sentence after a deadline, nothing left running."""

import json
import os
import signal
import time
from pathlib import Path
from threading import Thread

import pytest

from sim.errors import FlightError
from sim.flight import sil
from sim.flight.fsw_answers import Patience
from sim.flight.sil import fly_processes, serve_bus
from sim.record import run_dir
from sim.record.pace import Pace
from sim.scenario.schema import load

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks at processes in /proc"),
]

PATIENCE = Patience(boot_s=30.0, answer_s=1.5, silence_s=1.5)
LOCKSTEP, REAL_TIME = Pace(), Pace(50.0)


@pytest.fixture
def flight(tmp_path, monkeypatch, is_alive):
    """Flies, and stops a node once so many lines are logged: what the flight says, how long it took."""
    nodes = {}

    def start(module, *arguments, **pipes):
        nodes[module] = real_start(module, *arguments, **pipes)
        return nodes[module]

    real_start = sil.start_node
    monkeypatch.setattr(sil, "start_node", start)
    monkeypatch.setattr(sil, "MARGIN_S", 1.0)
    monkeypatch.setattr(sil, "GRACE_S", 0.5)

    def fly(victim, lines, pace, patience=PATIENCE):
        path, scenario = tmp_path / "run", load("microsat")
        run_dir.begin(path, scenario, 1, 50_000, "loop", pace)
        stopped_at = []

        def stop():
            log = path / run_dir.BUS_LOG
            while victim not in nodes or (lines and not (log.exists() and log.stat().st_size > 50 * lines)):
                time.sleep(0.02)
            nodes[victim].send_signal(signal.SIGSTOP)
            stopped_at.append(time.monotonic())

        stopper = Thread(target=stop)
        stopper.start()
        with pytest.raises(FlightError) as caught, serve_bus("loop") as (spec, hub):
            fly_processes(path, scenario, spec, hub, lambda tick: None, patience)
        stopper.join()
        took_s = time.monotonic() - stopped_at[0]
        assert not any(is_alive(node.pid) for node in nodes.values()), "something is left running"
        assert caught.value.exit_code == 1
        assert json.loads((path / run_dir.RUN).read_text())["complete"] is False
        return str(caught.value), took_s

    yield fly
    for node in nodes.values():
        node.kill()
        node.wait()


@pytest.mark.parametrize("pace", [LOCKSTEP, REAL_TIME], ids=["lockstep", "real time"])
@pytest.mark.parametrize(
    ("victim", "says"),
    [("fsw", "no answer from the flight software"), ("sim.flight.plant_process", "the plant is stalled")],
)
@pytest.mark.slow
def test_one_that_stands_still_in_flight_ends_it(victim, says, pace, flight, tmp_path, torquer, bus):
    sentence, took_s = flight(victim, 500, pace)
    assert sentence.startswith(says)
    assert str(tmp_path / "run") in sentence
    assert "\n" not in sentence
    assert took_s < 10.0
    assert len(bus(tmp_path / "run").frames) >= 400
    replayed = torquer("replay", tmp_path / "run")
    assert replayed.code == 1
    assert "incomplete" in replayed.out


@pytest.mark.slow
def test_flight_software_that_never_boots_ends_it(flight):
    sentence, _ = flight("fsw", 0, LOCKSTEP, Patience(boot_s=5.0, answer_s=1.5))
    assert sentence.startswith("the flight software has not booted within 5 s")


@pytest.mark.slow
def test_a_plant_that_never_begins_ends_it(flight):
    sentence, _ = flight("sim.flight.plant_process", 0, LOCKSTEP, Patience(boot_s=2.0, answer_s=1.5))
    assert sentence.startswith("the plant is stalled: its log has not grown for")


def test_the_deadlines_of_the_command_are_long_enough_for_a_loaded_machine():
    assert sil.PATIENCE.boot_s >= 60.0
    assert sil.PATIENCE.answer_s == sil.PATIENCE.silence_s == 20.0


def node_of(process, module):
    """The process that the command has started for a node."""
    for child in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split():
        words = Path(f"/proc/{child}/cmdline").read_text().split("\0")
        if module in words:
            return int(child)
    raise AssertionError(f"{module} is not running")


@pytest.mark.parametrize(
    ("victim", "says"),
    [("fsw", "no answer from the flight software"), ("sim.flight.plant_process", "the plant is stalled")],
)
@pytest.mark.slow
def test_so_does_the_command_itself(victim, says, start, is_alive, tmp_path):
    """With the deadlines that it has."""
    words = ("torquer", "sil", "--bus", "loop", "--orbits", "10", "--out", tmp_path / "run")
    sil_run = start(*words, start_new_session=True)
    log = tmp_path / "run" / "bus.log"
    while not (log.exists() and log.stat().st_size > 10_000):
        time.sleep(0.05)
    children = Path(f"/proc/{sil_run.process.pid}/task/{sil_run.process.pid}/children").read_text().split()
    os.kill(node_of(sil_run.process, victim), signal.SIGSTOP)
    ended = sil_run.wait(90)
    assert (ended.code, ended.out) == (1, "")
    assert says in ended.sentence
    assert "the run is not complete" in ended.sentence
    assert not any(is_alive(child) for child in children)
