"""Flights kept in a file: found by their orders, whole after every one."""

from dataclasses import replace
from functools import partial
from math import inf

import pytest

from sim.campaign.claim import Study
from sim.campaign.flight import FlightResult, Order, fly_order
from sim.errors import HarnessError
from sim.validate.flight_rows import FlightRows, keep_flight, with_kept_flights
from sim.validate.microsat import pointing_figures

ORDER = Order("microsat", {"disturbance": {"torque_nm": [1e-8, -2e-8, 3e-8]}}, 3, 8.0, name="one")


def flight(order=ORDER, pointing_deg=1.25):
    return FlightResult(
        order, {"isolated": ["coil 2"], "events": [1, 2]}, {"pointing_deg": pointing_deg, "pointed": inf}
    )


@pytest.fixture
def path(tmp_path):
    return tmp_path / "build" / "rows.jsonl"


def test_a_flight_is_in_the_file_at_once_without_its_events(path):
    rows = FlightRows(path)
    assert rows.flight(ORDER) is None
    rows.keep(flight())
    for read in (rows, FlightRows(path)):
        assert read.flight(ORDER) == FlightResult(
            ORDER, {"isolated": ["coil 2"]}, {"pointing_deg": 1.25, "pointed": inf}
        )


@pytest.mark.parametrize(
    "other",
    [
        Order("microsat", {"disturbance": {"torque_nm": [1e-8, -2e-8, 4e-8]}}, 3, 8.0, name="one"),
        Order("microsat", ORDER.overrides, 4, 8.0, name="one"),
        Order("microsat", ORDER.overrides, 3, 9.0, name="one"),
        Order("cubesat3u", ORDER.overrides, 3, 8.0, name="one"),
    ],
    ids=["overrides", "seed", "orbits", "scenario"],
)
def test_another_order_has_another_flight(path, other):
    rows = FlightRows(path)
    rows.keep(flight())
    assert rows.flight(other) is None
    rows.keep(flight(other, 2.5))
    assert FlightRows(path).flight(ORDER).figures["pointing_deg"] == 1.25
    assert FlightRows(path).flight(other).figures["pointing_deg"] == 2.5


def test_a_name_makes_no_other_flight(path):
    rows = FlightRows(path)
    rows.keep(flight())
    assert rows.flight(Order("microsat", ORDER.overrides, 3, 8.0, name="two")) is not None


def test_a_flight_that_was_measured_otherwise_is_another(path):
    rows = FlightRows(path)
    rows.keep(flight())
    assert rows.flight(replace(ORDER, measure=test_a_flight_that_was_measured_otherwise_is_another)) is None


def test_one_measured_by_another_version_of_its_measure_is_another(path, monkeypatch):
    measured = replace(ORDER, measure=pointing_figures)
    rows = FlightRows(path)
    rows.keep(flight(measured))
    assert rows.flight(measured) is not None
    monkeypatch.setattr("inspect.getsource", lambda module: "changed")
    assert rows.flight(measured) is None


class TestStudies:
    """Of flights and of other tasks."""

    def study(self):
        orders = (ORDER, replace(ORDER, seed=4))
        return Study("mixed", (*(partial(fly_order, order) for order in orders), partial(int, "7")), list)

    def test_a_flight_that_is_known_takes_the_place_of_its_task(self, path):
        rows = FlightRows(path)
        rows.keep(flight())
        (known,) = with_kept_flights([self.study()], rows)
        before, after = self.study().tasks, known.tasks
        assert after[0]() == rows.flight(ORDER)
        assert [each.args for each in after[1:]] == [each.args for each in before[1:]]

    def test_each_new_flight_is_kept_and_nothing_else(self, path):
        rows = FlightRows(path)
        for result in (flight(), 7.0, flight(), None):
            keep_flight(rows, result)
        assert len(path.read_text().splitlines()) == 1
        assert FlightRows(path).flight(ORDER) is not None


def test_a_row_whose_writing_was_cut_off_is_flown_again(path):
    rows = FlightRows(path)
    rows.keep(flight())
    other = Order("microsat", {}, 5, 8.0)
    rows.keep(flight(other))
    path.write_bytes(path.read_bytes()[:-20])
    again = FlightRows(path)
    assert (again.flight(ORDER) is not None, again.flight(other)) == (True, None)
    again.keep(flight(other, 7.0))
    assert FlightRows(path).flight(other).figures["pointing_deg"] == 7.0


@pytest.mark.parametrize(
    "content", [b"{}", b"my notes", b'{"order": "0"}\nmy notes', b'{"orders": ', b"\x00"]
)
def test_a_line_without_an_end_that_is_no_flight_is_left_alone(path, content):
    """It is someone else's file, whose last line is not to be cut off."""
    path.parent.mkdir()
    path.write_bytes(content)
    with pytest.raises(HarnessError, match=r"rows\.jsonl: line 1 is not a flight"):
        FlightRows(path)
    assert path.read_bytes() == content


@pytest.mark.parametrize("cut", [1, 5, 11, 40])
def test_a_first_line_that_was_cut_off_anywhere_is_written_anew(path, cut):
    FlightRows(path).keep(flight())
    path.write_bytes(path.read_bytes()[:cut])
    FlightRows(path).keep(flight(pointing_deg=7.0))
    assert FlightRows(path).flight(ORDER).figures["pointing_deg"] == 7.0
    assert len(path.read_text().splitlines()) == 1


def test_flights_of_other_code_count_only_where_they_are_asked_for(path, monkeypatch):
    FlightRows(path).keep(flight())
    monkeypatch.setattr("sim.validate.flight_rows.code_digest", lambda: "changed")
    assert FlightRows(path).flight(ORDER) is None
    earlier = FlightRows(path, of_any_code=True)
    assert earlier.flight(ORDER) is not None
    assert earlier.is_of_other_code(ORDER)
    earlier.keep(flight(pointing_deg=3.0))
    assert FlightRows(path).flight(ORDER).figures["pointing_deg"] == 3.0
    assert not FlightRows(path, of_any_code=True).is_of_other_code(ORDER)


def test_a_second_run_overwrites_nothing(path):
    one, other = FlightRows(path), FlightRows(path)
    one.keep(flight())
    with pytest.raises(HarnessError, match="another run adds flights to it"):
        other.keep(flight(Order("microsat", {}, 5, 8.0)))
    one.keep(flight(Order("microsat", {}, 6, 8.0)))
    assert FlightRows(path).flight(ORDER) is not None


@pytest.mark.parametrize("line", ["[1, 2]", "{}", "pointing 3"])
def test_what_is_not_a_flight_is_told_in_one_sentence(path, line):
    FlightRows(path).keep(flight())
    with path.open("a") as file:
        file.write(f"{line}\n")
    with pytest.raises(HarnessError, match=r"rows\.jsonl: line 2 is not a flight"):
        FlightRows(path)


def test_a_file_that_cannot_be_used_is_told(tmp_path):
    with pytest.raises(HarnessError, match="cannot be read"):
        FlightRows(tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(HarnessError, match=r"rows\.jsonl"):
        FlightRows(tmp_path / "file" / "rows.jsonl").keep(flight())
