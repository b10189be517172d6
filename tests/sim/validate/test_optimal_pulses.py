"""Claims on the law that plans pulses: which flights they fly, and when they fail."""

import pytest

from sim.campaign.claim import ClaimVerdict, Threshold
from sim.campaign.flight import FlightResult
from sim.scenario.schema import load
from sim.validate import optimal_pulses
from sim.validate.microsat import magnetometer_bias, pointing

SOUND = {"isolated": [], "limits_ok": True}
HONEST = {
    **{f"inside_{axis}": 0.997 for axis in (1, 2, 3)},
    "nees": 6.0,
    "wrong_5deg_s": 0.0,
}


def outcomes(ours, theirs, figures=None, summary=None):
    """Of satellites that point so by either law, by the last word of the claims' ids."""
    study = optimal_pulses.beside_mpc(range(1, 1 + len(ours)))
    flights = [
        FlightResult(task.args[0], SOUND | (summary or {}), HONEST | (figures or {}) | {"pointing_deg": deg})
        for task, deg in zip(study.tasks, (*ours, *theirs), strict=True)
    ]
    return {outcome.claim.id.rpartition(".")[2]: outcome for outcome in study.conclude(flights)}


def failed(found):
    return {name for name, outcome in found.items() if outcome.verdict is not ClaimVerdict.PASS}


def test_the_starts_are_those_that_mpc_flies():
    ours, theirs = (study.tasks for study in (optimal_pulses.matched(), pointing()))
    assert len(ours) == len(theirs) == 30
    for one, other in zip(ours, theirs, strict=True):
        a, b = (load(task.args[0].scenario, task.args[0].overrides) for task in (one, other))
        assert (a.control.law, b.control.law) == ("pulse_mpc", "mpc")
        assert (a.initial, a.disturbance, one.args[0].seed) == (b.initial, b.disturbance, other.args[0].seed)


@pytest.mark.parametrize("study", [optimal_pulses.matched(), pointing()], ids=["pulse_mpc", "mpc"])
def test_a_row_on_pointing_says_how_the_torque_acts_and_from_where_the_flights_start(study):
    rows = [figure.statement for figure in study.figures if figure.id.startswith("rms_")]
    assert len(rows) == 3
    assert all("N m about each axis, from up to 60 deg off, all seeds" in row for row in rows)
    for order in study.orders:
        x, y, z = order.overrides["disturbance"]["torque_nm"]
        assert x == y == z
        assert order.overrides["initial"]["angle_deg"] <= 60.0


@pytest.mark.parametrize("study", [optimal_pulses.matched(), magnetometer_bias()])
def test_a_limit_that_no_computation_has_found_is_a_choice(study):
    own = [figure.threshold for figure in study.figures if not figure.id.startswith("limits_")]
    assert set(own) == {Threshold.OWN}


def test_each_satellite_is_flown_by_both_laws():
    tasks = optimal_pulses.beside_mpc(range(1, 4)).tasks
    for one, other in zip(tasks[:3], tasks[3:], strict=True):
        a, b = (load(task.args[0].scenario, task.args[0].overrides) for task in (one, other))
        assert (a.control.law, b.control.law) == ("pulse_mpc", "mpc")
        assert (a.body, a.coils, a.disturbance) == (b.body, b.coils, b.disturbance)


def test_better_on_all_is_met():
    assert failed(outcomes((0.5, 0.9, 1.5), (0.6, 1.0, 3.0))) == set()


@pytest.mark.parametrize(
    ("ours", "theirs", "missed"),
    [
        ((0.7, 1.1, 1.0), (0.69, 1.0, 3.0), {"none_worse"}),
        ((0.61, 1.02, 3.03), (0.6, 1.0, 3.0), {"median"}),
        ((0.9, 1.2, 4.0), (0.6, 1.0, 3.0), {"median", "none_worse"}),
    ],
)
def test_worse_on_one_or_on_the_median_is_not(ours, theirs, missed):
    assert failed(outcomes(ours, theirs)) == missed


def test_a_healthy_part_that_is_isolated_or_a_filter_too_sure_is_told():
    isolated = outcomes((0.5, 0.9), (0.6, 1.0), summary={"isolated": ["COIL_1"]})
    assert failed(isolated) == {"isolated"}
    sure = outcomes((0.5, 0.9), (0.6, 1.0), figures={"inside_2": 0.9, "nees": 19.0})
    assert failed(sure) == {"inside", "inside_worst", "nees"}
