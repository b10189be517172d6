"""The page of ``make sizing``, from invented figures, and when the tool fails."""

from dataclasses import replace

import pytest
import sizing
from sizing import CUBESATS, OTHERS, SATELLITES, Cubesat, Row, faults, main, orders_of, page

from sim.scenario.schema import load
from sim.sizing.command import SURE_DEG
from sim.sizing.expectation import Expectation

EXPECTED = Expectation(
    field_t=2e-5,
    disturbance_nm=5e-8,
    floor_deg=0.4,
    least_floor_deg=0.2,
    quantum_deg=0.3,
    ripple_deg=0.0,
    variation_deg=0.0,
    knowledge_deg=0.0,
    shadow_part=0.5,
    load=0.1,
)
ROW = Row("levels 1, 2, 3", "microsat", "mpc", EXPECTED, (0.6, 0.3, 0.45))
OTHER = Row("301", "cubesat6u", "mpc", EXPECTED, (1.4, 1.4, 1.4))
CUBESAT = Cubesat("one-u", "pulsed", 2.0, (), (2.5, 1.5, 3.0), ((), (), ()))
TOO_STRONG = ROW._replace(expected=replace(EXPECTED, floor_deg=SURE_DEG + 0.1), flown_deg=(90.0,))


def test_a_row_has_the_parts_and_the_spread_of_the_flights():
    text = page([ROW], [OTHER], [CUBESAT])
    assert "| `microsat`, levels 1, 2, 3 | `mpc` | 0.40 | 0.30 | 0.00 | 0.00 | 0.00 | 0.10 | 0.50 " in text
    assert "| 0.50 | 0.45 (0.30 to 0.60) |" in text
    assert "10 orbits each with 3 seeds" in text
    assert "drawn at random: 0 of 1 fly within a factor of two" in text
    assert "| 301 | 0.40 | 0.00 | 0.50 | 0.36 | no | 1.40 (1.40 to 1.40) | 2.80 |" in text


def test_what_is_said_of_flights_is_of_small_floors_alone():
    text = page([ROW, TOO_STRONG], [OTHER], [CUBESAT])
    assert "Up to a floor of 3 deg flights have 0.60 to 1.20 times the figure" in text


@pytest.mark.parametrize(("flown_deg", "fails"), [(0.26, False), (0.24, True), (0.99, False), (1.01, True)])
def test_flights_further_off_than_a_factor_of_two_fail(flown_deg, fails):
    assert bool(faults([ROW._replace(flown_deg=(0.5, flown_deg, flown_deg))], [], [])) is fails


@pytest.mark.parametrize(("flown_deg", "fails"), [(1.49, False), (1.51, True), (0.17, False), (0.16, True)])
def test_of_those_drawn_at_random_only_flights_off_by_three_fail(flown_deg, fails):
    other = OTHER._replace(flown_deg=(flown_deg,))
    assert bool(faults([], [other], [])) is fails
    doubted = other._replace(expected=replace(EXPECTED, floor_deg=SURE_DEG + 0.1), flown_deg=(90.0,))
    assert faults([], [doubted], []) == []


def test_a_figure_that_is_a_lower_bound_cannot_fail():
    overloaded = ROW._replace(expected=replace(EXPECTED, load=1.1), flown_deg=(90.0,))
    assert faults([TOO_STRONG, overloaded], [], []) == []


@pytest.mark.parametrize(("what", "name", "keys"), SATELLITES + OTHERS)
def test_each_satellite_can_be_flown(what, name, keys):
    assert load(name, keys).coils.driver == "pulsed"
    assert [order.seed for order in orders_of(name, keys, 2)] == [1, 2]


@pytest.mark.parametrize(
    ("changed", "as_said"),
    [
        ({}, True),
        ({"flown_deg": (4.1, 4.1, 4.1)}, False),
        ({"flown_deg": (0.9, 0.9, 0.9)}, False),
        ({"flown_deg": (9.0, 9.0, 9.0), "warnings": ("the shadow",), "causes": (("shadow",),)}, True),
        ({"flown_deg": (9.0, 9.0, 9.0), "warnings": ("the shadow",), "causes": (("unknown",),)}, False),
        ({"flown_deg": (9.0, 9.0, 9.0), "causes": (("shadow",),)}, False),
        ({"expected_deg": None, "warnings": ("gravity",), "causes": (("gravity",),)}, True),
        ({"expected_deg": None}, False),
    ],
)
def test_a_cubesat_flies_as_was_said_or_was_warned_of_and_explained(changed, as_said):
    one = CUBESAT._replace(**changed)
    assert one.as_said is as_said
    assert (faults([], [], [one]) == []) is as_said


def test_those_drawn_differ_and_have_the_plates_of_one_box():
    drawn = [load(name, keys) for _, name, keys in OTHERS]
    assert len({one.orbit.altitude_km for one in drawn}) == len(drawn)
    for one in drawn:
        near, far = one.body.plates[0].centre_m, one.body.plates[1].centre_m
        assert near[0] - far[0] == pytest.approx(0.366)
        assert near[1:] == far[1:]


def test_the_cubesats_are_of_all_kinds():
    assert {bool(one.cells) for one in CUBESATS} == {one.continuous for one in CUBESATS} == {True, False}
    assert {one.looking[0] for one in CUBESATS} == {"x", "y", "z"}
    assert len(CUBESATS) >= 10


def test_a_page_that_cannot_be_written_is_told_before_anything_flies(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sizing, "fly", None)
    assert main(["--out", str(tmp_path)]) == 2
    assert f"sizing: {tmp_path}: cannot be written" in capsys.readouterr().err
