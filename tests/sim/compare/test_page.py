"""The page of a comparison: every law in the table, every flight over time, in any browser."""

import numpy as np
import pytest

from fsw.core.laws.table import LAWS
from sim.compare.case import Driver
from sim.compare.command import compare_page, unsettled_gains
from sim.compare.score import History, Result, Score
from sim.drawing.canvas import TimeAxis
from sim.scenario.controlled import Controlled
from sim.scenario.schema import load
from sim.tuning.kept import KeptGains

TIME = TimeAxis("orbits of 100.0 min", 6000.0, 0.0, 12000.0, ((1000.0, 3000.0),))
T_S = np.linspace(0.0, 12000.0, 120)

ATTITUDE = Controlled("attitude", "whole attitude", "deg", 5.0)
WINDOW = "the whole flight of 0.6 orbits"


def result(law, error_deg, driver=Driver.PULSED, **score):
    error = error_deg + 40.0 * np.exp(-T_S / 900.0)
    return Result(
        Score(law, LAWS[law].aim, driver, error_rms=error_deg, limits_ok=True, **score),
        History(TIME, T_S, error),
    )


def written(path, results):
    page = compare_page(
        load("microsat"), ("seed 1",), [each.score for each in results], results, WINDOW, ATTITUDE
    )
    path.write_text(page, encoding="utf-8")
    return page


@pytest.fixture
def results():
    both = [result(law, error, driver) for driver in Driver for law, error in (("pd", 2.0), ("lqr", 1.0))]
    failure = Score("mpc", LAWS["mpc"].aim, Driver.PULSED, failure="no <gains>")
    return [*both, Result(failure, None)]


@pytest.mark.long
def test_it_names_the_best_and_what_did_not_fly(tmp_path, results):
    page = written(tmp_path / "compare.html", results)
    for words in (
        "lqr<small>1.00° RMS, whole flight of 0.6 orbits</small>",
        "RMS, max and rate over the whole flight of 0.6 orbits;",
        "! 1 did not fly",
        "mpc, pulsed: no &lt;gains&gt;",
    ):
        assert words in page


def test_without_a_flight_there_is_no_chart(tmp_path, results):
    page = written(tmp_path / "compare.html", results[-1:])
    assert "<figure" not in page
    assert "! 1 did not fly" in page


def test_broken_limits_are_a_bad_verdict(tmp_path):
    (one,) = [result("pd", 2.0)]
    broken = Result(Score("pd", one.score.aim, Driver.PULSED, error_rms=1.0, limits_ok=False), one.history)
    assert '<li class="bad">✗ limits broken by 1</li>' in written(tmp_path / "compare.html", [broken])


def kept(**row):
    """Gains of pd, found in flights of four orbits."""
    pd = {"control": {"k_w": 1e7}, "cost": 0.4, "cost_before": 0.5, "rms": 0.7, **row}
    return KeptGains(1, 24, 4.0, rows={"pulsed": {"pd": pd}})


def test_gains_that_settled_when_they_were_found_and_do_not_here_are_named(tmp_path):
    (one,) = [result("pd", 20.0, tuned=True)]
    (sentence,) = unsettled_gains([one.score], kept(settle_orbits=1.25), 2.3)
    assert sentence == (
        "pd, pulsed: it settled after 1.25 orbits when its gains were found, and does not here"
    )
    page = compare_page(
        load("microsat"), (), [one.score], [one], WINDOW, ATTITUDE, kept(settle_orbits=1.25), [sentence]
    )
    assert sentence in page


@pytest.mark.parametrize(
    ("score", "row", "orbits"),
    [
        ({"tuned": True, "settle_orbits": 3.0}, {"settle_orbits": 1.25}, 10.0),
        ({"tuned": True}, {}, 10.0),
        ({"tuned": False}, {"settle_orbits": 1.25}, 10.0),
        ({"tuned": True, "failure": "no gains"}, {"settle_orbits": 1.25}, 10.0),
        ({"tuned": True}, {"settle_orbits": 1.25}, 2.2),
    ],
    ids=["settled", "never-settled", "scenario", "not-flown", "shorter"],
)
def test_no_other_gains_are(score, row, orbits):
    assert unsettled_gains([result("pd", 20.0, **score).score], kept(**row), orbits) == []
    assert unsettled_gains([result("pd", 20.0, tuned=True).score], None, orbits) == []


@pytest.mark.long
@pytest.mark.parametrize(("width", "dark"), [(390, True), (1400, False)])
def test_each_law_is_a_series_that_can_be_put_out(look, tmp_path, results, width, dark):
    written(tmp_path / "compare.html", results)
    page = look(tmp_path / "compare.html", width=width, dark=dark)
    assert page.locator(".legend button").count() == 4
    assert page.locator("#chart-error canvas").count() == 2
    page.locator(".legend button").first.click()
    assert page.evaluate("charts.plots[0].plot.series.map((one) => one.show)") == [True, False, True]
    assert page.evaluate("document.documentElement.scrollWidth") <= width
