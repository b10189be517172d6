"""One flight in one process, as ``torquer sil --bus virtual`` flies it, without replay and report.

Prints as JSON how many times faster than real time it was, the length of its log, and, with --parts, the
share of each part of the code in the time of a tick, from samples of the stack a thousand times a second.

    python fly_once.py SCENARIO ORBITS [--parts]
"""

import json
import signal
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType

from sim.flight.record_flight import ticks_of
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.pace import LOCKSTEP
from sim.scenario.schema import load

ROOT = str(Path(__file__).resolve().parent.parent) + "/"
SAMPLE_S = 1e-3
DEPTH = 3
"""Folders deep, as ``fsw/core/estimation``."""


def part_of(frame: FrameType | None) -> str:
    """The folder of the innermost function of this project on the stack."""
    while frame is not None:
        name = frame.f_code.co_filename
        if name.startswith(ROOT):
            folders = name.removeprefix(ROOT).split("/")[:-1]
            return "/".join(folders[:DEPTH])
        frame = frame.f_back
    return "other"


def main(scenario_name: str, orbits: float, parts: bool) -> None:
    """Fly, and print the figures."""
    samples: Counter[str] = Counter()
    scenario = load(scenario_name)
    ticks = ticks_of(scenario, orbits)
    if parts:
        signal.signal(signal.SIGPROF, lambda signum, frame: samples.update([part_of(frame)]))
        signal.setitimer(signal.ITIMER_PROF, SAMPLE_S, SAMPLE_S)
    with TemporaryDirectory() as folder:
        path = Path(folder, "run")
        run_dir.begin(path, scenario, 1, ticks, "virtual", LOCKSTEP)
        fly_virtual(path, scenario, lambda tick: None)
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        wall_s = run_dir.read_run(path)["flown"]["wall_s"]
        log_bytes = (path / run_dir.BUS_LOG).stat().st_size
    figures = {
        "realtime_factor": ticks / scenario.time.tick_hz / wall_s,
        "tick_us": 1e6 * wall_s / ticks,
        "log_bytes_a_tick": log_bytes / ticks,
        "parts": {part: count / samples.total() for part, count in samples.most_common()},
    }
    print(json.dumps(figures))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), "--parts" in sys.argv)
