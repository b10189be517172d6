"""``torquer hil``: the flight software in real time against boards, each its own process or real hardware."""

import json
import os
import time
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import click

from fsw.bus.interface import Bus
from fsw.bus.open_bus import open_bus
from fsw.wire.frame import Frame
from fsw.wire.messages import PlantBoot
from sim.bench.conductor import Conductor, is_boot
from sim.bench.memory import Memory, scheduling
from sim.bench.nodes import Node, Nodes, hub_of
from sim.bench.verdict import Budgets, Json, judge, render
from sim.bench.world import PlantWorld, SyncAlone, World, line_to
from sim.errors import HarnessError
from sim.flight.bus_taken import FLYING, refuse_taken
from sim.flight.second_senders import said
from sim.flight.table_file import write_flight_table
from sim.progress import progress
from sim.record import run_dir
from sim.record.binding import bind
from sim.record.bus_log import BusLog
from sim.record.destination import check_folder
from sim.record.pace import Pace
from sim.scenario.assemble import plant_config
from sim.scenario.schema import Scenario

BOARDS = {"coil": "COIL", "magnetometer": "MAG", "sun": "SUN"}
SENSORS = ("magnetometer", "sun")
NUMBERS = "hil.json"
BOOT_S = 30.0
ASK_AGAIN_S = 0.5


@dataclass(frozen=True, slots=True)
class Bench:
    """What is asked for.

    Args:
        scenario: the scenario, its tick rate included.
        bus: where all meet.
        real: boards that are hardware, and not started here.
        armed: coils may be driven.
        seconds: how long.
        stimulus: "plant", or what the sensors are shown instead: a run, a log, a script.
        deadman_s: the coil board's dead-man.
        budgets: what must be kept.
        warm_s: memory is judged from then on.
        seed: of the plant.
        out: run directory to be written; None: no log is kept.
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


def real_boards(names: str | None) -> frozenset[str]:
    """``--real coil,sun`` as a set.

    Raises:
        HarnessError: a name that is no board.
    """
    given = frozenset(name.strip() for name in names.split(",")) if names else frozenset()
    if strange := sorted(given - set(BOARDS)):
        raise HarnessError(f"--real {names}: {strange[0]!r} is no board: choose of {', '.join(BOARDS)}")
    return given


def hil(bench: Bench, as_json: bool = False) -> int:
    """Run the bench: exit code 1 when a budget is broken, a node has ended, or there is a second sender.

    Raises:
        BusError: the bus cannot be used, or somebody flies on it already.
        HarnessError: a node does not start, or the scenario does not fit the bench.
    """
    if bench.out is not None:
        check_folder(bench.out, (NUMBERS,))
    if bench.stimulus != "plant" and bench.scenario.knowledge == "perfect":
        raise HarnessError("a scenario with knowledge = 'perfect' needs the plant: --stimulus plant")
    with hub_of(bench.bus) as (spec, hub_pid), TemporaryDirectory() as scratch, Nodes() as nodes:
        bus = open_bus(spec)
        try:
            if hub_pid is None:
                refuse_taken(bus, spec, FLYING)
            folder = bench.out or Path(scratch)
            _begin(bench, folder, spec)
            table = write_flight_table(Path(scratch), bench.scenario)
            if not as_json:
                click.echo(_said(bench, spec))
            numbers = _run(bench, spec, hub_pid, bus, nodes, folder, table, as_json)
        finally:
            bus.close()
        lost = [node for node in nodes.by_name.values() if not node.alive]
        numbers["ended"] = {node.name: node.said() for node in lost}
    if bench.out is not None:
        run_dir.write_json(bench.out / NUMBERS, numbers)
        bind(bench.out, run_dir.BUS_LOG, NUMBERS)
    if as_json:
        click.echo(json.dumps(numbers, indent=2))
    failures = [f"{name} ended before its time: {last}" for name, last in numbers["ended"].items()]
    failures += [said(numbers["second_senders"])] if numbers["second_senders"] else []
    broken = [line["name"] for line in numbers["budgets"] if not line["kept"]]
    failures += [f"over budget: {', '.join(broken)}"] if broken else []
    if failures:
        click.echo(f"torquer: {'; '.join(failures)}", err=True)
    return int(bool(failures))


def _begin(bench: Bench, folder: Path, spec: str) -> None:
    """Begin a run, if one is to be kept."""
    if bench.out is not None:
        channel = spec.partition(":")[0]
        run_dir.begin(folder, bench.scenario, bench.seed, _ticks(bench), channel, Pace(1.0))


def _ticks(bench: Bench) -> int:
    return max(1, round(bench.seconds * bench.scenario.time.tick_hz))


def _run(
    bench: Bench,
    spec: str,
    hub_pid: int | None,
    bus: Bus,
    nodes: Nodes,
    folder: Path,
    table: Path,
    as_json: bool,
) -> Json:
    scenario, ticks = bench.scenario, _ticks(bench)
    tick_hz = scenario.time.tick_hz
    arming = () if bench.armed else ("--disarmed",)
    words = ("--table", str(table), "--bench", "--bus", spec, "--parent", str(os.getpid()), *arming)
    fsw = nodes.start("fsw", "fsw", *words)
    booted = _await(bus, {"FSW": fsw}, ask=True)[-1:]
    stubs = {name: _board(bench, nodes, name, spec) for name in BOARDS if name not in bench.real}
    world = _world(bench, stubs)
    booted += _await(bus, {BOARDS[name]: node for name, node in stubs.items()})
    memory = Memory(_pids(nodes, hub_pid), ticks, tick_hz, bench.warm_s)
    keeping: BusLog | NoLog = BusLog(folder / run_dir.BUS_LOG, bus.name) if bench.out else NoLog()
    with progress(f"bench with {scenario.name}", ticks) as watch, keeping as log:

        def on_tick(tick: int) -> None:
            memory.look(tick)
            watch(tick)

        measured = Conductor(bus, world, log, scenario.epoch_unix_s, tick_hz, on_tick).run(ticks, booted)
    numbers, lines = judge(measured, bench.budgets, tuple(BOARDS), tick_hz, memory.growth_percent())
    numbers |= {"scenario": scenario.name, "bus": spec, "tick_hz": tick_hz, "armed": bench.armed}
    numbers |= {"real": sorted(bench.real), "memory": memory.history(), "scheduling": scheduling()}
    numbers["second_senders"] = [sender.as_json() for sender in measured.second_senders]
    numbers["budgets"] = [{**line._asdict(), "kept": line.kept} for line in lines]
    if not as_json:
        click.echo(render(numbers, lines))
    return numbers


def _pids(nodes: Nodes, hub_pid: int | None) -> dict[str, int]:
    """Every process of the bench."""
    hub = {} if hub_pid is None else {"hub": hub_pid}
    return {"bench": os.getpid()} | hub | {node.name: node.process.pid for node in nodes.by_name.values()}


def _board(bench: Bench, nodes: Nodes, name: str, spec: str) -> Node:
    """Start the stub of a board."""
    scenario, stub = bench.scenario, ("hil_stub", "--parent", str(os.getpid()))
    common = ("--bus", spec, "--tick-hz", str(scenario.time.tick_hz))
    if name in SENSORS:
        stimulus = "-" if bench.stimulus == "plant" else bench.stimulus
        return nodes.start(name, *stub, name, *common, "--stimulus", stimulus, piped=stimulus == "-")
    coils = scenario.coils
    if coils.driver == "continuous":
        return nodes.start(name, *stub, "dipole", *common)
    levels_ma = [repr(level_ma) for level_ma in coils.levels_ma]
    limits = (
        "--pulse-s",
        str(coils.pulse_s),
        "--backoff-s",
        str(coils.backoff_s),
        "--backoff",
        coils.backoff,
    )
    guard = ("--levels-ma", *levels_ma, "--deadman-s", str(bench.deadman_s))
    return nodes.start(name, *stub, "coil", *common, *limits, *guard)


def _world(bench: Bench, stubs: dict[str, Node]) -> World:
    scenario = bench.scenario
    if bench.stimulus != "plant":
        return SyncAlone(scenario.epoch_unix_s, scenario.time.tick_hz)
    pipes = {name: stubs[name].process.stdin for name in SENSORS if name in stubs}
    lines = {name: line_to(pipe.fileno()) for name, pipe in pipes.items() if pipe is not None}
    return PlantWorld(plant_config(scenario, bench.seed), lines.get("magnetometer"), lines.get("sun"))


def _await(bus: Bus, waited: dict[str, Node], ask: bool = False) -> list[Frame]:
    """Until each of the nodes has said that it has booted: what was heard; ``ask``: with PLANT_BOOT."""
    heard: list[Frame] = []
    missing = set(waited)
    deadline_s = time.monotonic() + BOOT_S
    asked_s = 0.0
    while missing:
        now_s = time.monotonic()
        for name in missing:
            if not waited[name].alive or now_s > deadline_s:
                raise HarnessError(f"the {name} node does not start: {waited[name].said()}")
        if ask and now_s - asked_s > ASK_AGAIN_S:
            bus.send([PlantBoot(0, 1, 0).encode()])
            asked_s = now_s
        frame = bus.receive(0.1)
        if frame is not None:
            heard.append(frame)
            missing -= {name for name in missing if is_boot(frame, name)}
    return heard


class NoLog(AbstractContextManager["NoLog"]):
    """Keeps nothing."""

    def write(self, timestamp_us: int, frames: list[Frame]) -> None:
        """Nothing."""

    def __exit__(self, *error: object) -> None:
        """Nothing to close."""


def _said(bench: Bench, spec: str) -> str:
    boards = ", ".join(f"{name} ({'real' if name in bench.real else 'stub'})" for name in BOARDS)
    arming = "ARMED: coils are driven" if bench.armed else "not armed: no request reaches the bus"
    return (
        f"{bench.scenario.name} at {bench.scenario.time.tick_hz} Hz for {bench.seconds:g} s on {spec}\n"
        f"boards: {boards}; stimuli: {bench.stimulus}; {arming}"
    )
