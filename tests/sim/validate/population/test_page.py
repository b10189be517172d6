"""The page of the populations and its pictures, of flights made up."""

from math import inf
from xml.etree import ElementTree

import pytest

from sim.campaign.flight import FlightResult
from sim.campaign.population import Tolerances, population_order
from sim.validate.population.claims import SOURCE
from sim.validate.population.page import (
    HEAD,
    TOLERANCES,
    draw_satellites,
    draw_sweep,
    page,
    reached_table,
    satellites_table,
    spread_of,
    why_not_pointed,
)
from sim.validate.population.sweep import QUANTITIES

FIGURES = {
    "inside_1": 0.999,
    "inside_2": 0.912,
    "inside_3": 1.0,
    "estimate_deg": 0.31,
    "nees": 4.2,
    "pointing_deg": 1.52,
    "pointed_orbits": 1.8,
    "dipole_am2": 0.0213,
    "inertia_percent": 7.3,
    "misalignment_deg": 1.15,
}


def flight(seed=1, isolated=(), **change):
    return FlightResult(population_order("50kg", seed, 8.0), {"isolated": [*isolated]}, FIGURES | change)


@pytest.fixture(scope="module")
def populations():
    flights = [flight(), flight(2, ("coil 1", "sun sensor"), pointed_orbits=inf, dipole_am2=0.09)]
    return {"50kg": flights, "3u": flights[:1], "6u": flights[1:]}


@pytest.fixture(scope="module")
def sweep():
    return {
        quantity: [spread_of(size, [flight(pointing_deg=1.0 + 9.0 * size)]) for size in quantity.sizes(3)]
        for quantity in QUANTITIES
    }


def test_a_spread_is_the_median_and_the_worst():
    flights = [
        flight(pointing_deg=2.0, estimate_deg=0.5, inside_2=0.9),
        flight(pointing_deg=9.0, estimate_deg=0.2, inside_2=0.6, inside_1=1.0),
        flight(pointing_deg=1.0, estimate_deg=0.3, inside_2=1.0),
    ]
    spread = spread_of(0.07, flights)
    assert (spread.size, spread.satellites) == (0.07, 3)
    assert spread.pointing_deg == (2.0, 9.0)
    assert spread.estimate_deg == (0.3, 0.5)
    mean = 100.0 * (0.999 + 0.9 + 1.0 + 1.0 + 0.6 + 1.0 + 0.999 + 1.0 + 1.0) / 9.0
    assert spread.inside_percent == pytest.approx((mean, 60.0))


def test_a_satellite_is_a_row():
    rows = satellites_table([flight(7), flight(8, ("coil 1",), pointed_orbits=inf)])
    assert rows[2] == "| 7 | 0.0213 | 7.3 | 1.15 | 91.2 | 4.2 | 0.31 | 1.52 | 1.80 | none |"
    assert rows[3].endswith("| never | coil 1 |")
    assert len({row.count("|") for row in rows}) == 1


def test_of_satellites_that_never_point_the_page_says_what_they_do_without_limits_of_pulses():
    flights = [flight(), flight(2, pointed_orbits=inf), flight(3, pointed_orbits=inf, dipole_am2=0.0072)]
    lifted = [flight(1, pointing_deg=50.0), flight(2, pointing_deg=9.0), flight(3, pointing_deg=11.0)]
    _, sentence = why_not_pointed(flights, lifted)
    assert sentence == (
        "2 of 3 never come within 10 deg for good, for the last orbit at least; their dipoles are 0.0072 to "
        "0.0213 A m^2. With the continuous driver 1 of these 2 point within 10 deg: the back-off holds them. "
        "The other 1 are held by coils and law themselves."
    )
    assert why_not_pointed(flights, ())[1].endswith("A m^2."), "nothing says why"
    assert why_not_pointed(flights[:1], lifted) == []


def test_what_share_of_a_population_comes_within_what_error():
    errors = (1.0, 2.6, 4.9, 120.0)
    head, _, row = reached_table({"3u": [flight(pointing_deg=error) for error in errors]})
    assert head.startswith("| satellites | median [deg] | within 2.5 deg [%] | within 5 deg [%] |")
    assert row == "| 3u | 3.75 | 25 | 75 | 75 | 75 |"


def test_the_page_says_whose_the_tolerances_are_and_which_satellite_is_not_among_them():
    assert SOURCE.endswith(": own estimate")
    assert "own estimate" in HEAD
    assert "The dipole is that of a satellite whose own was measured" in HEAD


def test_every_tolerance_is_on_the_page():
    assert {key for _, key, _ in TOLERANCES} == set(Tolerances.__dataclass_fields__) - {"declared_torque_nm"}


def test_the_page_has_sweeps_tolerances_and_satellites(populations, sweep):
    text = page(
        [],
        populations,
        {"3u_continuous": populations["3u"]},
        sweep,
        ["one.svg", "two.svg"],
        "3 of 4 flights.",
    )
    lines = text.splitlines()
    assert "](one.svg)" in text
    assert "](two.svg)" in text
    limits = "0.001 to 0.1 | 0.0005 to 0.01 | 0.001 to 0.02"
    assert f"| residual dipole, any direction, log-uniform | {limits} | A m^2 |" in lines
    assert (
        "| largest error of a moment [%] | 10 | 1 | 91, worst 91 | 0.31, worst 0.31 | 97.03, worst 91.2 |"
        in lines
    )
    assert sum(line.startswith("| turns of both sensors, sum [deg] |") for line in lines) == 3
    assert [line for line in lines if line.startswith("## ")] == [
        "## One difference alone",
        "## All differences at once",
        "## What they reach",
        "## 50kg",
        "## 3u",
        "## 6u",
    ]
    assert lines[-1].startswith("3 of 4 flights. Python ")


@pytest.mark.long
@pytest.mark.slow
def test_pictures_have_their_labels(populations, sweep, tmp_path):
    draw_satellites(populations, tmp_path / "one.svg")
    draw_sweep(sweep, tmp_path / "two.svg")
    for name, words in (
        ("one.svg", ("50kg", "3u", "6u", "pointing error, RMS [deg]", "time inside 3 sigma [%]")),
        ("two.svg", ("residual dipole [A m²]", "worst", "error of the estimate, RMS [deg]", "Honesty")),
    ):
        text = (tmp_path / name).read_text(encoding="utf-8")
        ElementTree.fromstring(text)
        assert all(word in text for word in words), name


@pytest.mark.long
@pytest.mark.slow
def test_nothing_flown_is_drawn_empty(tmp_path):
    nothing = {quantity: [] for quantity in QUANTITIES}
    draw_satellites({"50kg": [], "3u": [], "6u": []}, tmp_path / "one.svg")
    draw_sweep(nothing, tmp_path / "two.svg")
    assert "0 of 9 flights" in page([], {"50kg": []}, {}, nothing, ["a", "b"], "0 of 9 flights.")
