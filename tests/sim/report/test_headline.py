"""What is looked at first: the verdict, badges green only where it is met, figures that do not mislead."""

from fractions import Fraction

import numpy as np
import pytest

from sim.audit.auditor import AuditLimits
from sim.audit.findings import DrivenPulse
from sim.report import headline, tables
from sim.report.figures.performance import perform
from sim.report.summary import BusTally, summarise
from sim.report.summary_text import summary_text
from sim.scenario.schema import load, orbit_period_s

FLOWN = {"seed": 7, "flown": {"ticks": 7000, "slips": 0, "wall_s": None}}
APE = {"index": "ape", "at_most_deg": 60.0, "by_orbit": 1.0}


@pytest.fixture(scope="module")
def summary_of(made_run):
    """The summary of a made-up flight and its audit."""

    def make(scenario="microsat", requirement=(APE,), ticks=7000, **values):
        run = made_run(scenario=load(scenario, {"requirement": list(requirement)}), ticks=ticks, **values)
        audit, tally = run.audit(), BusTally(0, isolated=run.isolated)
        performance = perform(run.scenario, run.truth(), run.estimates())
        return summarise(run.scenario, FLOWN, performance, audit, tally) | {"replay": run.replay}, audit

    return make


def badges(made):
    return dict((words, kind) for kind, words in headline.badges(made[0], None, made[1]))


def names(made):
    return [tile.name for tile in headline.tiles(made[0])]


class TestVerdict:
    def test_met(self, summary_of):
        made = summary_of()
        kind, words = headline.headline(made[0])
        assert kind == "good"
        assert words.startswith("Met: APE of whole attitude ")
        assert badges(made)["✓ met"] == "good"
        assert badges(made)["✓ limits kept"] == "good"

    @pytest.mark.parametrize(
        ("requirement", "kind", "words"),
        [
            ((APE | {"at_most_deg": 0.001},), "bad", "✗ requirement missed"),
            ((APE | {"by_orbit": 2.0},), "note", "! not judged"),
            ((), "note", "! not judged"),
        ],
    )
    def test_no_badge_is_green_unless_all_are_met(self, summary_of, requirement, kind, words):
        made = summary_of(requirement=requirement)
        found = badges(made)
        assert found[words] == kind
        assert found["limits kept"] == "plain"
        assert "good" not in found.values()
        assert not any("✓" in text for text in found)

    def test_a_missed_one_comes_before_one_that_is_not_judged(self, summary_of):
        missed, unjudged = APE | {"at_most_deg": 0.001}, APE | {"by_orbit": 5.0}
        assert headline.headline(summary_of(requirement=(unjudged, missed))[0])[0] == "bad"
        assert headline.headline(summary_of(requirement=(APE, unjudged))[0])[0] == "note"

    def test_the_table_tells_why(self, summary_of):
        summary, _ = summary_of(requirement=(APE | {"at_most_deg": 0.001}, APE))
        table = headline.requirement_table(summary)
        assert [row[0] for row in table.rows] == ["failed", "met"]
        assert table.rows[0][2]
        assert not table.rows[1][2]
        text = summary_text(summary)
        assert "required   FAILED: APE of whole attitude" in text
        assert f"- {table.rows[0][2].replace('²', '^2')}" in text


def test_a_flight_that_was_cut_short_is_not_judged(made_run):
    run = made_run()
    performance = perform(run.scenario, run.truth(), run.estimates())
    summary = summarise(run.scenario, {"seed": 7}, performance, run.audit(), BusTally(0))
    assert [one["verdict"] for one in summary["requirements"]] == ["not judged"]
    assert headline.headline(summary) == (
        "note",
        "Not judged: APE of whole attitude: the flight did not come to its end.",
    )


class TestWhatIsControlled:
    def test_a_boom_is_judged_by_its_axis(self, summary_of):
        made = summary_of("posat1")
        assert names(made)[:2] == ["Axis 1 from vertical", "Settled"]
        assert "Pointing" not in names(made)
        text = summary_text(made[0])
        assert "pointing " not in text
        assert "axis 1 " in text
        figures = dict(tables.key_figures(made[0])[0])
        assert not [name for name in figures if name.startswith("Pointing")]

    def test_a_whole_attitude_is_judged_as_a_whole(self, summary_of):
        made = summary_of()
        assert names(made)[:2] == ["Pointing", "Axis 1 from vertical"]
        assert "under 5 deg from 1.0" in summary_text(made[0])

    def test_under_a_law_that_does_not_point_the_rate_is(self, made_run):
        scenario = load("microsat", {"control": {"law": "bdot"}, "requirement": []})
        run = made_run(scenario=scenario)
        performance = perform(scenario, run.truth(), run.estimates())
        summary = summarise(scenario, FLOWN, performance, run.audit(), BusTally(0))
        assert summary["controlled"]["what"] == "rate"
        assert summary["controlled"]["threshold"] == 0.3
        assert headline.tiles(summary)[0].name == "Rate"
        assert "rate       " in summary_text(summary)

    def test_settling_shows_its_threshold(self, summary_of):
        tiles = {tile.name: tile for tile in headline.tiles(summary_of()[0])}
        assert tiles["Settled"].note == "orbits to whole attitude under 5 deg"
        expected_s = 3000.0 * np.log(40.0 / 5.0)
        assert float(tiles["Settled"].value) == pytest.approx(
            expected_s / orbit_period_s(load("microsat")), abs=0.01
        )


class TestNoFigureMisleads:
    def test_a_flight_shorter_than_an_orbit_has_no_last_orbit(self, summary_of):
        summary, _ = summary_of(ticks=120)
        assert "the whole flight of 0.02 orbits" in summary_text(summary)
        assert "last orbit" not in summary_text(summary)
        assert headline.tiles(summary)[0].note == "RMS, whole flight of 0.02 orbits"
        assert not [name for name, _ in tables.key_figures(summary)[0] if "last orbit" in name]

    def test_with_a_back_off_of_each_coil_the_least_gap_is_that_of_a_coil(self, summary_of):
        pulses = [
            DrivenPulse(coil, 1, Fraction(at), Fraction(at + 3)) for at in (100, 210) for coil in (0, 1, 2)
        ]
        summary, audit = summary_of(pulses=tuple(pulses), limits=AuditLimits(shared=False))
        assert "least gap 107.000 s" in summary_text(summary)
        rows = {row[0]: row for row in tables.coil_table(summary, audit).rows}
        assert rows["all"][3] == ""
        assert rows["coil 1"][3] == "107.000"

    def test_duty_stays_under_its_limit_in_a_short_flight_too(self, summary_of):
        pulses = tuple(DrivenPulse(0, 1, Fraction(at), Fraction(at + 3)) for at in (1, 104, 207))
        summary, audit = summary_of(pulses=pulses, ticks=211)
        rows = {row[0]: row for row in tables.coil_table(summary, audit).rows}
        duty, limit = (float(rows[name][2].strip("≤ %")) for name in ("all", "limit of all"))
        assert duty == pytest.approx(100.0 * 9.0 / 210.0, abs=0.01)
        assert duty <= limit

    @pytest.mark.parametrize("shared", [True, False])
    def test_no_line_of_duty_is_above_its_limit(self, made_run, shared):
        """Pulses as dense as the limits admit."""
        coils = (0,) if shared else (0, 1, 2)
        pulses = tuple(
            DrivenPulse(coil, 1, Fraction(1 + 103 * k), Fraction(4 + 103 * k))
            for k in range(67)
            for coil in coils
        )
        flight = made_run(pulses=pulses, limits=AuditLimits(shared=shared)).flown()
        at_s = np.linspace(20.0, 7000.0, 4001)
        assert np.all(flight.duty(0, at_s) <= flight.most_duty(at_s) + 1e-9)
        assert flight.most_duty(at_s)[-1] == pytest.approx(3.0 / 103.0, rel=0.01)
