"""What the plans of ``pulse_mpc`` cost: one flight with it in one process, each plan timed.

Prints as JSON how many plans there were, those that find no pulse among them, and their time in ms: the mean,
and what one in a hundred exceeds. The law acts in POINT: a flight has to last until then.

    python plan_once.py SCENARIO ORBITS
"""

import json
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fsw.core.laws.interface import ControlConfig, LawInput
from fsw.core.laws.plan.pulse_model import Pulse, PulseModel
from fsw.core.laws.plan.riccati import Schedule
from fsw.core.laws.predictive import pulse_mpc
from sim.flight.record_flight import ticks_of
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.pace import LOCKSTEP
from sim.scenario.schema import load


def main(scenario_name: str, orbits: float) -> None:
    """Fly, and print the figures."""
    scenario = load(scenario_name, {"control": {"law": "pulse_mpc"}})
    plan, plans_ms = pulse_mpc._planned, list[float]()

    def timed(inputs: LawInput, pulses: PulseModel, schedule: Schedule, config: ControlConfig) -> Pulse:
        begin_s = time.perf_counter()
        pulse = plan(inputs, pulses, schedule, config)
        plans_ms.append(1e3 * (time.perf_counter() - begin_s))
        return pulse

    pulse_mpc._planned = timed
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
