"""Measure how fast flights are, each beside a peer in the same minute, and write docs/performance.md.

The peer is Basilisk (benchmarks/basilisk_flight.py), which is installed into an environment of its own under
build/. Everything is run in turn, round by round, and compared within its round, so that a machine whose
speed drifts does not matter; the page gives medians. Needs a machine that does nothing else.
"""

import argparse
import json
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from typing import Any, NamedTuple

from argument_types import count, positive

from sim.record.whole_file import replace_text

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "performance.md"
BENCHMARKS = ROOT / "benchmarks"
IGRF = ROOT / "sim" / "plant" / "environment" / "igrf14.shc"
PEER = ROOT / "build" / "basilisk"
PEER_PACKAGE = "bsk>=2.12"
ORBIT_S = 6041.3
CAMPAIGN_RUNS = 8
COUNTED = (
    "CPyDef_step___step",
    "CPyDef_plant___Plant___begin_tick",
    "CPyDef_plant___Plant___receive",
    "CPyDef_plant___Plant___end_tick",
)
"""Functions within which instructions are counted."""
COUNTED_ORBITS = 0.15
COUNT = re.compile(r"^ *([\d,]+) \([^)]*\).*CPyDef_(step___|plant___Plant___)(\w+) ", re.MULTILINE)
TRIED = """## What holds more back

Where a tick's instructions go is above. Beside step and plant, the lines of the log and their digests, the
loop and the bus take a seventh. Of the step, the checksum of the state is the largest part that is not the
filter's: half of it is zlib's CRC-32, which takes 3.6 instructions a byte. Most of what is left is the making
of arrays, tuples and messages, not arithmetic: a product of two 3x3 matrices by numpy costs 7000
instructions, an array that the kernel returns 1300, the lookup of a constant that is not final 100.

What holds most back is the way of the code to the processor. It is run through once a tick, and not much of
it twice: in callgrind's caches of 32 KB and 512 KB a tick of `microsat`, step and plant, has 206 000
instructions, and fetches 6800 lines of 64 bytes of code anew from beyond the first cache and 3200 of them
from beyond the second. By the usual latencies (14 and some 50 cycles) that is three fifths of its time. So
less code a tick would help, and neither its order nor its alignment.

Tried, and not worth what it costs: `-O1` in place of `-O2` builds in five sixths of the time, and the plant
then takes 2 to 4 % more instructions; hidden symbols save 0.7 % and are kept; link-time optimisation flies
0.95 times as long, within the scatter of four pairs, and builds 1.4 times as long. Two fifths of the time
are the runtime of Python itself (`perf record`): making and freeing floats, tuples and objects, none of them
more than 3 %. No function of ours takes more than 6 % with what it calls there. Profile-guided
optimisation, trained on four scenarios, flies 0.99 times as fast (median of six pairs), functions of errors
marked as cold 1.07 and 1.10 times (six and eight pairs, which scatter as much; 2 % fewer lines of code are
fetched), no collection of garbage 0.98 times (six pairs), `-Os` 0.72 times (six pairs: calls stand where code
was), AVX2 as the target takes 1 % fewer instructions, code in huge pages is no faster (five pairs); calls
without a procedure linkage table, without guards of the stack and marks of branch targets fly 0.94 times as
fast (ten pairs, within the scatter): none of them is used. Not tried: filter, boards and plant in one call
of C.

The Python that runs it counts: one that was built without `--enable-optimizations`, as pyenv builds it by
default (3.11.7), takes 1.12 times as long as Debian's (3.11.2; median of eight pairs).

Over `loop`, tried: log and truth of a tick are written while the flight software computes the next one. The
flight takes 1.35 times as long (median of four pairs): as the plant goes on after it has sent, the flight
software wakes on the other processor, which costs more than is saved. With both processes on one processor
that flies 1.07 times as fast (four pairs), within the scatter, and is in the way of whatever else runs there.

In campaigns, tried: a worker flies four runs at once, the plant's part of a tick for one after the other and
then the flight software's, so that each part is fetched once for all four. Step and plant alone are 1.25
times as fast on `microsat` and 1.47 times on `realsat` (eight: 1.33 and 1.51), but with what a run records
and judges beside them a campaign is 1.15 times as fast, and 1.18 times with twelve dispersed inputs (six and
six pairs on two workers). It is not used: rows would come in fours, and a lost worker would lose four.
"""


class Measured(NamedTuple):
    """What a command has shown: its speed, its whole time, and the most memory of one of its processes."""

    realtime_factor: float
    wall_s: float
    peak_mb: float


def run(command: list[str], read: Callable[[str, float], float]) -> Measured:
    """Run a command in an empty folder; ``read`` takes its output and time and gives its speed."""
    with TemporaryDirectory() as folder, TemporaryFile("w+") as output:
        begin_s = time.perf_counter()
        process = subprocess.Popen(command, cwd=folder, env=environment(), stdout=output)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        wall_s = time.perf_counter() - begin_s
        if process.returncode:
            sys.exit(f"{' '.join(command)} ended with exit code {process.returncode}")
        output.seek(0)
        return Measured(read(output.read(), wall_s), wall_s, usage.ru_maxrss / 1e3)


def environment() -> dict[str, str]:
    """Of the processes: this project, one thread for linear algebra."""
    return {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONSAFEPATH": "1", "OPENBLAS_NUM_THREADS": "1"}


def one_process(scenario: str, orbits: float) -> Measured:
    """One flight in one process, without replay and report."""
    command = [sys.executable, str(BENCHMARKS / "fly_once.py"), scenario, str(orbits)]
    return run(command, lambda output, wall_s: float(json.loads(output)["realtime_factor"]))


def parts_of(scenario: str) -> dict[str, float]:
    """Thousands of instructions of a compiled tick in each function of the step and of the plant."""
    if shutil.which("valgrind") is None:
        sys.exit("what the parts of a tick cost is counted by callgrind: install valgrind")
    with TemporaryDirectory() as folder:
        counts = Path(folder, "counts")
        words = [f"--callgrind-out-file={counts}", *(f"--toggle-collect={name}" for name in COUNTED)]
        flight = [sys.executable, str(BENCHMARKS / "fly_once.py"), scenario, str(COUNTED_ORBITS)]
        flown = subprocess.run(
            ["valgrind", "--tool=callgrind", *words, *flight],
            env=environment(), capture_output=True, text=True, check=True,
        )  # fmt: skip
        annotate = ["callgrind_annotate", "--inclusive=yes", "--threshold=100", str(counts)]
        listed = subprocess.run(annotate, capture_output=True, text=True, check=True).stdout
    return instructions(listed, json.loads(flown.stdout)["ticks"])


def instructions(listed: str, ticks: int) -> dict[str, float]:
    """What ``callgrind_annotate`` lists of these functions, in thousands a tick, dearest first."""
    thousands = {}
    for number, owner, name in COUNT.findall(listed):
        place = owner.removesuffix("___").replace("___", ".")
        thousands[f"{place}.{name.strip('_')}"] = int(number.replace(",", "")) / ticks / 1e3
    return thousands


def plans_of(scenario: str, orbits: float) -> dict[str, Any]:
    """What the plans of ``pulse_mpc`` cost."""
    return figures_of("plan_once.py", scenario, str(orbits))


def figures_of(*words: str) -> dict[str, Any]:
    """What a script of ``benchmarks`` prints."""
    command = [sys.executable, str(BENCHMARKS / words[0]), *words[1:]]
    done = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(done.stderr.strip())
    figures: dict[str, Any] = json.loads(done.stdout)
    return figures


def whole_run(bus: str, *options: str) -> tuple[Measured, float]:
    """``torquer sil microsat`` from start to report: the speed of its flight, and the seconds it flew."""
    flown_s: list[float] = []

    def read(output: str, wall_s: float) -> float:
        summary = json.loads(Path(folder, "run", "summary.json").read_text())
        flown_s.append(summary["wall_seconds"] * summary["realtime_factor"])
        return float(summary["realtime_factor"])

    with TemporaryDirectory() as folder:
        words = ["sil", "microsat", "--bus", bus, "--out", str(Path(folder, "run")), *options]
        measured = run([sys.executable, "-m", "torquer", *words], read)
    return measured, flown_s[0]


def whole_over_flight(alone: float) -> float:
    """What the run as it ships takes over its flight alone, so many times faster than real time."""
    measured, flown_s = whole_run("virtual")
    return measured.wall_s / (flown_s / alone)


def campaign(orbits: float) -> Measured:
    """A campaign on two workers, with its start and end."""
    words = [
        "microsat",
        "--runs",
        str(CAMPAIGN_RUNS),
        "--orbits",
        str(orbits),
        "--workers",
        "2",
        "--out",
        "out",
    ]
    flown_s = CAMPAIGN_RUNS * orbits * ORBIT_S
    command = [sys.executable, "-m", "torquer", "campaign", *words]
    return run(command, lambda output, wall_s: flown_s / wall_s)


def peer(*options: str) -> Measured:
    """The closed loop in Basilisk."""
    command = [str(PEER / "bin" / "python"), str(BENCHMARKS / "basilisk_flight.py"), str(IGRF), *options]
    return run(command, lambda output, wall_s: float(output))


def install_peer() -> str:
    """Install Basilisk into its own environment, if it is not there; its version."""
    python = PEER / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(PEER)], check=True)
    subprocess.run([str(python), "-m", "pip", "install", "--quiet", PEER_PACKAGE], check=True)
    show = [str(python), "-c", "from importlib.metadata import version; print(version('bsk'))"]
    return subprocess.run(show, capture_output=True, text=True, check=True).stdout.strip()


class Row(NamedTuple):
    """A row of the page: what was run, and what it showed in each round."""

    name: str
    factors: list[float]
    peak_mb: float


def measure(rounds: int, orbits: float) -> tuple[list[Row], list[float]]:
    """All figures, round by round; the first row is the peer. Also whole run over flight."""
    runs: dict[str, Callable[[], Measured]] = {
        "Basilisk, control in C": lambda: peer(str(20.0 * orbits)),
        "Basilisk, control in Python": lambda: peer(str(10.0 * orbits), "--python"),
        "microsat, one process": lambda: one_process("microsat", orbits),
        "realsat, one process": lambda: one_process("realsat", orbits),
        "microsat, two processes over loop": lambda: whole_run("loop", "--orbits", str(orbits))[0],
        "campaign of microsat, two workers": lambda: campaign(orbits),
    }
    found: dict[str, list[Measured]] = {name: [] for name in runs}
    overheads = []
    for number in range(1, rounds + 1):
        for name, take in runs.items():
            found[name].append(take())
            print(
                f"round {number} of {rounds}: {name} {found[name][-1].realtime_factor:.0f}", file=sys.stderr
            )
        overheads.append(whole_over_flight(found["microsat, one process"][-1].realtime_factor))
    rows = [
        Row(name, [one.realtime_factor for one in each], max(one.peak_mb for one in each))
        for name, each in found.items()
    ]
    return rows, overheads


def page(
    rows: list[Row],
    overheads: list[float],
    parts: dict[str, dict[str, float]],
    plans: dict[str, dict[str, Any]],
    peer_version: str,
) -> str:
    """The page."""
    reference = rows[0].factors
    lines = [
        "# Performance",
        "",
        "Written by `make bench`, not by hand. How many times faster than real time, each in turn with a",
        f"closed loop in Basilisk {peer_version} with its modules in C, which has no filter, no bus and no",
        f"quantised pulses (`benchmarks/basilisk_flight.py`); medians of {len(reference)} rounds, ratios",
        "within a round; memory is the most of one process.",
        "",
        f"{platform.platform()}, {os.cpu_count()} processors, Python {platform.python_version()}, numpy",
        f"{version('numpy')}, torquer {version('torquer')}.",
        "",
        "| what | times real time | of Basilisk in C | memory |",
        "|---|---|---|---|",
    ]
    for row in rows:
        ratio = statistics.median(mine / its for mine, its in zip(row.factors, reference, strict=True))
        factor = statistics.median(row.factors)
        lines.append(f"| {row.name} | {factor:.0f} | {ratio:.3f} | {row.peak_mb:.0f} MB |")
    tick_us = {row.name: [1e6 / factor for factor in row.factors] for row in rows}
    pairs = zip(tick_us["realsat, one process"], tick_us["microsat, one process"], strict=True)
    dearer_us = sorted(one - other for one, other in pairs)
    whole = statistics.median(overheads)
    lines += [
        "",
        f"`torquer sil microsat --bus virtual` takes, from start to report, {whole:.2f} of the time of its",
        "flight of ten orbits alone.",
        "A tick of `realsat`, which estimates all its parameters, takes "
        f"{statistics.median(dearer_us):.0f} µs longer",
        f"({dearer_us[0]:.0f} to {dearer_us[-1]:.0f} in the rounds) than one of `microsat`, which estimates",
        "attitude, rate, magnetometer bias and torque.",
    ]
    for scenario, figures in plans.items():
        mean_ms, rare_ms = figures["mean_ms"], figures["percentile_99_ms"]
        lines += [
            "",
            f"A plan of `pulse_mpc` takes {mean_ms:.2f} ms in the mean on `{scenario}`, one in a hundred",
            f"more than {rare_ms:.2f} ms ({figures['plans']} plans, those that find no pulse among them).",
        ]
    for scenario, thousands in parts.items():
        lines += [
            "",
            f"## A tick of {scenario}",
            "",
            "Instructions in the functions of the step and of the plant, with what they call (callgrind).",
            "",
            "| function | thousands |",
            "|---|---|",
        ]
        lines += [f"| `{part}` | {count:.0f} |" for part, count in thousands.items() if count >= 1.0]
    return "\n".join([*lines, "", TRIED])


def main() -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=count, default=5)
    parser.add_argument("--orbits", type=positive, default=3.0, help="of each flight")
    parser.add_argument("--out", type=Path, default=PAGE)
    options = parser.parse_args()
    peer_version = install_peer()
    scenarios = ("microsat", "realsat")
    plans = {scenario: plans_of(scenario, options.orbits) for scenario in scenarios}
    parts = {scenario: parts_of(scenario) for scenario in scenarios}
    rows, overheads = measure(options.rounds, options.orbits)
    replace_text(options.out, page(rows, overheads, parts, plans, peer_version))
    print(options.out)


if __name__ == "__main__":
    main()
