"""The claims on Sun cells: what is drawn, and that a flight which breaks a limit does not pass."""

import numpy as np
import pytest

from sim.campaign.flight import FlightResult, Order
from sim.scenario.schema import flight_table, load
from sim.validate import cells

GOOD = {
    "estimate_deg": {"rms_sunlit": 0.6, "rms_eclipse": 0.7, "max": 1.9, "within_3sigma": 0.99},
    "isolated": [],
}


def flight(**changes):
    estimate = {**GOOD["estimate_deg"], **{key: value for key, value in changes.items() if key != "isolated"}}
    summary = {**GOOD, "estimate_deg": estimate, "isolated": changes.get("isolated", [])}
    return FlightResult(Order("cubesat-cells"), summary, {"wrong_10deg_s": 0.0})


def test_a_flight_within_all_limits_passes():
    assert cells.passes(flight()) == 1.0


@pytest.mark.parametrize(
    "wrong",
    [
        {"rms_sunlit": 2.1},
        {"rms_eclipse": 4.1},
        {"within_3sigma": 0.94},
        {"isolated": ["cell 3"]},
    ],
)
def test_one_beyond_any_of_them_does_not(wrong):
    assert cells.passes(flight(**wrong)) == 0.0


def test_the_satellites_differ_from_their_table_and_among_each_other():
    drawn = [load("cubesat-cells", cells.differing(seed)) for seed in cells.SATELLITES]
    gains = np.array([scenario.sensors.cells.gain for scenario in drawn])
    turns = np.array([scenario.sensors.cells.turn_deg for scenario in drawn])
    assert np.abs(gains - 1.0).max() < 0.1
    assert np.abs(gains - 1.0).max() > 0.08
    assert 1.8 < np.linalg.norm(turns, axis=2).max() <= 2.0
    assert len({tuple(row) for row in gains.tolist()}) == len(drawn)
    for scenario in drawn:
        assert scenario.sensors.cells.albedo > 0.1
        assert flight_table(scenario).cells.albedo == 0.0


def test_crossed_cells_are_those_of_the_table_alone():
    scenario = load("cubesat-cells", cells.crossed())
    assert scenario.sensors.cells.normals[0] == (1.0, 0.0, 0.0)
    assert flight_table(scenario).cells.normals[0] == (0.0, 1.0, 0.0)
    assert sorted(flight_table(scenario).cells.normals) == sorted(scenario.sensors.cells.normals)
    differ = zip(flight_table(scenario).cells.normals, scenario.sensors.cells.normals, strict=True)
    places = [place for place, (assumed, true) in enumerate(differ, start=1) if assumed != true]
    assert tuple(f"cell {place}" for place in places) == cells.CROSSED


@pytest.mark.parametrize(
    ("isolated", "named"),
    [([], 0), (["cell 2"], 0), (["cell 3", "sun sensor"], 1), (["cell 3", "cell 1"], 2)],
)
def test_both_crossed_cells_are_to_be_named_in_the_end(isolated, named):
    (claim,) = (figure for figure in cells.crossed_figures() if figure.id == "named")
    assert claim.pick(flight(isolated=isolated)) == named
    assert (claim.low <= named) is (named == 2)


def test_no_seed_is_of_two_studies():
    seeds = [*cells.SEEDS, *cells.SATELLITES, *cells.WRONG]
    assert len(set(seeds)) == len(seeds) == 23
