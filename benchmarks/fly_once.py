"""One flight in one process, as ``torquer sil --bus virtual`` flies it, without replay and report.

Prints as JSON how many times faster than real time it was, its ticks and the length of its log.

    python fly_once.py SCENARIO ORBITS
"""

import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from sim.flight.record_flight import ticks_of
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.pace import LOCKSTEP
from sim.scenario.schema import load


def main(scenario_name: str, orbits: float) -> None:
    """Fly, and print the figures."""
    scenario = load(scenario_name)
    ticks = ticks_of(scenario, orbits)
    with TemporaryDirectory() as folder:
        path = Path(folder, "run")
        run_dir.begin(path, scenario, 1, ticks, "virtual", LOCKSTEP)
        fly_virtual(path, scenario, lambda tick: None)
        wall_s = run_dir.read_run(path)["flown"]["wall_s"]
        log_bytes = (path / run_dir.BUS_LOG).stat().st_size
    figures = {
        "realtime_factor": ticks / scenario.time.tick_hz / wall_s,
        "ticks": ticks,
        "log_bytes_a_tick": log_bytes / ticks,
    }
    print(json.dumps(figures))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
