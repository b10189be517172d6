"""What the plans of ``pulse_mpc`` cost: one flight with it in one process, each plan timed.

Prints as JSON how many plans there were, those that find no pulse among them, and their time in ms: the mean,
and what one in a hundred exceeds. The law acts in POINT: a flight has to last until then.

    python plan_once.py SCENARIO ORBITS
"""

import json
import sys
import time
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.table import LAWS
from sim.flight.record_flight import ticks_of
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.pace import LOCKSTEP
from sim.scenario.schema import load


def main(scenario_name: str, orbits: float) -> None:
    """Fly, and print the figures."""
    scenario = load(scenario_name, {"control": {"law": "pulse_mpc"}})
    entry, plans_ms = LAWS["pulse_mpc"], list[float]()

    def timed(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
        begin_s = time.perf_counter()
        demand = entry.point(inputs, memory, setpoint, config)
        passed_s = time.perf_counter() - begin_s
        if demand.memory != memory and demand.memory[0] > inputs.tick:  # when the next plan is made: one was
            plans_ms.append(1e3 * passed_s)
        return demand

    LAWS["pulse_mpc"] = replace(entry, point=timed)
    with TemporaryDirectory() as folder:
        path = Path(folder, "run")
        run_dir.begin(path, scenario, 1, ticks_of(scenario, orbits), "virtual", LOCKSTEP)
        fly_virtual(path, scenario, lambda tick: None)
    if not plans_ms:
        sys.exit(
            f"{scenario_name}: pulse_mpc made no plan in {orbits:g} orbits, POINT is not reached; fly more"
        )
    figures = {
        "plans": len(plans_ms),
        "mean_ms": float(np.mean(plans_ms)),
        "percentile_99_ms": float(np.percentile(plans_ms, 99)),
    }
    print(json.dumps(figures))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
