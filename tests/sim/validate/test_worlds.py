"""Claims on worlds that change: each can fail, and says by whom."""

from dataclasses import replace

import pytest

from sim.campaign.claim import ClaimVerdict
from sim.campaign.flight import FlightResult
from sim.scenario.schema import load
from sim.validate import worlds
from sim.validate.worlds import BASE, HARD, world_order

GOOD = {
    **{f"inside_{axis}": 0.99 for axis in (1, 2, 3)},
    "wrong_5deg_s": 20.0,
    "first_valid_s": 600.0,
    "valid_part": 0.95,
    "last_orbit_deg": 1.5,
}


def verdicts(world, isolated=(), **changed):
    """Of the claims on a world whose first satellite has these figures; all others are good."""
    study = worlds.studies(3)[0]
    names = [name for name in worlds.worlds() for _ in range(3)]
    flights, marked = [], False
    for name in names:
        mine = name == world and not marked
        marked = marked or mine
        figures = GOOD | (changed if mine else {})
        flights.append(
            FlightResult(world_order(name, 1), {"isolated": list(isolated) if mine else []}, figures)
        )
    outcomes = study.conclude(flights)
    return {one.claim.id.removeprefix("worlds."): one.verdict for one in outcomes}


def failed(world, **changed):
    return [name for name, verdict in verdicts(world, **changed).items() if verdict is not ClaimVerdict.PASS]


def test_good_flights_meet_every_claim():
    assert failed("storm") == []


@pytest.mark.parametrize(
    ("changed", "name"),
    [
        ({"inside_1": 0.6, "inside_2": 0.6}, "inside_worst"),
        ({"wrong_5deg_s": 121.0}, "wrong"),
        ({"first_valid_s": 901.0}, "first"),
        ({"isolated": ["magnetometer"]}, "isolated"),
        ({"valid_part": 0.5}, "valid"),
    ],
)
def test_one_satellite_is_enough_to_fail(changed, name):
    assert f"storm.{name}" in failed("storm", **changed)


def test_pointing_counts_beside_the_same_satellite_in_the_declared_world():
    assert failed(BASE, last_orbit_deg=0.3) == []  # three satellites: nine of ten are two
    study = worlds.studies(1)[0]
    flights = [
        FlightResult(
            world_order(name, 1), {"isolated": []}, GOOD | {"last_orbit_deg": 4.0 if name == "storm" else 1.5}
        )
        for name in worlds.worlds()
    ]
    missed = [one.claim.id for one in study.conclude(flights) if one.verdict is not ClaimVerdict.PASS]
    assert missed == ["worlds.storm.pointing"]


@pytest.mark.parametrize("world", HARD)
def test_beyond_the_table_it_counts_by_itself(world):
    assert failed(world, last_orbit_deg=12.5) == [f"{world}.pointing"]
    assert failed(world, last_orbit_deg=11.5) == []


@pytest.mark.parametrize("name", worlds.worlds())
def test_each_world_is_a_legal_scenario_that_differs_from_the_declared_one(name):
    order = world_order(name, 1)
    scenario = load(order.scenario, order.overrides)
    base = world_order(BASE, 1)
    same = scenario == load(base.scenario, base.overrides)
    assert same is (name == BASE)


def test_five_were_drawn():
    assert [name for name in worlds.worlds() if name.startswith("drawn_")] == [
        f"drawn_{n}" for n in range(1, 6)
    ]


@pytest.mark.long
def test_a_flight_gives_the_figures_of_the_claims():
    flown = worlds.fly_order(replace(world_order("storm", 1), orbits=0.3))
    assert set(GOOD) <= set(flown.figures)
    assert 0.0 < flown.figures["first_valid_s"] < 900.0
    assert 0.0 <= flown.figures["valid_part"] <= 1.0
