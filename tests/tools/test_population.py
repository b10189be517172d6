"""``make population``, of flights made up: what is flown is kept, and the page is made of what is kept."""

from xml.etree import ElementTree

import population
import pytest

from sim.campaign import runner
from sim.campaign.flight import FlightResult
from sim.errors import HarnessError

pytestmark = pytest.mark.long

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
FLIGHTS = 7 * 2 - 2 + 3 * 2
"""Two satellites of each study, of which none of those with a large dipole, and one of two sizes of each."""


class Flown:
    """Instead of flying; ``most``: ends after so many."""

    def __init__(self):
        self.orders, self.most = [], 1000

    def __call__(self, order):
        if len(self.orders) == self.most:
            raise HarnessError("the flight ended before its time")
        self.orders.append(order)
        pointing_deg = 1.52 + 0.1 * order.seed
        return FlightResult(order, {"isolated": [], "events": []}, FIGURES | {"pointing_deg": pointing_deg})


@pytest.fixture
def flown(monkeypatch):
    made_up = Flown()
    monkeypatch.setattr(population, "fly_order", made_up)
    return made_up


@pytest.fixture
def run(tmp_path, flown):
    """Runs the command in one process; its exit code."""
    assert runner.run is population.run

    def main(*more):
        words = ("--satellites", "2", "--sizes", "2", "--per-size", "1", "--workers", "1")
        files = ("--rows", str(tmp_path / "rows.jsonl"), "--out", str(tmp_path / "page.md"))
        return population.main((*words, *files, *more))

    return main


def test_the_page_has_every_flight_and_both_pictures(run, flown, tmp_path, capsys):
    assert run() == 1  # an axis inside 3 sigma 91 % of the time
    assert len(flown.orders) == FLIGHTS
    text = (tmp_path / "page.md").read_text()
    assert f"{FLIGHTS} of {FLIGHTS} flights. Python" in text
    for name in ("page.svg", "page-sweep.svg"):
        assert f"]({name})" in text
        ElementTree.parse(tmp_path / name)
    assert f"flying satellites: {FLIGHTS} of {FLIGHTS}" in capsys.readouterr().err


def test_what_is_flown_is_not_flown_again(run, flown, tmp_path):
    run()
    first = (tmp_path / "page.md").read_text()
    flown.orders.clear()
    run()
    assert flown.orders == []
    assert (tmp_path / "page.md").read_text() == first
    run("--satellites", "3")
    assert {order.seed for order in flown.orders} == {3}


def test_a_run_that_was_stopped_goes_on_where_it_was(run, flown, capsys):
    flown.most = 5
    assert run() == 2
    assert capsys.readouterr().err.endswith("population: the flight ended before its time\n")
    flown.orders.clear()
    flown.most = 1000
    run()
    assert len(flown.orders) == FLIGHTS - 5


def test_the_page_can_be_drawn_of_what_there_is_without_flying(run, flown, tmp_path):
    flown.most = 5
    run()
    assert run("--render") == 1
    assert len(flown.orders) == 5
    text = (tmp_path / "page.md").read_text()
    assert f"5 of {FLIGHTS} flights." in text
    assert (
        "(`population.twice.wrong`) | Tolerances of a satellite of this size whose dipole was measured: own "
        "estimate; 0 satellites" in text
    )


def test_without_a_flight_the_page_that_is_there_stays(run, tmp_path, capsys):
    page = tmp_path / "page.md"
    page.write_text("of hundreds of flights")
    assert run("--render") == 2
    assert "rows.jsonl holds none of these flights" in capsys.readouterr().err
    assert page.read_text() == "of hundreds of flights"


def test_flights_of_other_code_are_said_to_be(run, tmp_path, monkeypatch):
    run()
    monkeypatch.setattr("sim.validate.flight_rows.code_digest", lambda: "changed")
    run("--render")
    text = (tmp_path / "page.md").read_text()
    assert f"{FLIGHTS} of {FLIGHTS} flights, {FLIGHTS} of them by other versions of the code. Python" in text


def test_pictures_are_the_same_for_the_same_flights(run, tmp_path):
    run()
    pictures = [tmp_path / name for name in ("page.svg", "page-sweep.svg")]
    first = [picture.read_bytes() for picture in pictures]
    run("--render")
    assert [picture.read_bytes() for picture in pictures] == first


@pytest.mark.parametrize("option", ["--out", "--rows"])
def test_what_cannot_be_written_is_told_before_anything_is_flown(run, flown, tmp_path, capsys, option):
    (tmp_path / "file").write_text("")
    assert run(option, str(tmp_path / "file" / "page.md")) == 2
    error = capsys.readouterr().err
    assert error.startswith("population: ")
    assert error.count("\n") == 1
    assert flown.orders == []
