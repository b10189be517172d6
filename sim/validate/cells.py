"""Claims on the satellite with Sun cells: as it ships, with others than its table has, with wrong ones."""

import numpy as np

from fsw.input.schema import Nested
from sim.campaign.claim import Study
from sim.campaign.flight import FlightResult, Order
from sim.campaign.honesty import honesty_figures
from sim.campaign.study import Figure, Group, Pick, campaign, summary_value

SCENARIO = "cubesat-cells"
SOURCE = "Cells as panel currents of SUCHAI-3 show them: up to a third of full sunlight comes from the Earth"
SEEDS, SATELLITES, WRONG = range(1, 11), range(301, 311), range(401, 404)
CELLS, GAIN_PART, TURN_DEG = 6, 0.1, 2.0
SUNLIT_DEG, ECLIPSE_DEG, INSIDE = 2.0, 4.0, 0.95
CROSSED = ("cell 1", "cell 3")


def studies(most: int | None = None) -> list[Study]:
    """All of them; ``most``: at most so many satellites of the population."""
    drawn = SATELLITES[:most]
    return [
        campaign("cells", SOURCE, _group([_order(seed, {}) for seed in SEEDS]), honest_figures()),
        campaign(
            "cells.population",
            SOURCE,
            _group([_order(seed, differing(seed)) for seed in drawn]),
            honest_figures(),
            "satellites",
        ),
        campaign(
            "cells.wrong", SOURCE, _group([_order(seed, crossed()) for seed in WRONG]), crossed_figures()
        ),
    ]


def honest_figures() -> tuple[Figure, ...]:
    """Small errors in sunlight and in the shadow, inside what the filter says, and nothing isolated."""
    return (
        Figure("sunlit", "RMS error of the estimate in sunlight, all", "deg", SUNLIT, high=SUNLIT_DEG),
        Figure("eclipse", "RMS error of the estimate in eclipse, all", "deg", ECLIPSE, high=ECLIPSE_DEG),
        Figure("inside", "Time inside 3 sigma about each axis at once, all", "1", INSIDE_ALL, low=INSIDE),
        Figure("isolated", "Healthy units isolated in a flight, all", "1", isolated_units, high=0.0),
    )


def crossed_figures() -> tuple[Figure, ...]:
    """Two cells that are connected crosswise are no satellite of the table: its flights must not pass.

    That no wrong attitude is valid meanwhile is not claimed: one that fits cells and field is found to be
    wrong when the satellite has turned further (docs/fdir.md).
    """
    return (
        Figure(
            "unnoticed",
            "Flights that pass all of the claims on a sound satellite, two cells connected crosswise",
            "1",
            passes,
            high=0.0,
        ),
        Figure(
            "named",
            "Of two cells connected crosswise those that are isolated in the end, all",
            "1",
            crossed_cells,
            low=2.0,
        ),
    )


def crossed_cells(flight: FlightResult) -> float:
    """How many of the two were isolated."""
    return float(len(set(CROSSED) & set(flight.summary["isolated"])))


def isolated_units(flight: FlightResult) -> float:
    """How many units were isolated."""
    return float(len(flight.summary["isolated"]))


SUNLIT: Pick = summary_value("estimate_deg.rms_sunlit")
ECLIPSE: Pick = summary_value("estimate_deg.rms_eclipse")
INSIDE_ALL: Pick = summary_value("estimate_deg.within_3sigma", 0.0)


def passes(flight: FlightResult) -> float:
    """1 where a flight keeps all limits of ``honest_figures``, else 0."""
    kept = all(figure.low <= figure.pick(flight) <= figure.high for figure in honest_figures())
    return float(kept)


def differing(seed: int) -> Nested:
    """Cells with gains and turns of their own, and the Earth's light, which the table leaves out."""
    random = np.random.default_rng(seed)
    gains = random.uniform(1.0 - GAIN_PART, 1.0 + GAIN_PART, CELLS)
    turns = random.normal(size=(CELLS, 3))
    sizes = TURN_DEG * random.uniform(size=CELLS) ** (1.0 / 3.0)
    turns *= (sizes / np.linalg.norm(turns, axis=1))[:, None]
    axis = random.normal(size=3)
    return {
        "sensors": {
            "cells": {
                "gain": gains.tolist(),
                "turn_deg": turns.tolist(),
                "albedo": float(random.uniform(0.2, 0.4)),
            }
        },
        "initial": {"axis": axis.tolist(), "angle_deg": float(random.uniform(0.0, 60.0))},
        "flight": {
            "cells": {"albedo": 0.0},
            "uncertainty": {"sun_misalignment_deg": TURN_DEG, "cell_light_percent": 30.0},
        },
    }


def crossed() -> Nested:
    """The table has the first cell where the third is, and the third where the first is."""
    normals = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
    rest = [[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
    return {"flight": {"cells": {"normals": normals + rest}}}


def _order(seed: int, changed: Nested) -> Order:
    return Order(SCENARIO, changed, seed=seed, measure=honesty_figures, name=f"{SCENARIO}, seed {seed}")


def _group(orders: list[Order]) -> tuple[Group, ...]:
    return (Group("", tuple(orders)),)
