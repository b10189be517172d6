"""Record the golden logs anew: ``make golden``. Nothing else changes them.

A golden log is a short flight on the virtual bus, kept with the scenario it was flown with and the platform
it was recorded on. What the flight software answered then, it must answer today.
"""

import gzip
import json
import shutil
import sys
import tempfile
from pathlib import Path

from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.pace import Pace
from sim.scenario.schema import load

HERE = Path(__file__).resolve().parent
FLIGHTS: dict[str, tuple[str, int, dict[str, object]]] = {
    "microsat": ("microsat", 700, {}),
    "microsat-10hz-per-coil": (
        "microsat",
        1500,
        {"time": {"tick_hz": 10}, "coils": {"backoff": "per_coil"}},
    ),
    "cubesat3u-offdiagonal": (
        "cubesat3u",
        400,
        {"body": {"inertia_kgm2": [[0.0067, 2e-4, 1e-4], [2e-4, 0.033, 3e-4], [1e-4, 3e-4, 0.0335]]}},
    ),
    "posat1": ("posat1", 400, {}),
}
"""By name: scenario, ticks, overrides."""

SEED = 20


def record(name: str) -> None:
    """Fly one and keep its log, scenario and platform."""
    scenario_name, ticks, overrides = FLIGHTS[name]
    scenario = load(scenario_name, overrides)
    with tempfile.TemporaryDirectory() as folder:
        run = Path(folder) / "run"
        run_dir.begin(run, scenario, SEED, ticks, "virtual", Pace())
        fly_virtual(run, scenario, lambda tick: None)
        target = HERE / name
        target.mkdir(exist_ok=True)
        shutil.copy(run / run_dir.SCENARIO, target / run_dir.SCENARIO)
        with (
            (target / "bus.log.gz").open("wb") as file,
            gzip.GzipFile("", "wb", mtime=0, fileobj=file) as packed,
        ):
            packed.write((run / run_dir.BUS_LOG).read_bytes())
        platform = json.dumps(run_dir.fingerprint(), indent=2) + "\n"
        (target / "platform.json").write_text(platform, encoding="utf-8")


if __name__ == "__main__":
    for chosen in sys.argv[1:] or FLIGHTS:
        record(chosen)
        print(f"recorded {chosen}")
