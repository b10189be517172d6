"""The flight code compiled against the same interpreted: flights of an orbit are equal, byte for byte.

Scenario, seed of the plant, faults and their numbers are drawn. ``TORQUER_DRAW=N`` draws others.
"""

import json
import os
import subprocess
import sys
from random import Random

import pytest

from fsw.compiled import SWITCH, standing
from sim.faults.kinds import KINDS
from sim.record import run_dir
from sim.scenario.schema import load, shipped_names

FLIGHTS = 20
DRAW = int(os.environ.get("TORQUER_DRAW", "0"))
FLY = """
import json, sys
from pathlib import Path
from fsw.compiled import standing
from sim.flight.record_flight import ticks_of
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.pace import LOCKSTEP
from sim.scenario.schema import load
name, overrides, seed, orbits, out = json.loads(sys.argv[1])
scenario = load(name, overrides)
path = run_dir.begin(Path(out), scenario, seed, ticks_of(scenario, orbits), "virtual", LOCKSTEP)
fly_virtual(path, scenario, lambda tick: None)
print(standing().code)
"""


def drawn_fault(draw, cells):
    """A fault of the plant's process that begins within the orbit and fits the satellite's sensors."""
    other = "sun" if cells else "cells"
    kinds = [name for name, kind in KINDS.items() if kind.in_plant and kind.sensor != other]
    name = draw.choice(kinds)
    parameters = {
        key: draw.uniform(given.low, min(given.high, cells)) if key == "cell" else given.default
        for key, given in KINDS[name].parameters.items()
    }
    return {"kind": name, "at_s": draw.uniform(0.0, 4000.0), "lasts_s": 600.0, "parameters": parameters}


def drawn_flight(number):
    """Scenario, overrides and seed; every other one has faults."""
    draw = Random(f"{DRAW}/{number}")
    name = draw.choice(shipped_names())
    cells = load(name).sensors.cells
    faults = [drawn_fault(draw, 0 if cells is None else len(cells.normals)) for _ in range(number % 2 * 2)]
    return name, {"fault": faults} if faults else {}, draw.randrange(2**32)


def fly(flight, out, interpreted):
    """How the code ran, and what was recorded."""
    done = subprocess.run(
        [sys.executable, "-c", FLY, json.dumps([*flight, 1.0, str(out)])],
        env={**os.environ, SWITCH: str(int(interpreted))},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip(), [(out / name).read_bytes() for name in (run_dir.BUS_LOG, run_dir.TRUTH)]


@pytest.mark.long
@pytest.mark.skipif(bool(standing().reason), reason="nothing is compiled")
@pytest.mark.parametrize("number", range(FLIGHTS))
@pytest.mark.whole
def test_flights_are_equal_byte_for_byte(number, tmp_path):
    flight = drawn_flight(number)
    code, recorded = fly(flight, tmp_path / "compiled", interpreted=False)
    assert code == "compiled"
    assert fly(flight, tmp_path / "interpreted", interpreted=True) == ("interpreted", recorded), flight
