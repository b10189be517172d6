"""Train the units of ``pd_neural``: the weights found, which are its defaults, are kept beside how.

Takes some twenty minutes. ``--flights`` and ``--generations`` make it shorter, for a look.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from argument_types import count

from sim.design.neural_training import MOST_AM2, PD_GAINS, cost, orbit_rms_deg, train, trials
from sim.design.theory.bodies import BODIES
from sim.progress import progress
from sim.record.whole_file import replace_text

KEPT = Path(__file__).resolve().parent.parent / "sim" / "design" / "neural_found.json"
FLIGHTS, GENERATIONS, FLIGHTS_SEED, SEARCH_SEED = 60, 140, 1, 3


def main() -> None:
    """Train, print the weights, write the file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--flights", type=count, default=FLIGHTS)
    parser.add_argument("--generations", type=count, default=GENERATIONS)
    parser.add_argument("--out", type=Path, default=KEPT)
    given = parser.parse_args()
    body, flown = BODIES[2], trials(given.flights, FLIGHTS_SEED)
    lowest: list[float] = []
    with progress("generations", given.generations) as watch:

        def report(generation: int, cost_so_far: float) -> None:
            lowest.append(round(cost_so_far, 4))
            watch(generation)

        found, _ = train(body, PD_GAINS, flown, MOST_AM2, SEARCH_SEED, given.generations, report=report)
    weights = np.round(found, 3)
    members = np.array([np.zeros(7), weights])
    members[0, 6] = weights[6]
    without, trained = cost(orbit_rms_deg(body, PD_GAINS, members, flown, MOST_AM2)).tolist()
    kept = {
        "weights": weights.tolist(),
        "cost": round(trained, 4),
        "cost_of_constant_gains": round(without, 4),
        "flights": given.flights,
        "flights_seed": FLIGHTS_SEED,
        "search_seed": SEARCH_SEED,
        "lowest_by_generation": lowest,
    }
    replace_text(given.out, json.dumps(kept, indent=1) + "\n")
    print(f"{given.out}: weights {weights.tolist()}, cost {trained:.4f}, of constant gains {without:.4f}")


if __name__ == "__main__":
    main()
