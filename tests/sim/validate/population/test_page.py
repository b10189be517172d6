"""The page of the populations and its pictures, of flights made up."""

from math import inf
from xml.etree import ElementTree

import pytest

from sim.campaign.flight import FlightResult
from sim.campaign.population import Tolerances, population_order
from sim.validate.population.claims import SOURCE
from sim.validate.population.page import HEAD, TOLERANCES, never_pointed, page, satellites_table
from sim.validate.population.pictures import draw_satellites, draw_sweep, spread_of
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
    return {"50kg": flights, "3u": flights[:1], "6u": []}


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


def test_satellites_that_never_point_are_counted_beside_what_a_coil_gives_in_the_mean():
    flights = [flight(), flight(2, pointed_orbits=inf), flight(3, pointed_orbits=inf, dipole_am2=0.0072)]
    _, sentence = never_pointed("3u", flights)
    assert sentence.startswith(
        "2 of 3 never come within 10 deg for good; their dipoles are 0.0072 to 0.0213 A m^2. "
    )
    assert sentence.endswith(
        "A coil gives 0.0014 A m^2 in the mean, at its highest level: 2 of them have more."
    )  # 0.048 x 3 s / 103 s
    small = [flight(dipole_am2=0.001, pointed_orbits=inf), *flights]
    assert never_pointed("3u", small)[1].endswith(": 2 of them have more.")
    assert never_pointed("3u", flights[:1]) == []


def test_the_page_says_whose_the_tolerances_are_and_which_satellite_is_not_among_them():
    assert SOURCE.endswith(": own estimate")
    assert "own estimate" in HEAD
    assert "The dipole is that of a satellite whose own was measured" in HEAD


def test_every_tolerance_is_on_the_page():
    assert {key for _, key, _ in TOLERANCES} == set(Tolerances.__dataclass_fields__) - {"declared_torque_nm"}


def test_the_page_has_sweeps_tolerances_and_satellites(populations, sweep):
    text = page([], populations, sweep, ["one.svg", "two.svg"], "3 of 4 flights.")
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
        "## 50kg",
        "## 3u",
        "## 6u",
    ]
    assert lines[-1].startswith("3 of 4 flights. Python ")


@pytest.mark.long
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
def test_nothing_flown_is_drawn_empty(tmp_path):
    nothing = {quantity: [] for quantity in QUANTITIES}
    draw_satellites({"50kg": [], "3u": [], "6u": []}, tmp_path / "one.svg")
    draw_sweep(nothing, tmp_path / "two.svg")
    assert "0 of 9 flights" in page([], {"50kg": []}, nothing, ["a", "b"], "0 of 9 flights.")
