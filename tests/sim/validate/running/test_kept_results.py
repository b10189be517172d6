"""What phasing and calibration give, kept beside the flights and found by task and code."""

from functools import partial
from math import nan

import pytest

from sim.campaign.claim import Study
from sim.campaign.flight import FlightResult, Order
from sim.errors import HarnessError
from sim.validate import flight_rows
from sim.validate.commissioning import calibrated, wirings
from sim.validate.flight_rows import FlightRows
from sim.validate.running import kept_results
from sim.validate.running.guard import Failed
from sim.validate.running.kept_results import keep_result, with_kept_results

TALLY = wirings.Tally((2, -1, 3), 40, 7, ((3, 1, 2),))
FLOWN = calibrated.Flown(7, (0.5, -2.9), 0.61, 0.58)


def studies():
    return [
        Study(
            "phasing", tuple(partial(wirings.tally, coils) for coils in ((1, 2, 3), TALLY.coils)), list, True
        ),
        Study("calibration", tuple(partial(calibrated.flown, number) for number in (7, 8)), list, True),
        Study("computed", (partial(float, 7),), list),
    ]


@pytest.fixture
def path(tmp_path, monkeypatch):
    for module in (flight_rows, kept_results):
        monkeypatch.setattr(module, "code_digest", lambda *parts: f"this {parts}")
    return tmp_path / "rows.jsonl"


def kept(path, *results):
    rows = FlightRows(path)
    for result in results:
        keep_result(rows, result)
    return FlightRows(path)


def tasks(rows):
    return [task for study in with_kept_results(studies(), rows) for task in study.tasks]


def test_a_result_that_is_known_takes_the_place_of_its_task_and_of_no_other(path):
    before = [task for study in studies() for task in study.tasks]
    after = tasks(kept(path, TALLY, FLOWN))
    assert (after[1](), after[2]()) == (TALLY, FLOWN)
    assert [(task.func, task.args) for task in (after[0], after[3], after[4])] == [
        (task.func, task.args) for task in (before[0], before[3], before[4])
    ]


def test_one_that_tells_nothing_is_kept_too(path):
    lost = calibrated.Flown(7, (nan,) * 22, nan, nan, "the log cannot tell the magnetometer")
    assert repr(tasks(kept(path, lost))[2]()) == repr(lost)


def test_each_is_kept_once_and_nothing_else_is(path):
    kept(path, TALLY, FLOWN, TALLY, 7.0, None, Failed("why", ""))
    assert len(path.read_text().splitlines()) == 2


def test_flights_are_in_the_same_file(path):
    rows, order = kept(path, TALLY), Order("microsat")
    rows.keep(FlightResult(order, {}, {"x": 1.0}))
    again = FlightRows(path)
    assert again.flight(order).figures == {"x": 1.0}
    assert tasks(again)[1]() == TALLY


def test_results_of_other_code_do_not_count(path, monkeypatch):
    kept(path, TALLY)
    monkeypatch.setattr(kept_results, "code_digest", lambda *parts: f"changed {parts}")
    assert tasks(FlightRows(path))[1].func is wirings.tally


def test_one_of_another_form_is_computed_anew(path):
    kept(path, TALLY)
    path.write_text(path.read_text().replace("[2, -1, 3], 40", '[2, -1, 3], "many"'))
    assert tasks(FlightRows(path))[1].func is wirings.tally


def test_a_row_without_a_result_is_no_row(path):
    kept(path, TALLY)
    path.write_text(path.read_text().replace('"result"', '"results"'))
    with pytest.raises(HarnessError, match="line 1 is not a flight"):
        FlightRows(path)
