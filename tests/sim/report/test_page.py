"""The report: one page that needs nothing else, and says what was flown and how it went."""

import json
import re
import subprocess
import sys
import time
from dataclasses import replace
from fractions import Fraction

import matplotlib
import numpy as np
import pytest

from sim.audit.auditor import AuditLimits, ViolationKind
from sim.audit.findings import DrivenPulse, Violation
from sim.record.run_dir import SCHEMA_VERSION
from sim.report import page, tables
from sim.report.figures.performance import perform
from sim.report.summary import BusTally, summarise, summary_text
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
    return dict((words, kind) for kind, words in page.badges(made[0], None, made[1]))


def names(made):
    return [tile.name for tile in page.tiles(made[0])]


class TestVerdict:
    def test_met(self, summary_of):
        made = summary_of()
        kind, words = page.headline(made[0])
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
        assert page.headline(summary_of(requirement=(unjudged, missed))[0])[0] == "bad"
        assert page.headline(summary_of(requirement=(APE, unjudged))[0])[0] == "note"

    def test_the_table_tells_why(self, summary_of):
        summary, _ = summary_of(requirement=(APE | {"at_most_deg": 0.001}, APE))
        table = page.requirement_table(summary)
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
    assert page.headline(summary) == (
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
        assert page.tiles(summary)[0].name == "Rate"
        assert "rate       " in summary_text(summary)

    def test_settling_shows_its_threshold(self, summary_of):
        tiles = {tile.name: tile for tile in page.tiles(summary_of()[0])}
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
        assert page.tiles(summary)[0].note == "RMS, whole flight of 0.02 orbits"
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


# --- The report: one page that needs nothing else, and says what was flown and how it went


@pytest.fixture
def charts(page):
    """The charts of a whole flight."""
    return {name for name in page.values("id") if name.startswith("chart-")}


@pytest.fixture
def no_charts(monkeypatch):
    """For what is said beside them: they take a second."""
    monkeypatch.setattr("sim.report.charts.sections.sections", lambda *given: [])


def test_the_page_needs_nothing_but_itself(page):
    assert not {"link", "iframe", "object", "embed", "img", "image", "base", "form"} & set(page.tags)
    assert not [name for _, name, _ in page.attributes if name.startswith("on")]
    for name in ("src", "href", "xlink:href", "action", "data", "srcset"):
        assert [value for value in page.values(name) if not value.startswith("#")] == []
    assert set(re.findall(r"url\(\s*(.)", page.source)) == {"#"}
    for word in ("@import", "@font-face", "://", "<!DOCTYPE svg", "<?xml"):
        assert word not in page.written
    for word in ("fetch(", "XMLHttpRequest", "import(", "WebSocket", "EventSource"):
        assert word not in page.source


def test_ids_are_unique_and_every_reference_finds_its_own(page):
    ids = page.values("id")
    assert len(ids) == len(set(ids))
    referred = [value[1:] for value in page.values("xlink:href") + page.values("href")]
    referred += re.findall(r"url\(#([^)]*)\)", page.written)
    assert referred
    assert set(referred) <= set(ids)


def test_the_head_says_what_was_flown_and_how_it_went(page):
    for words in (
        "microsat",
        "50 kg, 800 km, filter in the loop, pulsed coils with shared back-off",
        "✓ limits kept",
        "✓ no refusals",
        "✓ replay bit-exact",
        "mode POINT",
    ):
        assert words in page.text
    assert "seed 7 · 7000 ticks, 7000 s" in page.text
    assert "viewport" in page.values("name")


@pytest.mark.usefixtures("no_charts")
def test_isolated_units_stand_in_the_head(tmp_path, made_run):
    page = made_run(isolated=["coil 1", "sun sensor"]).write(tmp_path)
    assert "! isolated: coil 1, sun sensor" in page.text


def test_key_figures_are_those_of_the_summary(page):
    text = " ".join(page.text)
    assert "isolated" not in text
    assert "Estimate inside its 3 sigma 100.00% of the time" in text
    assert re.search(r"Pointing at the end \d+\.\d{3}°", text)
    assert "NEES, mean (6 expected)" in text
    assert "coil 0 4 0.17% 327.000" in text
    assert "all 12 0.51% 107.000 limit of all ≤ 2.91% ≥ 100" in text


def write_run(folder, **values):
    """The run.json of a run, these values changed."""
    known = {
        "schema_version": SCHEMA_VERSION,
        "torquer_version": "4.5.6",
        "scenario": "microsat",
        "scenario_sha256": "f00d" * 16,
        "flight_table_crc": "0badcafe",
        "seed": 7,
        "ticks": 7000,
        "bus": "loop",
        "pace": "lockstep",
        "pace_factor": None,
        "platform": {"machine": "x86_64", "system": "Linux", "python": "3.11.7", "numpy": "2.0.0"},
        "complete": False,
    }
    (folder / "run.json").write_text(json.dumps(known | values))


@pytest.mark.usefixtures("no_charts")
def test_bus_and_versions_come_from_the_run_beside_the_report(tmp_path, made_run):
    write_run(tmp_path, flown={"ticks": 7000})
    page = made_run().write(tmp_path)
    assert "seed 7 · bus loop, lockstep · 7000 ticks, 7000 s · torquer 4.5.6" in page.text
    facts = ("torquer 4.5.6", "scenario f00df00df00d", "flight table 0badcafe")
    assert " · ".join((*facts, "Python 3.11.7, numpy 2.0.0", "Linux x86_64")) in page.text
    assert not [words for words in page.text if "incomplete" in words]


@pytest.mark.long
@pytest.mark.slow
def test_the_same_flight_gives_the_same_bytes_whatever_the_user_set_matplotlib_to(tmp_path, made_run):
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    one = made_run().write(tmp_path / "one")
    with matplotlib.rc_context({"font.size": 30.0, "svg.fonttype": "path", "axes.facecolor": "black"}):
        two = made_run().write(tmp_path / "two")
        assert matplotlib.rcParams["font.size"] == 30.0
    assert one.source == two.source


# --- flights that went wrong, or hardly went


@pytest.mark.long
def test_broken_limits_are_named_and_marked(tmp_path, made_run):
    broken = Violation(ViolationKind.GAP, Fraction("210.5"), 210, 1, 999, "starts 99.9 s after <coil 0>")
    page = made_run(violations=(broken,), notes=("the log has 2 boots",)).write(tmp_path)
    assert "✗ limits broken: 1" in page.text
    assert "✓ limits kept" not in page.text
    for words in ("210.500", "gap", "starts 99.9 s after <coil 0>", "the log has 2 boots"):
        assert words in page.text
    assert "limit broken" in page.texts["chart-raster"]


@pytest.mark.long
def test_thousands_of_broken_limits_do_not_drown_the_page(tmp_path, made_run):
    many = tuple(Violation(ViolationKind.PULSE, Fraction(i), i, 0, i, "too long") for i in range(5000))
    page = made_run(violations=many).write(tmp_path)
    assert "✗ limits broken: 5000" in page.text
    assert "and 4950 more" in page.text
    assert len(page.source) < 2_000_000


@pytest.mark.usefixtures("no_charts")
@pytest.mark.parametrize(
    ("replay", "words"),
    [
        (None, "not replayed"),
        ({"bit_exact": False, "command_exact": True}, "! replay command-exact only"),
        ({"bit_exact": False, "command_exact": False}, "✗ replay differs"),
    ],
)
def test_a_replay_that_differs_is_not_called_exact(tmp_path, replay, words, made_run):
    page = made_run(ticks=20, pulses=(), replay=replay).write(tmp_path)
    assert words in page.text
    assert "✓ replay bit-exact" not in page.text


@pytest.mark.usefixtures("no_charts")
def test_refusals_are_counted(tmp_path, made_run):
    page = made_run(ticks=20, pulses=(), refused=3).write(tmp_path)
    assert "! 3 refused" in page.text


@pytest.mark.usefixtures("no_charts")
def test_an_unfinished_flight_is_called_so(tmp_path, made_run):
    write_run(tmp_path, ticks=18124)
    page = made_run(complete=False).write(tmp_path)
    assert "✗ incomplete: 7000 of 18124 ticks" in page.text


@pytest.mark.usefixtures("no_charts")
def test_a_log_without_its_end_is_incomplete_though_nothing_else_is_known(tmp_path, made_run):
    page = made_run(ticks=20, pulses=(), complete=False).write(tmp_path)
    assert "✗ incomplete: 20 ticks" in page.text


@pytest.mark.long
@pytest.mark.parametrize("ticks", [1, 2, 3, 10])
@pytest.mark.filterwarnings("error")
def test_a_very_short_flight_has_a_report(tmp_path, ticks, made_run):
    page = made_run(ticks=ticks, pulses=()).write(tmp_path)
    assert "seconds from the start" in page.texts["chart-pointing"]
    assert "No coil was driven." in page.text


@pytest.mark.long
@pytest.mark.filterwarnings("error")
def test_a_flight_with_one_pulse_has_all_charts(tmp_path, made_run, charts):
    page = made_run(ticks=110, pulses=(DrivenPulse(0, 3, Fraction(100), Fraction(103)),)).write(tmp_path)
    assert charts <= set(page.values("id"))


@pytest.mark.filterwarnings("error")
def test_a_flight_of_no_tick_says_so(tmp_path, made_run):
    page = made_run(ticks=0, pulses=(), complete=False).write(tmp_path)
    assert "No tick was flown: there is nothing to draw." in page.text
    assert "! limits not judged: no coil status" in page.text
    assert "svg" not in page.tags


def unknown(estimates):
    """Estimates of a controller that had none."""
    ticks = len(estimates.mode)
    return replace(
        estimates,
        omega_body_radps=np.full((ticks, 3), np.nan),
        covariance=np.full((ticks, 6, 6), np.nan),
    )


@pytest.mark.long
@pytest.mark.filterwarnings("error")
def test_perfect_knowledge_has_no_estimate_to_show(tmp_path, made_run, charts):
    run = made_run(scenario=load("microsat", {"knowledge": "perfect"}))
    page = run.write(tmp_path, unknown(run.estimates()))
    assert "Perfect knowledge: the plant sent attitude and rate to the controller." in page.text
    assert charts - {"chart-estimate"} <= set(page.values("id"))
    assert "chart-estimate" not in page.values("id")


@pytest.mark.long
def test_a_filter_that_never_started_is_not_called_perfect_knowledge(tmp_path, made_run):
    run = made_run(ticks=20, pulses=())
    blind = replace(unknown(run.estimates()), q_body_from_orbit=np.full((20, 4), np.nan))
    page = run.write(tmp_path, blind)
    assert "The filter gave no estimate in this flight." in page.text


@pytest.mark.long
@pytest.mark.filterwarnings("error")
def test_an_estimate_that_comes_late_is_drawn_from_there(tmp_path, made_run):
    run = made_run()
    late = run.estimates()
    late.covariance[:3000] = np.nan
    late.omega_body_radps[:3000] = np.nan
    late.q_body_from_orbit[:3000] = np.nan
    page = run.write(tmp_path, late)
    assert "nan" not in " ".join(page.paths["chart-estimate"])
    assert "true error" in page.texts["chart-estimate"]


@pytest.mark.long
def test_whatever_a_scenario_is_called_stays_text(tmp_path, made_run):
    name, summary = "</title><script>alert(1)</script>", "<img src=x onerror=\"x\"> & 'so on'"
    scenario = load("microsat").model_copy(update={"name": name, "summary": summary})
    event = {"t_s": 1.0, "node": "<i>COIL</i>", "event": 9, "severity": 99, "argument": 0}
    page = made_run(ticks=20, pulses=(), scenario=scenario, events=[event]).write(tmp_path)
    assert {name, summary, "<i>COIL</i>"} <= set(page.text)
    assert not {"img", "i"} & set(page.tags)
    assert "alert(1)" not in page.scripts


@pytest.mark.long
def test_events_are_told_in_words(tmp_path, made_run):
    events = [
        {"t_s": 91.0, "node": "FSW", "event": 1, "severity": 0, "argument": 2},
        {"t_s": 95.5, "node": "COIL", "event": 200, "severity": 2, "argument": 4},
    ]
    page = made_run(ticks=20, pulses=(), events=events).write(tmp_path)
    text = " ".join(page.text)
    assert "91.000 0.02 FSW info mode ACQUIRE The attitude is estimated and turned towards nominal." in text
    assert "95.500 0.02 COIL error event 200 (4)" in text


# --- size and time


@pytest.mark.long
@pytest.mark.slow
def test_a_hundred_orbits_stay_small(tmp_path, made_run, charts):
    pulses = tuple(
        DrivenPulse(i % 3, (-3, -2, -1, 1, 2, 3)[i * 7 % 6], Fraction(103 * i + 100), Fraction(103 * i + 103))
        for i in range(5800)
    )
    run = made_run(ticks=600_000, pulses=pulses)
    noise = np.random.default_rng(5).standard_normal((600_000, 3))
    lit = (np.arange(600_000) % 6041 > 2000).astype(float)
    chatter = replace(run.estimates(), mode=np.arange(600_000) // 30 % 4)
    started = time.perf_counter()
    page = run.write(tmp_path, chatter, omega_body_orbit_radps=1e-4 * noise, lit=lit)
    assert time.perf_counter() - started < 30.0
    assert len(page.source.encode()) < 3_000_000
    assert charts <= set(page.values("id"))
    (bands,) = page.drawn("chart-pointing", "eclipse")
    assert bands.count("M") == 100


@pytest.mark.long
def test_who_draws_nothing_does_not_wait_for_matplotlib():
    code = (
        "import sys, sim.report.page\n"
        "assert not [name for name in sys.modules if name.startswith('matplotlib')]\n"
        "import sim.report.charts.sections\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
