"""The page of the populations, of flights made up: its tables and its picture."""

import sys
from math import inf
from pathlib import Path
from xml.etree import ElementTree

import pytest

from sim.campaign.flight import FlightResult
from sim.campaign.runner import StudyResult
from sim.validate.population import studies

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import population  # noqa: E402

FIGURES = {
    "inside_1": 0.999,
    "inside_2": 0.912,
    "inside_3": 1.0,
    "estimate_deg": 0.31,
    "nees": 4.2,
    "point_inside_1": 1.0,
    "point_inside_2": 0.999,
    "point_inside_3": 1.0,
    "point_nees": 4.4,
    "wrong_10deg_s": 0.0,
    "pointing_deg": 1.52,
    "pointed_orbits": 1.8,
    "in_point": 1.0,
    "dipole_am2": 0.0213,
    "inertia_percent": 7.3,
    "misalignment_deg": 1.15,
}


def flight(order, **change):
    summary = {"isolated": ["coil 1", "sun sensor"] if change else []}
    return FlightResult(order, summary, FIGURES | change)


@pytest.fixture(scope="module")
def finished():
    """Two satellites of each population; the second is off."""
    done = []
    for study in studies(most=2):
        results = tuple(
            flight(task.args[0], **({"pointed_orbits": inf, "dipole_am2": 0.09} if number else {}))
            for number, task in enumerate(study.tasks)
        )
        done.append(StudyResult(study, tuple(study.conclude(results)), results, 1.0))
    return done


def test_the_page_has_claims_tolerances_and_satellites(finished):
    text = population.page(finished, "picture.svg", 12.3)
    assert "(`population.50kg.isolated`)" in text
    assert "](picture.svg)" in text
    limits = "0.001 to 0.1 | 0.0005 to 0.01 | 0.001 to 0.02"
    assert f"| residual dipole, any direction, log-uniform | {limits} | A m^2 |" in text
    assert "| 1 | 0.0213 | 7.3 | 1.15 | 91.2 | 4.2 | 0.31 | 1.52 | 1.80 | none |" in text
    assert text.count("| never | coil 1, sun sensor |") == 3
    assert [line for line in text.splitlines() if line.startswith("## ")] == [
        "## What is drawn",
        "## 50kg",
        "## 3u",
        "## 6u",
    ]


def test_every_tolerance_is_on_the_page():
    shown = {key for _, key, _ in population.TOLERANCES}
    assert shown == set(population.Tolerances.__dataclass_fields__) - {"declared_torque_nm"}


def test_the_picture_is_the_same_for_the_same_flights(finished, tmp_path):
    for name in ("one.svg", "two.svg"):
        population.draw(finished, tmp_path / name)
    text = (tmp_path / "one.svg").read_text()
    assert text == (tmp_path / "two.svg").read_text()
    ElementTree.fromstring(text)
    for words in ("50kg", "3u", "6u", "pointing error, RMS [deg]", "time inside 3 sigma [%]"):
        assert words in text


def test_a_page_that_cannot_be_written_is_one_sentence(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert population.main(("--out", str(tmp_path / "file" / "page.md"))) == 2
    error = capsys.readouterr().err
    assert error.startswith("population: ")
    assert error.count("\n") == 1
