"""Software in the loop: plant and flight software as two processes on a bus."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from fsw.io.bus import Bus
from fsw.io.hub import Hub
from fsw.io.link import LoopLink
from fsw.io.open_bus import open_bus, resolve
from sim.harness import run_dir
from sim.harness.assemble import plant_config
from sim.harness.errors import HarnessError
from sim.harness.faults.section import make_plant
from sim.harness.flight import BusLog, FlightError, Pace, fly
from sim.harness.scenario import Scenario, flight_table, orbit_period_s
from sim.harness.telecommands import uplink
from sim.harness.truth import TruthFile

POLL_S = 0.1
GRACE_S = 5.0
MOST_TICKS = 2**24 - 1
"""What PLANT_END can tell."""

Watch = Callable[[int], None]


def ticks_of(scenario: Scenario, orbits: float | None) -> int:
    """How many ticks a flight of so many orbits takes; None: as the scenario says. At least one.

    Raises:
        HarnessError: more than a run can have.
    """
    ticks_per_orbit = orbit_period_s(scenario) * scenario.time.tick_hz
    chosen = scenario.time.orbits if orbits is None else orbits
    if not chosen * ticks_per_orbit <= MOST_TICKS:  # not a number, either
        option = f"time.orbits={chosen:g}" if orbits is None else f"--orbits {chosen:g}"
        most = MOST_TICKS / ticks_per_orbit
        raise HarnessError(f"{option}: a run has at most {MOST_TICKS} ticks, here {most:.0f} orbits")
    return max(1, round(chosen * ticks_per_orbit))


def check_flyable(scenario: Scenario, seed: int) -> None:
    """Build plant and flight software once, before a run is begun that one of them could not fly.

    Raises:
        TableError: why not.
    """
    from fsw.io.config import flight_config  # noqa: PLC0415  (the plant's process has no flight software)

    flight_config(flight_table(scenario))
    check_plant(scenario, seed)


def check_plant(scenario: Scenario, seed: int) -> None:
    """The same of the plant alone."""
    make_plant(plant_config(scenario, seed), scenario.fault)


def record(path: Path, scenario: Scenario, bus: Bus, watch: Watch = lambda tick: None) -> None:
    """Fly the run that ``path`` was begun for, and keep its log and histories there.

    Raises:
        FlightError: the flight software gives no answer.
        BusError: the bus failed.
    """
    run = run_dir.read_run(path)
    plant = make_plant(plant_config(scenario, run["seed"]), scenario.fault)
    pace = Pace(run["pace_factor"])
    try:
        with (
            BusLog(path / run_dir.BUS_LOG, bus.name) as log,
            TruthFile(path / run_dir.TRUTH, run["ticks"], plant.torque_sources) as truth,
        ):
            flown = fly(
                plant,
                bus,
                log,
                truth,
                run["ticks"],
                scenario.epoch_unix_s,
                scenario.time.tick_hz,
                pace,
                watch,
                uplink(scenario.telecommand, scenario.time.tick_hz),
            )
    finally:
        bus.close()
    run_dir.update(
        path,
        flown={"ticks": flown.ticks, "slips": flown.slips, "wall_s": flown.wall_s},
        **{run_dir.DIGESTS: {run_dir.BUS_LOG: log.sha256}},
    )


@contextmanager
def served(bus: str) -> Iterator[tuple[str, Hub | None]]:
    """A bus for two processes: its spec in full, and the hub if it is a loop bus that is hosted here.

    Raises:
        BusError: the bus cannot be used.
    """
    spec = resolve(bus)
    if not spec.startswith("loop:"):
        open_bus(spec).close()
        yield spec, None
        return
    port = int(spec.removeprefix("loop:"))
    try:
        hub = Hub(0 if bus in ("loop", "auto") else port)
    except OSError:  # somebody else hosts it, or keeps the port for something else
        LoopLink(port, timeout_s=1.0, may_host=False).close()
        yield spec, None
        return
    try:
        yield f"loop:{hub.port}", hub
    finally:
        hub.close()


def fly_processes(path: Path, scenario: Scenario, spec: str, hub: Hub | None, watch: Watch) -> None:
    """Fly with plant and flight software as two processes on a bus, as ``served`` gives it.

    Raises:
        FlightError: one of the two ended before its time; the other has been ended too.
    """
    scenario_file = str(path / run_dir.SCENARIO)
    parent = str(os.getpid())
    plant = start_node("sim.plant", scenario_file, "--bus", spec, "--into", str(path), "--parent", parent)
    fsw = start_node("fsw", scenario_file, "--bus", spec, "--parent", parent)
    try:
        while plant.poll() is None and fsw.poll() is None:
            _serve(hub, POLL_S)
            watch(last_tick(path, scenario))
        deadline = time.monotonic() + GRACE_S
        while (
            (plant.poll() is None or fsw.poll() is None) and time.monotonic() < deadline and _well(plant, fsw)
        ):
            _serve(hub, POLL_S / 10.0)
    finally:
        failed = [
            (name, process)
            for name, process in (("plant", plant), ("flight software", fsw))
            if process.poll()
        ]
        for process in (plant, fsw):
            _end(process, hub)
    if failed or "flown" not in run_dir.read_run(path):
        name, process = failed[0] if failed else ("flight software", fsw)
        raise FlightError(
            f"the {name} {_how(process.returncode)} at tick {last_tick(path, scenario)}: "
            f"the run is not complete, what was flown is in {path}"
        )


def last_tick(path: Path, scenario: Scenario) -> int:
    """The tick of the last line in the log so far; 0 while there is none."""
    try:
        with (path / run_dir.BUS_LOG).open("rb") as log:
            log.seek(0, os.SEEK_END)
            log.seek(max(0, log.tell() - 256))
            tail = log.read()
    except OSError:
        return 0
    stamps = [line[1:].partition(b")")[0] for line in tail.splitlines() if line.startswith(b"(")]
    if not stamps:
        return 0
    return round((float(stamps[-1]) - scenario.epoch_unix_s) * scenario.time.tick_hz)


def start_node(module: str, *arguments: str) -> subprocess.Popen[bytes]:
    """A node as a process, of the same code. Ctrl-C is for this process alone: it ends its nodes itself."""
    words = [sys.executable, "-m", module, *arguments]
    path = {"PYTHONPATH": os.pathsep.join(sys.path), "PYTHONSAFEPATH": "1"}  # not what lies in this directory
    environment = {**os.environ, **path, "OPENBLAS_NUM_THREADS": "1"}
    return subprocess.Popen(words, env=environment, start_new_session=True)


def _serve(hub: Hub | None, seconds: float) -> None:
    """Let time pass; where the bus is hosted here, by serving it."""
    if hub is None:
        time.sleep(seconds)
        return
    deadline = time.monotonic() + seconds
    while (remaining_s := deadline - time.monotonic()) > 0.0:
        hub.poll(remaining_s)


def _well(*processes: subprocess.Popen[bytes]) -> bool:
    return all(process.poll() in (None, 0) for process in processes)


def _end(process: subprocess.Popen[bytes], hub: Hub | None) -> None:
    process.terminate()
    deadline = time.monotonic() + GRACE_S
    while process.poll() is None and time.monotonic() < deadline:
        _serve(hub, POLL_S / 10.0)
    process.kill()
    process.wait()


def _how(code: int | None) -> str:
    if code is not None and code < 0:
        return f"was ended by signal {-code}"
    return f"ended with exit code {code}"
