"""Claims on the satellite with Sun cells: as it ships, with others than its table has, with wrong ones."""

import numpy as np
from numpy.typing import NDArray

from fsw.input.schema import Nested
from sim.campaign.claim import Study
from sim.campaign.consistency import consistency_figures
from sim.campaign.flight import Figures, FlightResult, Measure, Order
from sim.campaign.study import Figure, Group, Pick, campaign, figure_of, summary_value
from sim.design.theory.side_by_side import in_body
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.figures.attitude_arrays import angle_rad
from sim.report.figures.estimate_error import estimate_error
from sim.scenario.schema import Scenario, flight_table
from sim.statistics.settling import spans
from sim.validate.population.claims import isolated_units
from sim.value_types import Array

SCENARIO = "cubesat-cells"
SOURCE = "Cells as panel currents of SUCHAI-3 show them: up to a third of full sunlight comes from the Earth"
SEEDS, SATELLITES, WRONG = range(1, 11), range(301, 311), range(401, 441)
WRONG_ORBITS = 4.0
HONEST = "0.992 by an honest filter"
"""Three axes at once."""
CELLS, GAIN_PART, TURN_DEG = 6, 0.1, 2.0
SUNLIT_DEG, ECLIPSE_DEG, INSIDE = 2.0, 3.0, 0.95
CROSSED = ("cell 1", "cell 3")
WRONG_DEG, SOON_S = 10.0, 60.0
NAMED_PART, SOON_PART, SOON_PART_ONE = 0.8, 0.8, 0.6
EARTHLIGHT, FIELD_DEG = 1.0 / 3.0, 5.0
"""A reading further than this from what an attitude leads to speaks against it."""


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
            "cells.wrong",
            SOURCE,
            _group([_order(seed, crossed(), contradicted_figures, WRONG_ORBITS) for seed in WRONG]),
            crossed_figures(),
            "satellites",
        ),
    ]


def honest_figures() -> tuple[Figure, ...]:
    """Small errors in sunlight and in the shadow, inside what the filter says, and nothing isolated."""
    return (
        Figure("sunlit", "RMS error of the estimate in sunlight, all", "deg", SUNLIT, high=SUNLIT_DEG),
        Figure("eclipse", "RMS error of the estimate in eclipse, all", "deg", ECLIPSE, high=ECLIPSE_DEG),
        Figure(
            "inside",
            "Time inside 3 sigma about each axis at once, all",
            "1",
            INSIDE_ALL,
            low=INSIDE,
            wide=HONEST,
        ),
        Figure("isolated", "Healthy units isolated in a flight, all", "1", isolated_units, high=0.0),
    )


def crossed_figures() -> tuple[Figure, ...]:
    """Two cells that are connected crosswise are no satellite of the table: its flights must not pass.

    A wrong attitude that cells and field bear out may be valid: it is found to be wrong when the satellite
    has turned further (docs/fdir.md).
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
            "Part of the satellites, two cells connected crosswise, that isolate both within four orbits",
            "1",
            names_both,
            "mean",
            low=NAMED_PART,
        ),
        Figure(
            "soon",
            "Part of the satellites, two cells connected crosswise, that are never valid for over 60 s "
            "with an error above 10 deg that the field, by 5 deg, or two cells, by more than the Earth's "
            "light, speak against",
            "1",
            within(SOON_S, "contradicted_s"),
            "mean",
            low=SOON_PART,
        ),
        Figure(
            "soon_one",
            "The same where one cell, which may as well be dead, is enough to speak against it",
            "1",
            within(SOON_S, "contradicted_by_one_s"),
            "mean",
            low=SOON_PART_ONE,
        ),
    )


def within(limit_s: float, name: str) -> Pick:
    """1 where a time that the flight's measure gave is at most the limit, else 0; 0 where it gave none."""
    time_s = figure_of(name)
    return lambda flight: float(time_s(flight) <= limit_s)


def contradicted_figures(scenario: Scenario, truth: Histories, estimates: Estimates) -> Figures:
    """``consistency_figures``, and the longest times valid with a large error that sensors speak against.

    ``contradicted_s``: the field or two cells, since one alone may be dead; ``contradicted_by_one_s``: the
    field or one cell.
    """
    turn = estimate_error(truth, estimates)
    wrong = (np.degrees(angle_rad(turn)) > WRONG_DEG) & estimates.valid[: len(turn)]
    field, cells = fields_differ(truth, turn), cells_that_differ(scenario, truth, turn)

    def longest_s(against: NDArray[np.bool_]) -> float:
        return (
            max((past - first for first, past in spans(wrong & against)), default=0) / scenario.time.tick_hz
        )

    return {
        **consistency_figures(scenario, truth, estimates),
        "contradicted_s": longest_s(field | (cells > 1)),
        "contradicted_by_one_s": longest_s(field | (cells > 0)),
    }


def cells_that_differ(scenario: Scenario, truth: Histories, turn: Array) -> NDArray[np.int64]:
    """How many cells have other light than their places lead to, by more than the Earth's, (n,).

    Args:
        scenario: of the flight.
        truth: of the plant.
        turn: from the estimated to the true attitude, (n, 4).
    """
    true, assumed = scenario.sensors.cells, flight_table(scenario).cells
    assert true is not None
    assert assumed is not None
    sun_body = truth["lit"][:, None] * truth["sun_body"]
    light = np.maximum(sun_body @ np.array(true.normals).T, 0.0)
    expected = np.maximum(in_body(_back(turn), sun_body) @ np.array(assumed.normals).T, 0.0)
    count: NDArray[np.int64] = (np.abs(light - expected) > EARTHLIGHT).sum(axis=1)
    return count


def fields_differ(truth: Histories, turn: Array) -> NDArray[np.bool_]:
    """Whether the field has another direction than the estimated attitude leads to, (n,)."""
    field, expected = truth["b_body_t"], in_body(_back(turn), truth["b_body_t"])
    sine = np.linalg.norm(np.cross(field, expected), axis=1)
    differ: NDArray[np.bool_] = np.arctan2(sine, np.sum(field * expected, axis=1)) > np.radians(FIELD_DEG)
    return differ


def _back(turn: Array) -> Array:
    return turn * (1.0, -1.0, -1.0, -1.0)


def names_both(flight: FlightResult) -> float:
    """1 where both crossed cells were isolated, else 0."""
    return float(set(CROSSED) <= set(flight.summary["isolated"]))


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


def _order(
    seed: int, changed: Nested, measure: Measure = consistency_figures, orbits: float | None = None
) -> Order:
    return Order(SCENARIO, changed, seed, orbits, measure, f"{SCENARIO}, seed {seed}")


def _group(orders: list[Order]) -> tuple[Group, ...]:
    return (Group("", tuple(orders)),)
