"""``make population``, of flights made up."""

from xml.etree import ElementTree

import population
import pytest

from sim.campaign import study
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
FLIGHTS = 9 * 2 - 2 + 3 * 2
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
    for module in (population, study):
        monkeypatch.setattr(module, "fly_order", made_up)
    return made_up


@pytest.fixture
def run(tmp_path, flown):
    """Runs the command in one process; its exit code."""

    def main(*more):
        words = ("--satellites", "2", "--sizes", "2", "--per-size", "1", "--workers", "1")
        return population.main((*words, "--out", str(tmp_path / "page.md"), *more))

    return main


def test_the_page_has_every_flight_and_both_pictures(run, flown, tmp_path):
    assert run() == 1  # an axis inside 3 sigma 91 % of the time
    assert len(flown.orders) == FLIGHTS
    text = (tmp_path / "page.md").read_text()
    assert f"{FLIGHTS} flights. Python" in text
    for name in ("page.svg", "page-sweep.svg"):
        assert f"]({name})" in text
        ElementTree.parse(tmp_path / name)


def test_a_flight_that_fails_leaves_the_page_that_is_there(run, flown, tmp_path, capsys):
    page = tmp_path / "page.md"
    page.write_text("of hundreds of flights")
    flown.most = 5
    assert run() == 2
    assert capsys.readouterr().err.endswith("population: the flight ended before its time\n")
    assert page.read_text() == "of hundreds of flights"


@pytest.mark.slow
def test_pictures_are_the_same_for_the_same_flights(run, tmp_path):
    run()
    pictures = [tmp_path / name for name in ("page.svg", "page-sweep.svg")]
    first = [picture.read_bytes() for picture in pictures]
    run()
    assert [picture.read_bytes() for picture in pictures] == first


def test_what_cannot_be_written_is_told_before_anything_is_flown(run, flown, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert run("--out", str(tmp_path / "file" / "page.md")) == 2
    error = capsys.readouterr().err
    assert error.startswith("population: ")
    assert error.count("\n") == 1
    assert flown.orders == []
