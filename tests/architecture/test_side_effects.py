"""Importing does nothing but define; flight core and boards keep nothing outside their states."""

import json
import pickle
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

from fsw.node import FlightNode
from fsw.table.config import flight_config
from hil_stub.coils.coil_driver import CoilDriver, CoilLimits
from hil_stub.sensors.magnetometer import Magnetometer
from hil_stub.sensors.sun_sensor import SunSensor
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import flight_table, load

ROOT = Path(__file__).resolve().parents[2]

IMPORT_AND_WATCH = """
import json, os, signal, sys, threading
doings = []
def watch(event, args):
    if event == "open":
        path, mode, flags = args
        writes = (flags or 0) & (os.O_WRONLY | os.O_RDWR | os.O_CREAT)
        if writes and not str(path).startswith(("/dev/", "/proc/")):
            doings.append(f"opens {path} to write")
    elif event.partition(".")[0] in ("socket", "subprocess", "shutil", "tempfile", "signal"):
        doings.append(event)
    elif event in ("os.system", "os.fork", "os.exec", "os.posix_spawn", "os.mkdir", "os.remove", "os.rename",
                   "os.putenv", "os.chdir"):
        doings.append(f"{event} {args}")
FIRST
sys.dont_write_bytecode = True
sys.addaudithook(watch)
before = (list(sys.path), dict(os.environ), os.getcwd(), signal.getsignal(signal.SIGTERM),
          signal.getsignal(signal.SIGINT), threading.active_count(), sys.excepthook)
THEN
after = (list(sys.path), dict(os.environ), os.getcwd(), signal.getsignal(signal.SIGTERM),
         signal.getsignal(signal.SIGINT), threading.active_count(), sys.excepthook)
doings += [f"changes {b} to {a}" for b, a in zip(before, after, strict=True) if b != a]
print(json.dumps([doings, sorted(sys.modules)]))
"""
LIBRARIES = (
    "can, click, filterpy.kalman, h5py, jinja2, matplotlib.figure, pydantic, rich.progress, sgp4.api, tomli_w"
)


def within(name, package):
    return name == package or name.startswith(f"{package}.")


def names(*packages):
    for package in packages:
        for path in sorted((ROOT / package).rglob("*.py")):
            yield ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def watched(modules, first="sys"):
    """What importing the modules does, all in one fresh interpreter, and which ones are loaded then."""
    imports = {"FIRST": f"import {first}", "THEN": f"import {', '.join(modules)}"}
    script = IMPORT_AND_WATCH
    for mark, line in imports.items():
        script = script.replace(f"\n{mark}\n", f"\n{line}\n")
    words = [sys.executable, "-W", "error", "-c", script]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert len(done.stdout.splitlines()) == 1, "an import prints"
    return json.loads(done.stdout)


@pytest.mark.long
@pytest.mark.slow
def test_importing_every_module_does_nothing_else():
    ours = list(names("fsw", "hil_stub", "sim"))
    doings, loaded = watched(ours, first=LIBRARIES)
    assert doings == []
    assert set(ours) <= set(loaded)


def test_what_an_import_does_would_be_seen(tmp_path, monkeypatch):
    (tmp_path / "doer.py").write_text(
        "import os, socket, threading\n"
        f"open({str(tmp_path / 'left')!r}, 'w').close()\n"
        "socket.socket().close()\n"
        "threading.Thread(target=threading.Event().wait, daemon=True).start()\n"
        "os.environ['LEFT_BEHIND'] = '1'\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=":")
    doings, _ = watched(["doer"])
    assert any("left to write" in doing for doing in doings)
    assert any("socket.__new__" in doing for doing in doings)
    assert "changes 1 to 2" in doings, "the thread"
    assert any("LEFT_BEHIND" in doing for doing in doings)


@pytest.mark.long
@pytest.mark.parametrize(
    ("module", "strangers"),
    [
        ("fsw.wire.messages", ("fsw.core", "fsw.bus", "fsw.table", "hil_stub", "sim")),
        ("fsw.core.step", ("fsw.bus", "fsw.table", "fsw.input", "hil_stub", "sim", "torquer")),
        ("fsw.__main__", ("hil_stub", "sim", "torquer")),
        ("hil_stub.coils.coil_driver", ("fsw.core", "fsw.bus", "fsw.table", "sim")),
        ("hil_stub.__main__", ("fsw.core", "sim", "torquer")),
        ("sim.plant.plant", ("fsw.core", "fsw.bus", "fsw.table", "sim.flight", "torquer")),
        ("sim.flight.plant_process", ("filterpy", "scipy", "matplotlib", "can")),
        ("sim.new_scenario.command", ("filterpy", "scipy", "matplotlib", "can")),
        ("sim.sizing.command", ("filterpy", "scipy", "matplotlib", "can")),
        ("torquer.cli.main", ("filterpy", "scipy", "matplotlib", "can", "numpy", "h5py")),
    ],
)
def test_a_layer_loads_no_other(module, strangers):
    """What really lies in memory, lazily imported and indirect modules too.

    A library that a process has no use for would only make it start late.
    """
    _, loaded = watched([module])
    assert [name for name in loaded if any(within(name, stranger) for stranger in strangers)] == []


# --- nothing is kept between the lines


@pytest.fixture(scope="module")
def recorded():
    """What a plant sends in 130 ticks, and what the flight software answers."""
    return {name: fly(name) for name in ("microsat", "posat1")}


def node_of(name):
    return FlightNode(flight_config(flight_table(load(name))))


def fly(name, ticks=130):
    plant, node = Plant(plant_config(load(name), 5)), node_of(name)
    history = []
    for _ in range(ticks):
        sent = plant.begin_tick()
        answers = [answer for frame in sent for answer in node.receive(frame)]
        for answer in answers:
            plant.receive(answer)
        plant.end_tick()
        history.append((sent, answers))
    return history


def test_two_controllers_in_one_process_do_not_know_each_other(recorded):
    nodes = {name: node_of(name) for name in recorded}
    for tick in range(130):
        for name, node in nodes.items():
            sent, answers = recorded[name][tick]
            assert [answer for frame in sent for answer in node.receive(frame)] == answers


def constants(*packages):
    """All values that modules hold, but what is defined by its code alone."""
    for name in names(*packages):
        if not name.endswith("__main__"):
            for key, value in vars(import_module(name)).items():
                if not key.startswith("__"):
                    try:
                        yield f"{name}.{key}", pickle.dumps(value)
                    except (TypeError, AttributeError, pickle.PicklingError):
                        continue  # a module, a lambda: no value


def test_a_flight_leaves_every_value_of_the_modules_as_it_was(recorded):
    before = dict(constants("fsw/core", "fsw/wire", "hil_stub", "sim/plant"))
    assert len(before) > 300
    assert fly("microsat") == recorded["microsat"]
    assert dict(constants("fsw/core", "fsw/wire", "hil_stub", "sim/plant")) == before


def test_new_boards_know_nothing_of_old_ones():
    def first_frames():
        boards = Magnetometer(1), SunSensor(1), CoilDriver(CoilLimits(tick_hz=1))
        field, sun, coil = boards
        return [
            field.begin_tick(0, (1e-5, 2e-5, 3e-5), True),
            sun.begin_tick(0, (1.0, 0.0, 0.0), True),
            coil.begin_tick(0, 0.0),
        ]

    assert first_frames() == first_frames()
