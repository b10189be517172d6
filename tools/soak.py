"""Long runs: does memory stay flat, is every answer in time, are the limits kept? Writes docs/soak.md.

Two runs: simulated hours on the virtual bus, as fast as they go, and wall time in real time on the bench,
armed, at 10 Hz. Both logs are then audited and replayed. Exit code 1 when a budget is broken.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from argument_types import positive

from fsw.input.schema import TableError
from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilRefused
from sim.audit.check import check
from sim.bench.budgets import BudgetLine
from sim.bench.command import NUMBERS as BENCH_NUMBERS
from sim.bench.memory import MemoryMonitor
from sim.errors import HarnessError
from sim.flight.flight_loop import WATCH_TICKS
from sim.flight.record_flight import MOST_TICKS, record_flight
from sim.flight.virtual_bus import VirtualBus
from sim.progress import progress
from sim.record import run_dir
from sim.record.destination import check_file
from sim.record.pace import Pace
from sim.record.whole_file import replace_text, replacing
from sim.replay.log_replay import replay
from sim.scenario.schema import flight_table, load
from sim.value_types import Json

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "soak.md"
MEASURED = "soak.json"
BENCH_HZ = 10
STEP_BUDGET_S = 1.0 / BENCH_HZ
WARM_PART, WARM_MOST_S = 0.05, 60.0
"""Fraction of a run, and wall time at most, until memory counts as warm: by then all modules are loaded."""


@dataclass(frozen=True, slots=True)
class RunResult:
    """The result of one of the two runs: its description, its budgets, and the memory of its processes."""

    title: str
    description: str
    lines: list[BudgetLine]
    memory: Json


class TimedBus(VirtualBus):
    """The virtual bus, which measures the processor time of each step without storing it, for flat memory."""

    def __init__(self, node: FlightNode) -> None:
        super().__init__(node)
        self.longest_s = 0.0
        self.above = 0

    def send(self, frames: Sequence[Frame]) -> None:
        """Hand the frames of a tick to the flight software."""
        before_s = time.thread_time()
        super().send(frames)
        taken_s = time.thread_time() - before_s
        self.longest_s = max(self.longest_s, taken_s)
        self.above += taken_s > STEP_BUDGET_S


def fly(folder: Path, name: str, hours: float) -> None:
    """Simulated hours on the virtual bus, in this process."""
    scenario = load(name)
    tick_hz = scenario.time.tick_hz
    if 3600.0 * hours * tick_hz > MOST_TICKS:
        raise HarnessError(f"--hours {hours:g}: a run has at most {MOST_TICKS} ticks")
    ticks = max(1, round(3600.0 * hours * tick_hz))
    run_dir.begin(folder, scenario, 1, ticks, "virtual", Pace())
    bus = TimedBus(FlightNode(flight_config(flight_table(scenario))))
    memory = MemoryMonitor({"flight": os.getpid()}, ticks, tick_hz, WARM_PART * ticks / tick_hz, WATCH_TICKS)
    with progress(f"flying {name}", ticks) as watch:

        def on_tick(tick: int) -> None:
            memory.sample(tick)
            watch(tick)

        record_flight(folder, scenario, bus, on_tick)
    steps = {"longest_s": bus.longest_s, "above": bus.above}
    measured = {"steps": steps, "memory": memory.history(), "growth_percent": memory.growth_percent()}
    run_dir.write_json(folder / MEASURED, measured)


def bench(folder: Path, name: str, wall_s: float, priority: int | None, words: Sequence[str]) -> None:
    """Wall time on the bench, every node a process; the result is in hil.json, whatever the exit code."""
    warm_s = min(WARM_MOST_S, WARM_PART * wall_s)
    command = [sys.executable, "-m", "torquer.cli.main", "hil", name, "--tick-hz", str(BENCH_HZ), "--arm"]
    command += ["--seconds", str(wall_s), "--warm-s", str(warm_s), "--out", str(folder), "--json", *words]
    try:
        subprocess.run(
            command, stdout=subprocess.DEVNULL, check=False, preexec_fn=lambda: _set_real_time(priority)
        )
    except subprocess.SubprocessError:
        raise HarnessError(f"--priority {priority}: not allowed here") from None


def _set_real_time(priority: int | None) -> None:
    if priority is not None:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))


def flight_part(folder: Path, memory_percent: float) -> RunResult:
    """Judge a flight."""
    run, measured = run_dir.read_run(folder), _json(folder / MEASURED)
    flight, growth = run["flown"], measured["growth_percent"]
    hours = flight["ticks"] / run_dir.read_scenario(folder).time.tick_hz / 3600.0
    description = (
        f"`{run['scenario']}` on the virtual bus, {hours:.4g} simulated hours in {flight['wall_s']:.0f} s: "
        f"{3600.0 * hours / flight['wall_s']:.0f} times real time. Longest step of the flight software: "
        f"{1000.0 * measured['steps']['longest_s']:.1f} ms of processor time. "
        + _memory_text(measured["memory"])
    )
    lines = [
        BudgetLine("ticks without an answer", flight["slips"], 0),
        BudgetLine(f"steps above {1000.0 * STEP_BUDGET_S:g} ms", measured["steps"]["above"], 0),
        *(BudgetLine("memory, growth [%]", percent, memory_percent) for percent in growth.values()),
    ]
    return RunResult(
        f"{hours:.4g} simulated hours", description, lines + _of_the_log(folder), measured["memory"]
    )


def bench_part(folder: Path) -> RunResult:
    """Judge a bench."""
    numbers = _json(folder / BENCH_NUMBERS)
    seconds = numbers["ticks"] / numbers["tick_hz"]
    load = numbers["memory"]["load_average"]
    jitter, latency, bus = numbers["jitter_ms"], numbers["latency_ms"], numbers["bus_load_percent"]
    description = (
        f"`{numbers['scenario']}` on the bench, armed, {seconds:.0f} s at {numbers['tick_hz']} Hz on "
        f"`{numbers['bus'].partition(':')[0]}`; scheduling: {numbers['scheduling']}; load average of the "
        f"machine {sum(load) / len(load):.1f} in the mean, {max(load):.1f} at most. "
        f"{_memory_text(numbers['memory'])}\n\n"
        "| [ms] | p50 | p99 | max |\n|---|---|---|---|\n"
        + _row("jitter of SYNC", *(f"{jitter[part]:.3f}" for part in ("p50", "p99", "max")))
        + "\n"
        + _row("SYNC to TICK_DONE", *(f"{latency[part]:.3f}" for part in ("p50", "p99", "max")))
        + f"\n\nBus load at 125 kbit/s: mean {bus['mean']:.1f} %, busiest tick {bus['busiest_tick']:.1f} %."
    )
    lines = [BudgetLine(line["name"], line["measured"], line["allowed"]) for line in numbers["budgets"]]
    lines.append(BudgetLine("nodes that ended before their time", len(numbers["ended"]), 0))
    lines.append(BudgetLine("second senders on the bus", len(numbers["second_senders"]), 0))
    unread = not any(line.name.startswith("memory of ") for line in lines)
    lines.append(BudgetLine("memory that could not be read", int(unread), 0))
    return RunResult(
        f"{seconds:.0f} s of wall time", description, lines + _of_the_log(folder), numbers["memory"]
    )


def _of_the_log(folder: Path) -> list[BudgetLine]:
    """The budgets of a log: its audit and its replay."""
    log, scenario = folder / run_dir.BUS_LOG, run_dir.read_scenario(folder)
    report = check(folder, None)
    with progress("replaying", run_dir.read_run(folder)["ticks"]) as watch:
        result = replay(log, flight_config(flight_table(scenario)), lambda state: watch(state.tick))
    mark = f" {CoilRefused.ID:03X}#".encode()
    with log.open("rb") as lines:
        refused = sum(mark in line for line in lines)
    return [
        BudgetLine(f"violations of the limits in {len(report.pulses)} pulses", len(report.violations), 0),
        BudgetLine("requests that the coil board refused", refused, 0),
        BudgetLine(
            "log cut or altered", int(not (report.complete and report.genuine and not report.mismatches)), 0
        ),
        BudgetLine(
            f"replay of {result.ticks} ticks not bit-exact", int(not (result.bit_exact and result.ended)), 0
        ),
    ]


def _memory_text(memory: Json) -> str:
    kib, warm = memory["kib"], memory["warm"]
    parts = [
        f"{name} {samples[warm] / 1024.0:.1f}, {max(samples) / 1024.0:.1f}"
        for name, samples in kib.items()
        if len(samples) > warm
    ]
    return f"Memory once warm and at most [MiB]: {'; '.join(parts)}." if parts else ""


def page(parts: Sequence[RunResult], picture: str) -> str:
    """docs/soak.md."""
    text = [
        "# Long runs",
        "",
        "Written by `make soak`; do not edit. A flight of simulated hours as fast as it goes, and the bench",
        "in real time, armed, each node a process. Growth of memory: the most that a process ever has",
        f"resident once warm (after a twentieth of the run, on the bench at most {WARM_MOST_S:g} s), against",
        "what it has then.",
        "",
        f"Python {platform.python_version()}, {platform.machine()}, {platform.system()}.",
        "",
        f"![resident memory of each process through both runs]({picture})",
    ]
    for part in parts:
        text += [
            "",
            f"## {part.title}",
            "",
            part.description,
            "",
            "| budget of | measured | allowed | |",
            "|---|---|---|---|",
        ]
        text += [
            _row(line.name, f"{line.measured:.4g}", f"{line.allowed:g}", "kept" if line.kept else "BROKEN")
            for line in part.lines
        ]
    return "\n".join(text) + "\n"


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


def draw(parts: Sequence[RunResult], path: Path) -> None:
    """Memory of each process relative to when it was warm."""
    from matplotlib.figure import Figure  # noqa: PLC0415  (not loaded while memory is measured)

    from sim.drawing.canvas import style  # noqa: PLC0415  (likewise)

    with style():
        figure = Figure(figsize=(8.2, 2.4), layout="constrained")
        panels = figure.subplots(1, len(parts), squeeze=False)
        for panel, part in zip(panels[0], parts, strict=True):
            warm, every_h = part.memory["warm"], part.memory["every_s"] / 3600.0
            for name, kib in part.memory["kib"].items():
                if len(kib) > warm:
                    hours = [n * every_h for n in range(warm, len(kib))]
                    panel.plot(hours, [100.0 * (now / kib[warm] - 1.0) for now in kib[warm:]], label=name)
            panel.set(title=part.title, xlabel="time [h]", ylabel="memory, growth [%]", ylim=(-2.5, 2.5))
            panel.legend(ncols=3)
        with replacing(path) as file:
            figure.savefig(file, format="svg", facecolor="white", metadata={"Date": None})


def _json(path: Path) -> Json:
    try:
        content: Json = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise HarnessError(f"{path}: cannot be read as a result ({error})") from None
    return content


def _arguments(words: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scenario", default="microsat")
    parser.add_argument("--hours", type=positive, default=72.0, help="simulated, default 72")
    parser.add_argument("--wall-s", type=positive, default=3600.0, help="of the bench, default 3600")
    parser.add_argument("--memory-percent", type=positive, default=2.0, help="budget of growth, default 2")
    parser.add_argument(
        "--priority", type=int, help="real-time priority of the bench, 1 to 99 (Linux, privileged)"
    )
    parser.add_argument(
        "--flight", type=Path, metavar="DIR", help="judge this flight of an earlier soak instead"
    )
    parser.add_argument(
        "--hil", type=Path, metavar="DIR", help="judge this bench instead, a folder of torquer hil"
    )
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep both runs here")
    parser.add_argument("--out", type=Path, default=PAGE, help="the page; its picture lies beside it")
    return parser.parse_args(words)


def main(words: Sequence[str] | None = None) -> int:
    """Run both, judge both, write the page; 1 if a budget is broken."""
    arguments = _arguments(words)
    with tempfile.TemporaryDirectory() as scratch:
        runs = arguments.keep or Path(scratch)
        flight, hil = arguments.flight or runs / "flight", arguments.hil or runs / "hil"
        try:
            check_file(arguments.out)
            check_file(arguments.out.with_suffix(".svg"))
            if arguments.hil is None and (hil / BENCH_NUMBERS).exists():
                raise HarnessError(f"--keep {runs}: {hil} holds a bench already: --hil {hil} judges it again")
            if arguments.flight is None:
                fly(flight, arguments.scenario, arguments.hours)
            if arguments.hil is None:
                limits = ("--memory-percent", str(arguments.memory_percent))
                bench(hil, arguments.scenario, arguments.wall_s, arguments.priority, limits)
            parts = [flight_part(flight, arguments.memory_percent), bench_part(hil)]
        except (HarnessError, TableError) as error:
            print(f"soak: {error}", file=sys.stderr)
            return 2
    picture = arguments.out.with_suffix(".svg")
    draw(parts, picture)
    text = page(parts, picture.name)
    replace_text(arguments.out, text)
    print(text)
    return int(not all(line.kept for part in parts for line in part.lines))


if __name__ == "__main__":
    sys.exit(main())
