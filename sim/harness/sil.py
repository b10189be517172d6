"""Software in the loop: plant and flight software as two processes on a bus."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from fsw.bus.hub import Hub
from fsw.bus.interface import Bus
from fsw.bus.link import LoopLink
from fsw.bus.open_bus import open_bus, resolve
from fsw.wire.frame import Frame
from sim.harness import run_dir
from sim.harness.answers import ANSWER_TIMEOUT_S, Patience
from sim.harness.assemble import plant_config
from sim.harness.bus_log import BusLog
from sim.harness.bus_taken import refuse_taken
from sim.harness.errors import FlightError, HarnessError
from sim.harness.faults.section import make_plant
from sim.harness.flight import fly
from sim.harness.pace import Pace
from sim.harness.scenario import Scenario, flight_table, orbit_period_s
from sim.harness.second_senders import SenderWatch, said
from sim.harness.standstill import Standstill
from sim.harness.telecommands import uplink
from sim.harness.truth import TruthFile

POLL_S = 0.1
GRACE_S = 5.0
MOST_TICKS = 2**24 - 1
"""What PLANT_END can tell."""
PATIENCE = Patience(boot_s=60.0, answer_s=ANSWER_TIMEOUT_S, silence_s=ANSWER_TIMEOUT_S)
MARGIN_S = 5.0
"""The plant tells of a silent flight software by itself; only if it does not in time, it stands still."""

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
    from fsw.table.config import flight_config  # noqa: PLC0415  (the plant's process has no flight software)

    flight_config(flight_table(scenario))
    check_plant(scenario, seed)


def check_plant(scenario: Scenario, seed: int) -> None:
    """The same of the plant alone."""
    make_plant(plant_config(scenario, seed), scenario.fault)


def record(
    path: Path,
    scenario: Scenario,
    bus: Bus,
    watch: Watch = lambda tick: None,
    patience: Patience | None = None,
    waiting: Callable[[float], None] = lambda waited_s: None,
) -> None:
    """Fly the run that ``path`` was begun for, and keep there its log, its histories, and who else spoke.

    Args:
        path: of the run.
        scenario: its own.
        bus: to fly on; it is closed.
        watch: told the tick, now and then.
        patience: how long the flight software is waited for; None: until it boots for ever.
        waiting: told every second how long that has lasted.

    Raises:
        FlightError: the flight software gives no answer.
        BusError: the bus failed.
    """
    run = run_dir.read_run(path)
    plant = make_plant(plant_config(scenario, run["seed"]), scenario.fault)
    pace = Pace(run["pace_factor"])
    senders = SenderWatch(lockstep=pace.factor is None)

    def keep_senders() -> None:
        run_dir.update(path, second_senders=[sender.as_json() for sender in senders.found])

    def overhear(tick: int, before: list[Frame], answers: list[Frame], again: bool) -> None:
        if senders.take(tick, before, answers, again):
            keep_senders()

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
                patience,
                overhear,
                waiting,
            )
    finally:
        bus.close()
        if senders.found:  # how many frames, in the end
            keep_senders()
    run_dir.update(
        path,
        flown={"ticks": flown.ticks, "slips": flown.slips, "wall_s": flown.wall_s},
        **{run_dir.DIGESTS: {run_dir.BUS_LOG: log.sha256}},
    )


@contextmanager
def served(bus: str) -> Iterator[tuple[str, Hub | None]]:
    """A bus for two processes: its spec in full, and the hub if it is a loop bus that is hosted here.

    Raises:
        BusError: the bus cannot be used, or somebody flies on it already.
    """
    spec = resolve(bus)
    if not spec.startswith("loop:"):
        _refuse_taken(open_bus(spec), spec)
        yield spec, None
        return
    port = int(spec.removeprefix("loop:"))
    try:
        hub = Hub(0 if bus in ("loop", "auto") else port)
    except OSError:  # somebody else hosts it, or keeps the port for something else
        _refuse_taken(LoopLink(port, timeout_s=1.0, may_host=False), spec)
        yield spec, None
        return
    try:
        yield f"loop:{hub.port}", hub
    finally:
        hub.close()


def _refuse_taken(bus: Bus, spec: str) -> None:
    try:
        refuse_taken(bus, spec)
    finally:
        bus.close()


def fly_processes(
    path: Path, scenario: Scenario, spec: str, hub: Hub | None, watch: Watch, patience: Patience = PATIENCE
) -> None:
    """Fly with plant and flight software as two processes on a bus, as ``served`` gives it.

    Raises:
        FlightError: one of the two ended before its time, or stands still; both have been ended.
    """
    scenario_file = str(path / run_dir.SCENARIO)
    common = ("--bus", spec, "--parent", str(os.getpid()))
    waits = (str(patience.boot_s), str(patience.answer_s))
    plant = start_node("sim.plant", scenario_file, *common, "--into", str(path), "--patience", *waits)
    fsw = start_node("fsw", scenario_file, *common)
    standstill = _standstill(path, scenario, patience)
    stood_s = 0.0
    try:
        while plant.poll() is None and fsw.poll() is None and not (stood_s := standstill.lasts_s()):
            _serve(hub, POLL_S)
            watch(last_tick(path, scenario))
        deadline = time.monotonic() + (0.0 if stood_s else GRACE_S)
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
        _end((plant, fsw), hub)
    run = run_dir.read_run(path)
    if not failed and "flown" in run:
        return
    tick = last_tick(path, scenario)
    name, process = failed[0] if failed else ("flight software", fsw)
    why = run.get("ended") or f"the {name} {_how(process.returncode)} at tick {tick}"
    if stood_s:
        why = f"the plant stands still: nothing has been flown for {stood_s:.0f} s after tick {tick}"
    if run.get("second_senders"):
        why += f"; {said(run['second_senders'])}"
    raise FlightError(f"{why}: the run is not complete, what was flown is in {path}")


def _standstill(path: Path, scenario: Scenario, patience: Patience) -> Standstill:
    factor = run_dir.read_run(path)["pace_factor"]
    two_ticks_s = 2.0 / (scenario.time.tick_hz * factor) if factor else 0.0
    longest_s = patience.answer_s + MARGIN_S + two_ticks_s
    return Standstill(path / run_dir.BUS_LOG, patience.boot_s + MARGIN_S, longest_s)


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


def _end(processes: Sequence[subprocess.Popen[bytes]], hub: Hub | None) -> None:
    """End what still runs, with time to close its files; what stands still is killed."""
    for process in processes:
        process.terminate()
    deadline = time.monotonic() + GRACE_S
    while any(process.poll() is None for process in processes) and time.monotonic() < deadline:
        _serve(hub, POLL_S / 10.0)
    for process in processes:
        process.kill()
        process.wait()


def _how(code: int | None) -> str:
    if code is not None and code < 0:
        return f"was ended by signal {-code}"
    return f"ended with exit code {code}"
