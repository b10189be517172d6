"""Rows of the fault table as scenarios: those that apply, and why the others do not."""

from pathlib import Path

import pytest

from sim.fault_table.row import Unseen
from sim.fault_table.rows.table import ROWS, choose_rows
from sim.fault_table.wrong_estimates import ALONE_DEG, WRONG_DEG
from sim.faults.kinds import KINDS
from sim.judge.faults import fault_cases, not_applicable
from sim.scenario.schema import load, orbit_period_s

TUMBLER = str(Path(__file__).with_name("tumbler.toml"))
MICROSAT, CELLS = load("microsat"), load("cubesat-cells")


def row(name):
    return next(one for one in ROWS if one.name == name)


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("bit-flip", "it reaches into the memory of this project's flight software"),
        ("sync-lost", "only this project's rig loses, holds or repeats SYNC"),
        ("cell-dead", "it is of the satellite cubesat-cells"),
        ("clock-off", "it changes the onboard table of this project's flight software"),
        ("mag-bias", ""),
        ("loss-50", ""),
    ],
)
def test_a_row_that_does_not_apply_says_why(name, why):
    assert not_applicable(row(name), MICROSAT) == why


def test_none_that_the_plant_cannot_inject_is_flown():
    for one in ROWS:
        if not not_applicable(one, MICROSAT):
            assert all(KINDS[fault.kind].in_plant for fault in one.faults)


def test_most_rows_apply_and_each_of_these_is_a_scenario():
    cases = list(fault_cases(MICROSAT, choose_rows((), slow=True), 1, 1))
    assert len(cases) == len(ROWS)
    flown = [case for case in cases if case.scenario is not None]
    assert len(flown) > 100
    for case in flown:
        assert case.scenario.fault
        assert case.scenario.requirement == ()
    assert all(case.why_not for case in cases if case.scenario is None)


def test_a_row_lasts_until_what_is_watched_after_it():
    (case,) = fault_cases(MICROSAT, [row("mag-bias-passing")], 1, 1)
    (fault,) = case.scenario.fault
    end_s = fault.at_s + fault.lasts_s + row("mag-bias-passing").watch_s
    assert case.scenario.time.orbits * orbit_period_s(case.scenario) == pytest.approx(end_s)


def test_each_phase_is_a_case_with_a_seed_and_a_time_of_its_own():
    cases = list(fault_cases(MICROSAT, [row("loss-10")], 3, 5))
    assert [case.name for case in cases] == ["loss-10-0", "loss-10-1", "loss-10-2"]
    assert [case.seed for case in cases] == [5, 6, 7]
    assert len({case.scenario.fault[0].at_s for case in cases}) == 3


def test_a_fault_of_what_the_satellite_does_not_have_is_told():
    (case,) = fault_cases(CELLS, [row("sun-frozen")], 1, 1)
    assert case.scenario is None
    assert "in whose place there is sensors.cells" in case.why_not


def test_how_wrong_an_attitude_may_be_follows_the_row():
    limits = {case.name: case.honest_deg for case in fault_cases(MICROSAT, ROWS, 1, 1) if case.scenario}
    for one in ROWS:
        if one.name in limits:
            never, always = one.unseen is Unseen.NEVER, one.unseen in (Unseen.ALWAYS, Unseen.AT_FIRST)
            assert limits[one.name] == (WRONG_DEG if never else None if always else ALONE_DEG)


def test_rows_of_an_eclipse_are_of_microsat():
    in_eclipse = [one for one in ROWS if one.when.value == "eclipse" and one.scenario == "microsat"]
    assert in_eclipse
    assert not any(not_applicable(one, MICROSAT) for one in in_eclipse)
    assert all(
        "eclipse of the satellite microsat" in not_applicable(one, load(TUMBLER)) for one in in_eclipse
    )
