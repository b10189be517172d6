"""``torquer hil``: the flight software in real time against boards, each its own process or real hardware."""

import os
import time
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from fsw.bus.interface import Bus
from fsw.bus.open_bus import open_bus
from fsw.input.near import did_you_mean
from fsw.wire.frame import Frame
from fsw.wire.messages import PlantBoot
from sim.bench.budgets import Budgets, judge, render
from sim.bench.memory import MemoryMonitor, scheduling
from sim.bench.processes import BenchProcess, BenchProcesses, hub_of
from sim.bench.realtime_loop import RealtimeLoop, is_boot
from sim.bench.tick_source import PlantTicks, SyncOnly, TickSource, line_to
from sim.console import answer, fail, plain, say
from sim.errors import HarnessError
from sim.flight.bus_in_use import FLIGHT_NODES, refuse_bus_in_use
from sim.flight.node_command import NodeCommand
from sim.flight.second_senders import describe_senders
from sim.progress import progress
from sim.record import run_dir
from sim.record.binding import bind
from sim.record.bus_log import BusLog
from sim.record.destination import check_folder
from sim.record.pace import Pace
from sim.record.whole_file import replace_text
from sim.scenario.assemble import effects_of, plant_config
from sim.scenario.schema import Scenario
from sim.scenario.telecommands import uplink
from sim.scenario.written import write_flight_table
from sim.value_types import Json

BOARDS = {"coil": "COIL", "magnetometer": "MAG", "sun": "SUN", "cells": "SUN"}
"""The nodes; a satellite has a Sun sensor or Sun cells."""
SENSORS = ("magnetometer", "sun", "cells")
NUMBERS, PAGE = "hil.json", "hil.html"
SOFTWARE = "flight-software.log"
"""In the run directory: what the command of a user's flight software printed."""
BOOT_S = 30.0
ASK_AGAIN_S = 0.5


@dataclass(frozen=True, slots=True)
class HilSettings:
    """The settings of a run on the settings.

    Args:
        scenario: the scenario, its tick rate included.
        bus: the bus of all nodes.
        real: boards that are hardware, and not started here.
        armed: coils may be driven.
        seconds: how long.
        stimulus: "plant", or another source of what the sensors see: a run, a log, a script.
        deadman_s: the coil board's dead-man.
        budgets: what must be met.
        warm_s: from when on memory is judged.
        seed: of the plant.
        out: run directory to be written; None: no log is written.
        software: the command of a user's flight software, which a bench does not disarm; None: this
            project's.
    """

    scenario: Scenario
    bus: str
    real: frozenset[str]
    armed: bool
    seconds: float
    stimulus: str
    deadman_s: float
    budgets: Budgets
    warm_s: float
    seed: int
    out: Path | None
    software: NodeCommand | None = None


def real_boards(names: str | None) -> frozenset[str]:
    """``--real coil,sun`` as a set.

    Raises:
        HarnessError: a name that is not a board's.
    """
    given = frozenset(name.strip() for name in names.split(",")) if names else frozenset()
    if strange := sorted(given - set(BOARDS)):
        hint = did_you_mean(strange[0], BOARDS)
        raise HarnessError(
            f"--real {names}: {strange[0]!r} is no board{hint}: choose from {', '.join(BOARDS)}"
        )
    return given


def boards_of(scenario: Scenario) -> tuple[str, ...]:
    """The names of the boards of a satellite."""
    other = "cells" if scenario.sensors.cells is None else "sun"
    return tuple(name for name in BOARDS if name != other)


def hil(settings: HilSettings) -> int:
    """Run the bench: exit code 1 if a budget is broken, a node has ended early, or there is a second sender.

    Raises:
        BusError: the bus cannot be used, or a flight is in progress on it.
        HarnessError: a node does not start, or the scenario does not fit the bench.
    """
    if settings.out is not None:
        check_folder(settings.out, (NUMBERS, PAGE))
    if absent := sorted(settings.real - set(boards_of(settings.scenario))):
        has = "Sun cells, and no Sun sensor" if absent == ["sun"] else "a Sun sensor, and no Sun cells"
        raise HarnessError(f"--real {absent[0]}: {settings.scenario.name} has {has}")
    if settings.scenario.fault:
        kind = settings.scenario.fault[0].kind
        raise HarnessError(f"fault[0], {kind}: a bench injects no faults: fly the scenario by sil")
    if settings.scenario.wheel is not None:
        raise HarnessError("[wheel]: a bench has no board of a wheel: fly the scenario by sil")
    if "coil" not in settings.real and settings.deadman_s * settings.scenario.time.tick_hz <= 1.0:
        raise HarnessError(
            f"--deadman-s {settings.deadman_s:g}: at {settings.scenario.time.tick_hz} Hz it would end every "
            f"pulse, as SYNC comes every {1.0 / settings.scenario.time.tick_hz:g} s: it has to be longer"
        )
    if settings.stimulus != "plant" and settings.scenario.knowledge == "perfect":
        raise HarnessError("a scenario with knowledge = 'perfect' needs the plant: --stimulus plant")
    with (
        hub_of(settings.bus) as (spec, hub_pid),
        TemporaryDirectory() as scratch,
        BenchProcesses() as processes,
    ):
        bus = open_bus(spec)
        try:
            if hub_pid is None:
                refuse_bus_in_use(bus, spec, FLIGHT_NODES)
            folder = settings.out or Path(scratch)
            _begin(settings, folder, spec)
            table = write_flight_table(Path(scratch), settings.scenario)
            say(_heading(settings, spec))
            numbers = _run(settings, spec, hub_pid, bus, processes, folder, table)
        finally:
            bus.close()
        lost = [process for process in processes.by_name.values() if process.is_lost]
        numbers["ended"] = {process.name: process.last_error() for process in lost}
    if settings.out is not None:
        run_dir.write_json(settings.out / NUMBERS, plain(numbers))
        _write_page(settings.out / PAGE, numbers, settings.scenario.epoch_unix_s)
        bind(settings.out, run_dir.BUS_LOG, NUMBERS)
    answer(numbers)
    failures = [f"{name} ended before its time: {last}" for name, last in numbers["ended"].items()]
    failures += [describe_senders(numbers["second_senders"])] if numbers["second_senders"] else []
    broken = [line["name"] for line in numbers["budgets"] if not line["kept"]]
    failures += [f"over budget: {', '.join(broken)}"] if broken else []
    if failures:
        fail("; ".join(failures))
    return int(bool(failures))


def _write_page(path: Path, numbers: Json, start_unix_s: float) -> None:
    from sim.bench.page import hil_page  # noqa: PLC0415  matplotlib loads when something is drawn

    replace_text(path, hil_page(numbers, start_unix_s))


def _begin(settings: HilSettings, folder: Path, spec: str) -> None:
    """Begin a run directory, if one is to be written."""
    if settings.out is not None:
        channel = spec.partition(":")[0]
        ticks = ticks_in(settings.scenario, settings.seconds)
        run_dir.begin(folder, settings.scenario, settings.seed, ticks, channel, Pace(1.0))


def ticks_in(scenario: Scenario, seconds: float) -> int:
    """How many ticks a bench runs in so many seconds; at least one."""
    return max(1, round(seconds * scenario.time.tick_hz))


def _run(
    settings: HilSettings,
    spec: str,
    hub_pid: int | None,
    bus: Bus,
    processes: BenchProcesses,
    folder: Path,
    table: Path,
) -> Json:
    scenario = settings.scenario
    ticks = ticks_in(scenario, settings.seconds)
    tick_hz = scenario.time.tick_hz
    fsw = _software(settings, spec, processes, folder, table)
    booted = _await_boots(bus, {"FSW": fsw}, ask=True)[-1:]
    stubs = {
        name: _board(settings, processes, name, spec)
        for name in boards_of(scenario)
        if name not in settings.real
    }
    source = _tick_source(settings, stubs)
    booted += _await_boots(bus, {BOARDS[name]: stub for name, stub in stubs.items()})
    memory = MemoryMonitor(_pids(processes, hub_pid), ticks, tick_hz, settings.warm_s)
    bus_log: BusLog | NoLog = BusLog(folder / run_dir.BUS_LOG, bus.name) if settings.out else NoLog()
    with progress(f"bench with {scenario.name}", ticks) as watch, bus_log as log:

        def on_tick(tick: int) -> None:
            memory.sample(tick)
            watch(tick)
            if tick == max(ticks - 2, 0):  # the last tick has begun, and PLANT_END comes next
                fsw.may_end = settings.software is not None and fsw.alive

        commands = uplink(scenario.telecommand, tick_hz)
        loop = RealtimeLoop(bus, source, log, scenario.epoch_unix_s, tick_hz, on_tick, commands)
        measured = loop.run(ticks, booted)
    numbers, lines = judge(measured, settings.budgets, boards_of(scenario), tick_hz, memory.growth_percent())
    numbers |= {"scenario": scenario.name, "bus": spec, "tick_hz": tick_hz, "armed": settings.armed}
    numbers |= {"real": sorted(settings.real), "memory": memory.history(), "scheduling": scheduling()}
    numbers["second_senders"] = [sender.as_json() for sender in measured.second_senders]
    numbers["budgets"] = [{**line._asdict(), "kept": line.kept} for line in lines]
    say(render(numbers, lines))
    return numbers


def _software(
    settings: HilSettings, spec: str, processes: BenchProcesses, folder: Path, table: Path
) -> BenchProcess:
    """Start the flight software."""
    if settings.software is not None:
        given = {"scenario": str((folder / run_dir.SCENARIO).absolute())}
        popen = settings.software.start(spec, given, folder / SOFTWARE)
        return processes.take("fsw", popen, folder / SOFTWARE)
    arming = () if settings.armed else ("--disarmed",)
    arguments = ("--table", str(table), "--bench", "--bus", spec, "--parent", str(os.getpid()), *arming)
    return processes.start("fsw", "fsw", *arguments)


def _pids(processes: BenchProcesses, hub_pid: int | None) -> dict[str, int]:
    """The process ids of all processes of the bench."""
    hub = {} if hub_pid is None else {"hub": hub_pid}
    return {"bench": os.getpid()} | hub | {name: one.popen.pid for name, one in processes.by_name.items()}


def _board(settings: HilSettings, processes: BenchProcesses, name: str, spec: str) -> BenchProcess:
    """Start the stub of a board."""
    scenario, stub = settings.scenario, ("hil_stub", "--parent", str(os.getpid()))
    common = ("--bus", spec, "--tick-hz", str(scenario.time.tick_hz))
    if name in SENSORS:
        stimulus = "-" if settings.stimulus == "plant" else settings.stimulus
        return processes.start(name, *stub, name, *common, "--stimulus", stimulus, piped=stimulus == "-")
    coils = scenario.coils
    if coils.driver == "continuous":
        return processes.start(name, *stub, "dipole", *common)
    levels_ma = [repr(level_ma) for level_ma in coils.levels_ma]
    limits = (
        "--pulse-s",
        str(coils.pulse_s),
        "--backoff-s",
        str(coils.backoff_s),
        "--backoff",
        coils.backoff,
    )
    guard = ("--levels-ma", *levels_ma, "--deadman-s", str(settings.deadman_s))
    return processes.start(name, *stub, "coil", *common, *limits, *guard)


def _tick_source(settings: HilSettings, stubs: dict[str, BenchProcess]) -> TickSource:
    scenario = settings.scenario
    if settings.stimulus != "plant":
        return SyncOnly(scenario.epoch_unix_s, scenario.time.tick_hz)
    pipes = {name: stubs[name].popen.stdin for name in SENSORS if name in stubs}
    lines = {name: line_to(pipe.fileno()) for name, pipe in pipes.items() if pipe is not None}
    config, own = plant_config(scenario, settings.seed), effects_of(scenario)
    return PlantTicks(config, lines, own)


def _await_boots(bus: Bus, starting: dict[str, BenchProcess], ask: bool = False) -> list[Frame]:
    """Wait for the boot message of each node, with ``ask`` sending PLANT_BOOT; return the frames received."""
    received: list[Frame] = []
    missing = set(starting)
    deadline_s = time.monotonic() + BOOT_S
    asked_s = 0.0
    while missing:
        now_s = time.monotonic()
        for name in missing:
            if not starting[name].alive or now_s > deadline_s:
                raise HarnessError(f"the {name} node does not start: {starting[name].last_error()}")
        if ask and now_s - asked_s > ASK_AGAIN_S:
            bus.send([PlantBoot(0, 1, 0).encode()])
            asked_s = now_s
        frame = bus.receive(0.1)
        if frame is not None:
            received.append(frame)
            missing -= {name for name in missing if is_boot(frame, name)}
    return received


class NoLog(AbstractContextManager["NoLog"]):
    """In place of a log where none is written."""

    def write(self, timestamp_us: int, frames: list[Frame]) -> None:
        """Nothing."""

    def __exit__(self, *error: object) -> None:
        """Nothing to close."""


def _heading(settings: HilSettings, spec: str) -> str:
    scenario = settings.scenario
    boards = ", ".join(
        f"{name} ({'real' if name in settings.real else 'stub'})" for name in boards_of(scenario)
    )
    arming = "ARMED: coils are driven" if settings.armed else "not armed: no request reaches the bus"
    return (
        f"{scenario.name} at {scenario.time.tick_hz} Hz for {settings.seconds:g} s on {spec}\n"
        f"boards: {boards}; stimuli: {settings.stimulus}; {arming}"
    )
