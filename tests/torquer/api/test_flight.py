"""``torquer.fly`` and ``torquer.report``: what the commands do, from scripts, notebooks and threads."""

import _thread
import gc
import json
import multiprocessing
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Thread

import matplotlib
import numpy as np
import pytest

import torquer
from sim.flight import sil
from sim.flight.sil import start_node

SHORT = 0.005


def bus_of(run):
    """The log without the name of its bus."""
    return [(line.split()[0], line.split()[2]) for line in run.log.read_text().splitlines()]


def judged(run):
    """The summary without what depends on the speed of the machine."""
    return {
        key: value for key, value in run.summary.items() if key not in ("wall_seconds", "realtime_factor")
    }


@pytest.mark.long
def test_it_flies_what_the_command_flies_and_judges_it_the_same(flown, command, tmp_path):
    words = ("microsat", "--orbits", "0.05", "--seed", "7", "--bus", "virtual", "--out", tmp_path / "run")
    done = command("sil", *words)
    theirs = torquer.load(tmp_path / "run")
    assert done.exit_code == 0
    assert done.stdout == f"{theirs}\nreport: {theirs.report}\n"
    assert theirs.log.read_bytes() == flown.log.read_bytes()
    assert judged(theirs) == judged(flown)
    assert flown.ok
    assert flown.failures == {}
    assert flown.report.is_file()


@pytest.mark.long
def test_settings_have_dots_or_sections_and_values_of_numpy(tmp_path):
    over = {"time.tick_hz": np.int64(2), "coils": {"backoff": "per_coil"}, "initial.axis": np.eye(3)[1]}
    run = torquer.fly("microsat", orbits=SHORT, set=over, out=tmp_path / "run")
    flown = run.scenario
    assert (flown.time.tick_hz, flown.coils.backoff, flown.initial.axis) == (2, "per_coil", (0.0, 1.0, 0.0))


def test_what_flies_can_be_read_again_and_what_cannot_is_refused_before_anything_is_there(tmp_path):
    residue = {"body.inertia_kgm2": [[1.02, 2.2e-19, 0], [2.2e-19, 1.85, 0], [0, 0, 1.95]]}
    run = torquer.fly("microsat", orbits=SHORT, set=residue, out=tmp_path / "run")
    assert torquer.load(tmp_path / "run").scenario == run.scenario
    beyond = {"disturbance.torque_nm": [1e-19, 0.0, 0.0]}
    with pytest.raises(
        torquer.InputError, match=r"disturbance.torque_nm.0 is not allowed: a number is 0, or"
    ):
        torquer.fly("microsat", orbits=SHORT, set=beyond, out=tmp_path / "beyond")
    unreadable = run.scenario.model_copy(update={"summary": "\udcff"})
    with pytest.raises(torquer.InputError, match="cannot be written"):
        torquer.fly(unreadable, orbits=SHORT, out=tmp_path / "unreadable")
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


@pytest.mark.long
def test_what_is_most_likely_wrong_is_said_once_before_by_the_command_too(tmp_path, capsys, command):
    known = "disturbance.residual_dipole_am2 is off by 0.008, and flight.uncertainty.residual_dipole_am2 = 0"
    undeclared = {"disturbance.residual_dipole_am2": [0.0, -0.008, 0.0]}
    torquer.fly("microsat", set=undeclared, orbits=SHORT, out=tmp_path / "api")
    (line,) = capsys.readouterr().err.splitlines()
    assert line == f"torquer: warning: {known}: the filter is not made for it"
    words = ("microsat", "--orbits", SHORT, "--bus", "virtual", "--out", tmp_path / "command")
    done = command("sil", *words, "--set", "disturbance.residual_dipole_am2=[0,-0.008,0]")
    assert done.stderr.count("warning: ") == done.stderr.count(known) == 1


def test_what_is_expected_is_judged_and_a_failure_of_the_run(tmp_path):
    run = torquer.fly("microsat", orbits=1.0, expect=["ape<2", "ape<90"], out=tmp_path / "run")
    assert [one["verdict"] for one in run.summary["requirements"][-2:]] == ["failed", "met"]
    assert not run.ok
    assert "APE of whole attitude" in run.failures["requirements"]
    assert len(run.scenario.requirement) == len(run.summary["requirements"])


def test_what_the_caller_holds_is_collected_as_before(tmp_path):
    before = gc.get_freeze_count()
    torquer.fly("microsat", orbits=SHORT, out=tmp_path / "run")
    assert gc.get_freeze_count() == before


def test_what_is_expected_of_a_flight_that_is_too_short_is_not_judged(tmp_path):
    run = torquer.fly("microsat", orbits=SHORT, expect=["ape<2"], out=tmp_path / "run")
    assert run.summary["requirements"][-1]["verdict"] == "not judged"
    assert run.ok


@pytest.mark.long
def test_the_scenario_of_a_run_can_be_flown_again(flown, tmp_path):
    again = torquer.fly(flown.scenario, orbits=0.05, seed=np.uint64(7), out=tmp_path / "again")
    assert again.log.read_bytes() == flown.log.read_bytes()


@pytest.mark.long
def test_two_processes_say_nothing_and_give_the_same_log(flown, tmp_path, capfd):
    run = torquer.fly("microsat", orbits=0.05, seed=7, bus="loop", out=tmp_path / "run")
    assert capfd.readouterr() == ("", "")
    assert bus_of(run) == bus_of(flown)


@pytest.mark.long
@pytest.mark.parametrize(("progress", "said"), [(True, "bus: loop (auto)\n"), (False, "")])
def test_which_bus_it_took_is_said_if_progress_is_wanted(progress, said, tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(sil, "resolve", lambda spec: "loop:28011")
    torquer.fly("microsat", orbits=SHORT, bus="auto", out=tmp_path / "run", progress=progress)
    assert capfd.readouterr() == ("", said)


@pytest.mark.long
def test_flights_at_once_in_threads_are_those_that_fly_alone(flown, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    before = dict(matplotlib.rcParams)
    with ThreadPoolExecutor(3) as threads:
        buses = ("virtual", "loop", "virtual")
        flights = [threads.submit(torquer.fly, "microsat", orbits=0.05, seed=7, bus=bus) for bus in buses]
        runs = [flight.result() for flight in flights]
    assert len({run.path for run in runs}) == 3
    assert all(bus_of(run) == bus_of(flown) for run in runs)
    assert dict(matplotlib.rcParams) == before


UNGUARDED = """
from threading import Thread
import torquer

def campaign():
    print(len(torquer.campaign("microsat", runs=2, orbits=0.005, workers=2).results))

print("once")
assert torquer.fly("microsat", orbits=0.005, bus="loop").ok
thread = Thread(target=campaign)
thread.start()
thread.join()
"""


@pytest.mark.long
@pytest.mark.slow
def test_a_script_needs_no_guard_and_may_fly_in_a_thread(tmp_path):
    (tmp_path / "script.py").write_text(UNGUARDED)
    done = subprocess.run(
        [sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "once\n2\n", "")


@pytest.mark.long
@pytest.mark.parametrize("bus", ["virtual", "loop"])
def test_ctrl_c_ends_the_nodes_and_leaves_a_run_that_can_be_reported(bus, tmp_path, monkeypatch):
    nodes, path = [], tmp_path / "run"

    def start(*words, **pipes):
        nodes.append(start_node(*words, **pipes))
        return nodes[-1]

    def interrupt():
        while not (path / "bus.log").exists() or (path / "bus.log").stat().st_size < 20_000:
            pass
        _thread.interrupt_main()

    monkeypatch.setattr(sil, "start_node", start)
    Thread(target=interrupt, daemon=True).start()
    with pytest.raises(KeyboardInterrupt):
        torquer.fly("microsat", orbits=1.5, bus=bus, out=path)
    assert [node.poll() is not None for node in nodes] == [True] * (2 * (bus == "loop"))
    assert multiprocessing.active_children() == []
    run = torquer.load(path)
    assert not run.ok
    assert run.failures == {
        "complete": f"the flight was interrupted: the run is not complete, its files are in {path}"
    }
    with pytest.raises(torquer.InputError, match="torquer report"):
        run.summary  # noqa: B018  to be asked for is to fail
    assert set(torquer.report(path).failures) == {"complete"}
    assert run.concluded


@pytest.mark.long
def test_a_flight_whose_node_ends_raises_nothing_and_tells(tmp_path, monkeypatch, command):
    def start(module, *arguments, **pipes):
        node = start_node(module, *arguments, **pipes)
        if module == "fsw":
            node.kill()
        return node

    monkeypatch.setattr(sil, "start_node", start)
    run = torquer.fly("microsat", bus="loop", out=tmp_path / "run")
    assert not run.ok
    assert "the flight software was ended by signal 9" in run.failures["complete"]
    assert str(run) == run.failures["complete"]
    done = command("sil", "microsat", "--bus", "loop", "--out", tmp_path / "other")
    assert (done.exit_code, done.stdout) == (1, "")
    assert "the flight software was ended by signal 9" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"scenario": "nowhere"}, "nowhere"),
        ({"scenario": "nowhere.toml"}, "nowhere.toml"),
        ({"scenario": 3}, "scenario = 3"),
        ({"orbits": 0}, "orbits = 0 .* above 0"),
        ({"orbits": float("nan")}, "nan"),
        ({"orbits": "many"}, "orbits = 'many'"),
        ({"seed": -1}, "seed = -1"),
        ({"seed": 1.5}, "seed = 1.5"),
        ({"bus": "can0"}, "can0"),
        ({"bus": None}, "bus = None"),
        ({"pace": "fast"}, "fast"),
        ({"set": {"time.tick_hz": "fast"}}, "time.tick_hz = 'fast'"),
        ({"set": {"time.nothing": 1}}, "time.nothing"),
        ({"set": ["time.tick_hz=3"]}, "dictionary"),
        ({"out": 3}, "out = 3"),
        ({"out": ""}, "out = ''"),
        ({"sign": "nowhere.pem"}, "nowhere.pem"),
        ({"expect": ["ape>2"]}, "--expect 'ape>2'"),
        ({"expect": "ape<2"}, "expect = 'ape<2' .* allowed is a list"),
        ({"expect": [2.0]}, "expect.0 = 2.0"),
    ],
    ids=str,
)
def test_wrong_input_is_one_sentence_and_leaves_nothing(arguments, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(torquer.InputError, match=says) as caught:
        torquer.fly(**{"scenario": "microsat", **arguments})
    assert "\n" not in str(caught.value)
    assert caught.value.exit_code == 2
    assert (caught.value.__cause__, caught.value.__suppress_context__) == (None, True)
    assert list(tmp_path.iterdir()) == []


def test_a_run_is_not_flown_over(copy):
    before = copy.log.read_bytes()
    with pytest.raises(torquer.InputError, match="already holds a run"):
        torquer.fly("microsat", orbits=SHORT, out=copy.path)
    assert copy.log.read_bytes() == before


@pytest.mark.long
def test_report_makes_the_summary_again_and_tells_what_was_changed(copy, command):
    edited = {**copy.summary, "seed": 8}
    (copy.path / "summary.json").write_text(json.dumps(edited))
    again = torquer.report(copy.path)
    assert again.mismatched
    assert "summary.json is not the run's own" in "\n".join(again.notes)
    assert judged(again) == judged(copy)
    done = command("report", copy.path)
    assert (done.exit_code, done.stdout) == (0, f"{again}\nreport: {again.report}\n")


def test_report_refuses_a_run_with_the_log_of_another(copy):
    copy.log.write_text(copy.log.read_text().replace("virtual", "another"))
    with pytest.raises(torquer.Error, match=r"bus\.log is not the run's own") as caught:
        torquer.report(copy.path)
    assert not isinstance(caught.value, torquer.InputError)
    assert caught.value.exit_code == 1


@pytest.mark.long
def test_without_out_each_flight_has_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runs = [torquer.fly("microsat", orbits=SHORT) for _ in range(2)]
    assert [run.path.parent for run in runs] == [Path("runs")] * 2
    assert runs[0].path != runs[1].path
