import json
import re
import subprocess
import sys
import time
from dataclasses import dataclass, field, replace
from fractions import Fraction
from html.parser import HTMLParser
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from fsw.wire.messages import Mode
from sim.audit.auditor import AuditLimits, AuditReport, Kind
from sim.audit.findings import Pulse, Violation
from sim.drawing.canvas import BINS, envelope
from sim.record.estimates import Estimates
from sim.record.run_dir import SCHEMA_VERSION
from sim.record.truth import Histories
from sim.report.histories import Flown
from sim.report.page import write_report
from sim.report.summary import BusTally, summarise
from sim.scenario.schema import Scenario, load

CHARTS = {
    "chart-pointing": ["Pointing error", "angle [deg]", "axis 1 from the vertical"],
    "chart-modes": ["Mode", "SAFE", "DETUMBLE", "ACQUIRE", "POINT"],
    "chart-rates": ["rate [mdeg/s]", "axis 1", "axis 2", "axis 3"],
    "chart-estimate": ["error [deg]", "error [mdeg/s]", "true error", "3σ of the filter"],
    "chart-raster": ["coil 0", "coil 1", "coil 2", "+3", "-3"],
    "chart-zoom": ["coil 0", "coil 1", "coil 2", "3 s"],
    "chart-duty": ["duty [%]", "2.91 %: limit of all coils"],
    "chart-gaps_and_levels": ["gap to the next pulse [s]", "100 s back-off", "level"],
    "chart-field_and_dipole": ["field [µT]", "dipole [A m²]"],
    "chart-torques": ["torque [µN m]", "gravity gradient", "coils, mean of 10 min"],
}
"""The figures, and words that each of them must hold."""

VOID = {"meta", "br", "hr", "img", "link", "input"}


class Page(HTMLParser):
    """A page taken apart; a tag that is closed out of turn fails."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.source = text
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.text: list[str] = []
        self.texts: dict[str, list[str]] = {}
        self.paths: dict[str, list[str]] = {}
        self._open: list[tuple[str, str | None]] = []
        self.feed(text)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag, attrs):
        self.handle_startendtag(tag, attrs)
        if tag not in VOID:
            self._open.append((tag, dict(attrs).get("id") if tag == "figure" else None))

    def handle_startendtag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        figure = self._figure()
        if tag == "path" and figure:
            self.paths.setdefault(figure, []).append(dict(attrs)["d"])

    def handle_endtag(self, tag):
        opened, _ = self._open.pop()
        assert opened == tag

    def handle_data(self, data):
        if data.strip() and self._open[-1][0] != "style":
            self.text.append(data.strip())
            self.texts.setdefault(self._figure() or "", []).append(data.strip())

    def _figure(self):
        return next((figure for _, figure in reversed(self._open) if figure), None)

    def values(self, name):
        return [value for _, attribute, value in self.attributes if attribute == name]

    def drawn(self, figure, group):
        """The path data of a group of a figure, such as ``eclipse``, one for each panel that has it."""
        start = self.source.index(f'<figure id="{figure}"')
        figure_text = self.source[start : self.source.index("</figure>", start)]
        return re.findall(rf'<g class="{group}">\s*<path d="([^"]*)"', figure_text)


@dataclass
class Run:
    """A flight made up: a libration that decays, an estimate a little off, pulses as they are given."""

    ticks: int = 7000
    pulses: tuple[Pulse, ...] = tuple(
        Pulse(i % 3, (-3, -2, -1, 1, 2, 3)[i % 6], Fraction(100 + 110 * i), Fraction(103 + 110 * i))
        for i in range(12)
    )
    violations: tuple[Violation, ...] = ()
    notes: tuple[str, ...] = ()
    limits: AuditLimits = field(default_factory=AuditLimits)
    complete: bool = True
    refused: int = 0
    replay: dict[str, object] | None = field(
        default_factory=lambda: {"bit_exact": True, "command_exact": True}
    )
    scenario: Scenario = field(default_factory=lambda: load("microsat"))
    events: list[dict[str, object]] = field(default_factory=list)

    def truth(self) -> Histories:
        t = np.arange(self.ticks, dtype=float)
        half = np.radians(20.0) * np.exp(-t / 3000.0)
        noise = np.random.default_rng(1).standard_normal((self.ticks, 3))
        axis = np.array([0.6, 0.0, 0.8])
        return {
            "t_s": t,
            "q_body_from_orbit": np.hstack((np.cos(half)[:, None], np.sin(half)[:, None] * axis)),
            "omega_body_orbit_radps": 1e-4 * noise,
            "b_body_t": 3e-5 * np.stack((np.cos(t / 960.0), np.sin(t / 960.0), 0.0 * t), axis=1),
            "sun_body": np.tile([1.0, 0.0, 0.0], (self.ticks, 1)),
            "lit": np.where((t >= 1000.0) & (t < 3000.0), 0.0, 1.0),
            "m_body_am2": np.where(np.abs(noise) > 2.0, 8.0 * np.sign(noise), 0.0),
            "r_eci_m": np.tile([7.1e6, 0.0, 0.0], (self.ticks, 1)),
            "torque_body_nm/gravity_gradient": 1e-7 * noise,
            "torque_body_nm/coils": np.where(np.abs(noise) > 2.0, 1e-4, 0.0),
            "torque_body_nm/residual_dipole": np.zeros((self.ticks, 3)),
        }

    def estimates(self) -> Estimates:
        truth = self.truth()
        normal = np.tile([0.0, 0.0, 1.04e-3], (self.ticks, 1))
        return Estimates(
            q_body_from_orbit=truth["q_body_from_orbit"],
            omega_body_orbit_radps=truth["omega_body_orbit_radps"],
            omega_body_radps=truth["omega_body_orbit_radps"] + normal,
            covariance=np.tile(np.diag([1e-6] * 3 + [1e-10] * 3), (self.ticks, 1, 1)),
            valid=np.ones(self.ticks, dtype=bool),
            mode=np.where(np.arange(self.ticks) < self.ticks // 2, Mode.ACQUIRE, Mode.POINT),
        )

    def audit(self) -> AuditReport:
        return AuditReport(
            limits=self.limits,
            pulses=self.pulses,
            violations=self.violations,
            notes=self.notes,
            statuses=self.ticks,
            span_s=Fraction(max(self.ticks - 1, 0)),
            truncated_at=None,
            complete=self.complete,
        )

    def flown(self, **truth: np.ndarray) -> Flown:
        return Flown.of(self.scenario, self.truth() | truth, self.estimates(), self.audit())

    def write(self, path: Path, estimates: Estimates | None = None, **truth: np.ndarray) -> Page:
        histories = self.truth() | truth
        estimates = estimates or self.estimates()
        tally = BusTally(0, self.refused, self.events)
        summary = summarise(self.scenario, {"seed": 7}, histories, estimates, self.audit(), tally)
        if self.replay is not None:
            summary["replay"] = self.replay
        write_report(path / "report.html", self.scenario, summary, histories, estimates, self.audit())
        return Page((path / "report.html").read_text(encoding="utf-8"))


# --- a whole flight


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    return Run().write(tmp_path_factory.mktemp("run"))


def test_the_page_needs_nothing_but_itself(page):
    assert not {"script", "link", "iframe", "object", "embed", "img", "image", "base", "form"} & set(
        page.tags
    )
    assert not [name for _, name, _ in page.attributes if name.startswith("on")]
    for name in ("src", "href", "xlink:href", "action", "data", "srcset"):
        assert [value for value in page.values(name) if not value.startswith("#")] == []
    assert set(re.findall(r"url\(\s*(.)", page.source)) == {"#"}
    for word in ("@import", "@font-face", "://", "<!DOCTYPE svg", "<?xml"):
        assert word not in page.source


def test_ids_are_unique_and_every_reference_finds_its_own(page):
    ids = page.values("id")
    assert len(ids) == len(set(ids))
    referred = [value[1:] for value in page.values("xlink:href") + page.values("href")]
    referred += re.findall(r"url\(#([^)]*)\)", page.source)
    assert referred
    assert set(referred) <= set(ids)


@pytest.mark.parametrize("chart", CHARTS)
def test_every_chart_is_there_with_its_labels(page, chart):
    assert chart in page.values("id")
    for word in CHARTS[chart]:
        assert word in page.texts[chart]
    assert len(page.paths[chart]) > 5


def test_time_runs_in_orbits_under_every_chart_of_the_whole_flight(page):
    for chart in set(CHARTS) - {"chart-zoom", "chart-gaps_and_levels"}:
        assert "orbits of 100.7 min" in page.texts[chart]
    assert "minutes from the start" in page.texts["chart-zoom"]


def test_no_number_that_is_none_gets_into_a_chart(page):
    drawn = " ".join(path for paths in page.paths.values() for path in paths)
    assert re.search(r"[^MLCQzZ\s\d.\-]", drawn) is None


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


def test_key_figures_are_those_of_the_summary(page):
    text = " ".join(page.text)
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


def test_bus_and_versions_come_from_the_run_beside_the_report(tmp_path):
    write_run(tmp_path, flown={"ticks": 7000})
    page = Run().write(tmp_path)
    assert "seed 7 · bus loop, lockstep · 7000 ticks, 7000 s · torquer 4.5.6" in page.text
    facts = ("torquer 4.5.6", "scenario f00df00df00d", "flight table 0badcafe")
    assert " · ".join((*facts, "Python 3.11.7, numpy 2.0.0", "Linux x86_64")) in page.text
    assert not [words for words in page.text if "incomplete" in words]


def test_the_same_flight_gives_the_same_bytes_whatever_the_user_set_matplotlib_to(tmp_path):
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    one = Run().write(tmp_path / "one")
    with matplotlib.rc_context({"font.size": 30.0, "svg.fonttype": "path", "axes.facecolor": "black"}):
        two = Run().write(tmp_path / "two")
        assert matplotlib.rcParams["font.size"] == 30.0
    assert one.source == two.source


# --- what the charts show


def spans_on(path, axis_of):
    """The bands of a path as fractions of the widest path of the figure, the time axis."""
    left, right = axis_of
    xs = [float(x) for x in re.findall(r"[ML] (-?[\d.]+) ", path)]
    bands = [(min(xs[i : i + 4]), max(xs[i : i + 4])) for i in range(0, len(xs), 4)]
    return [((a - left) / (right - left), (b - left) / (right - left)) for a, b in bands]


def time_axis(page, figure):
    """Left and right edge of the panels, from the rectangles that clip them."""
    start = page.source.index(f'<figure id="{figure}"')
    figure_text = page.source[start : page.source.index("</figure>", start)]
    x, width = re.search(r'<rect x="([\d.]+)" y="[\d.]+" width="([\d.]+)"', figure_text).groups()
    return float(x), float(x) + float(width)


@pytest.mark.parametrize("chart", sorted(set(CHARTS) - {"chart-zoom", "chart-gaps_and_levels"}))
def test_eclipses_are_shaded_in_every_chart_of_the_whole_flight(page, chart):
    bands = page.drawn(chart, "eclipse")
    assert bands
    for band in bands:
        shown = spans_on(band, time_axis(page, chart))
        assert shown == [pytest.approx((1000 / 7000, 3000 / 7000), abs=1e-4)]


@pytest.mark.parametrize(("lit", "dark"), [(0.0, True), (0.49, True), (0.5, False), (1.0, False)])
def test_an_eclipse_is_where_less_than_half_of_the_sun_is_seen(lit, dark):
    history = np.ones(200)
    history[50:80] = lit
    assert Run(ticks=200).flown(lit=history).time.eclipses == (((50.0, 80.0),) if dark else ())


def test_a_flight_in_sunlight_has_no_bands(tmp_path):
    page = Run(ticks=300, pulses=()).write(tmp_path, lit=np.ones(300))
    assert 'class="eclipse"' not in page.source


def test_every_pulse_is_a_bar_up_or_down_by_its_polarity(page):
    for coil in (0, 1, 2):
        (bars,) = page.drawn("chart-raster", f"pulses-{coil}")
        ends = [
            (float(foot), float(tip))
            for foot, tip in re.findall(r"M [\d.]+ ([\d.]+)\s+L [\d.]+ ([\d.]+)", bars)
        ]
        levels = [pulse.level for pulse in Run().pulses if pulse.coil == coil]
        assert len({foot for foot, _ in ends}) == 1
        assert [np.sign(foot - tip) for foot, tip in ends] == list(np.sign(levels))
        heights = np.array([abs(foot - tip) for foot, tip in ends])
        assert heights / np.abs(levels) == pytest.approx(heights[0] / abs(levels[0]), rel=2e-2)


def test_the_zoom_shows_pulses_to_scale_and_the_backoff_after_each(tmp_path):
    pulses = (Pulse(0, 1, Fraction(100), Fraction(103)), Pulse(2, -2, Fraction(250), Fraction("251.5")))
    page = Run(ticks=600, pulses=pulses).write(tmp_path)
    axis = time_axis(page, "chart-zoom")
    (bar,) = page.drawn("chart-zoom", "pulses-0")
    assert spans_on(bar, axis) == [pytest.approx((100 / 600, 103 / 600), abs=1e-4)]
    assert page.drawn("chart-zoom", "pulses-1") == []
    lanes = page.drawn("chart-zoom", "backoff")
    assert len(lanes) == 3
    for lane in lanes:
        backoffs = [(103 / 600, 203 / 600), (251.5 / 600, 351.5 / 600)]
        assert spans_on(lane, axis) == [pytest.approx(span, abs=1e-4) for span in backoffs]
    assert {"3 s", "1.5 s"} <= set(page.texts["chart-zoom"])


def test_a_backoff_of_each_coil_shades_the_lane_of_that_coil_alone(tmp_path):
    pulses = (Pulse(0, 1, Fraction(100), Fraction(103)), Pulse(2, 1, Fraction(103), Fraction(106)))
    page = Run(ticks=600, pulses=pulses, limits=AuditLimits(shared=False)).write(tmp_path)
    shaded = [spans_on(lane, time_axis(page, "chart-zoom")) for lane in page.drawn("chart-zoom", "backoff")]
    assert shaded == [
        [pytest.approx((103 / 600, 203 / 600), abs=1e-4)],
        [pytest.approx((106 / 600, 206 / 600), abs=1e-4)],
    ]
    assert "2.91 %: limit of each coil" in page.texts["chart-duty"]
    assert "gap to the next pulse of the same coil [s]" in page.texts["chart-gaps_and_levels"]


def test_a_zoom_is_where_most_pulses_are():
    rare = [Pulse(0, 1, Fraction(100 + 900 * i), Fraction(103 + 900 * i)) for i in range(4)]
    dense = [Pulse(1, 1, Fraction(4000 + 103 * i), Fraction(4003 + 103 * i)) for i in range(10)]
    flown = Run(pulses=(*rare, *dense)).flown()
    begin = flown.busiest(1200.0)
    assert begin <= 4000.0
    assert begin + 1200.0 >= 4000.0 + 9 * 103.0 + 3.0


def test_duty_is_taken_over_one_orbit_and_over_less_at_the_beginning():
    pulses = tuple(Pulse(1, 1, Fraction(103 * i + 100), Fraction(103 * i + 103)) for i in range(60))
    flown = Run(ticks=20000, pulses=pulses).flown()
    at_s = np.array([50.0, 103.0, 6180.0, 6180.0 + flown.orbit_s])
    duty = flown.duty(1, at_s)
    assert duty[0] == 0.0
    assert duty[1] == pytest.approx(3.0 / 103.0)
    assert duty[2] == pytest.approx(3.0 / 103.0, rel=0.03)
    assert duty[3] == 0.0
    assert not flown.duty(0, at_s).any()


def test_gaps_are_those_the_limit_speaks_of():
    pulses = tuple(Pulse(c, 1, Fraction(s), Fraction(s + 3)) for c, s in ((0, 100), (1, 203), (0, 400)))
    assert Run(pulses=pulses).flown().gaps_s().tolist() == [100.0, 194.0]
    each = Run(pulses=pulses, limits=AuditLimits(shared=False)).flown()
    assert each.gaps_s().tolist() == [297.0]


def test_the_rate_error_is_that_of_the_inertial_rate():
    run = Run(ticks=50)
    q = np.tile([1.0, 0.0, 0.0, 0.0], (50, 1))
    off = replace(run.estimates(), q_body_from_orbit=q, omega_body_radps=np.tile([0.0, 0.0, 1.0e-3], (50, 1)))
    off.omega_body_orbit_radps[:] = 0.0
    still = {"q_body_from_orbit": q, "omega_body_orbit_radps": np.tile([2e-5, 0.0, 0.0], (50, 1))}
    flown = Flown.of(run.scenario, run.truth() | still, off, run.audit())
    assert flown.rate_error_degps == pytest.approx(np.degrees(2e-5))


def test_three_sigma_is_thrice_the_root_of_the_trace():
    flown = Run(ticks=5).flown()
    assert flown.sigma3_deg(0) == pytest.approx(np.degrees(3.0 * np.sqrt(3e-6)))
    assert flown.sigma3_deg(3) == pytest.approx(np.degrees(3.0 * np.sqrt(3e-10)))


def test_a_torque_that_never_acts_is_left_out(page):
    assert "residual dipole" not in page.texts["chart-torques"]


def test_an_envelope_keeps_every_extreme_and_passes_over_gaps():
    t = np.arange(100_000, dtype=float)
    y = np.sin(t / 7000.0)
    y[54_321], y[77_777] = 9.0, -9.0
    y[20_000:40_000] = np.nan
    x, drawn = envelope(t, y)
    assert len(x) == len(drawn) == 2 * BINS
    assert (np.diff(x) >= 0.0).all()
    assert (np.nanmax(drawn), np.nanmin(drawn)) == (9.0, -9.0)
    assert np.isnan(drawn[(x > 20_200) & (x < 39_800)]).all()
    assert np.isfinite(drawn[(x < 19_800) | (x > 40_200)]).all()


def test_a_short_history_is_drawn_as_it_is():
    t, y = np.arange(500.0), np.random.default_rng(3).standard_normal(500)
    x, drawn = envelope(t, y)
    assert (x == t).all()
    assert (drawn == y).all()


# --- flights that went wrong, or hardly went


def test_broken_limits_are_named_and_marked(tmp_path):
    broken = Violation(Kind.GAP, Fraction("210.5"), 210, 1, 999, "starts 99.9 s after <coil 0>")
    page = Run(violations=(broken,), notes=("the log has 2 boots",)).write(tmp_path)
    assert "✗ limits broken: 1" in page.text
    assert "✓ limits kept" not in page.text
    for words in ("210.500", "gap", "starts 99.9 s after <coil 0>", "the log has 2 boots"):
        assert words in page.text
    assert "limit broken" in page.texts["chart-raster"]


def test_thousands_of_broken_limits_do_not_drown_the_page(tmp_path):
    many = tuple(Violation(Kind.PULSE, Fraction(i), i, 0, i, "too long") for i in range(5000))
    page = Run(violations=many).write(tmp_path)
    assert "✗ limits broken: 5000" in page.text
    assert "and 4950 more" in page.text
    assert len(page.source) < 1_500_000


@pytest.mark.parametrize(
    ("replay", "words"),
    [
        (None, "not replayed"),
        ({"bit_exact": False, "command_exact": True}, "! replay command-exact only"),
        ({"bit_exact": False, "command_exact": False}, "✗ replay differs"),
    ],
)
def test_a_replay_that_differs_is_not_called_exact(tmp_path, replay, words):
    page = Run(ticks=20, pulses=(), replay=replay).write(tmp_path)
    assert words in page.text
    assert "✓ replay bit-exact" not in page.text


def test_refusals_are_counted(tmp_path):
    page = Run(ticks=20, pulses=(), refused=3).write(tmp_path)
    assert "! 3 refused" in page.text


def test_an_unfinished_flight_is_called_so(tmp_path):
    write_run(tmp_path, ticks=18124)
    page = Run(complete=False).write(tmp_path)
    assert "✗ incomplete: 7000 of 18124 ticks" in page.text


def test_a_log_without_its_end_is_incomplete_though_nothing_else_is_known(tmp_path):
    page = Run(ticks=20, pulses=(), complete=False).write(tmp_path)
    assert "✗ incomplete: 20 ticks" in page.text


@pytest.mark.parametrize("ticks", [1, 2, 3, 10])
@pytest.mark.filterwarnings("error")
def test_a_very_short_flight_has_a_report(tmp_path, ticks):
    page = Run(ticks=ticks, pulses=()).write(tmp_path)
    assert "seconds from the start" in page.texts["chart-pointing"]
    assert "No coil was driven." in page.text


@pytest.mark.filterwarnings("error")
def test_a_flight_with_one_pulse_has_all_charts(tmp_path):
    page = Run(ticks=110, pulses=(Pulse(0, 3, Fraction(100), Fraction(103)),)).write(tmp_path)
    assert set(CHARTS) <= set(page.values("id"))


@pytest.mark.filterwarnings("error")
def test_a_flight_of_no_tick_says_so(tmp_path):
    page = Run(ticks=0, pulses=(), complete=False).write(tmp_path)
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


@pytest.mark.filterwarnings("error")
def test_perfect_knowledge_has_no_estimate_to_show(tmp_path):
    run = Run(scenario=load("microsat", {"knowledge": "perfect"}))
    page = run.write(tmp_path, unknown(run.estimates()))
    assert "Flown with perfect knowledge: the plant told the controller attitude and rate." in page.text
    assert set(CHARTS) - {"chart-estimate"} <= set(page.values("id"))
    assert "chart-estimate" not in page.values("id")


def test_a_filter_that_never_started_is_not_called_perfect_knowledge(tmp_path):
    run = Run(ticks=20, pulses=())
    blind = replace(unknown(run.estimates()), q_body_from_orbit=np.full((20, 4), np.nan))
    page = run.write(tmp_path, blind)
    assert "The filter gave no estimate in this flight." in page.text


@pytest.mark.filterwarnings("error")
def test_an_estimate_that_comes_late_is_drawn_from_there(tmp_path):
    run = Run()
    late = run.estimates()
    late.covariance[:3000] = np.nan
    late.omega_body_radps[:3000] = np.nan
    late.q_body_from_orbit[:3000] = np.nan
    page = run.write(tmp_path, late)
    assert "nan" not in " ".join(page.paths["chart-estimate"])
    assert "true error" in page.texts["chart-estimate"]


def test_whatever_a_scenario_is_called_stays_text(tmp_path):
    name, summary = "</title><script>alert(1)</script>", "<img src=x onerror=\"x\"> & 'so on'"
    scenario = load("microsat").model_copy(update={"name": name, "summary": summary})
    event = {"t_s": 1.0, "node": "<i>COIL</i>", "event": 9, "severity": 99, "argument": 0}
    page = Run(ticks=20, pulses=(), scenario=scenario, events=[event]).write(tmp_path)
    assert {name, summary, "<i>COIL</i>"} <= set(page.text)
    assert not {"script", "img", "i"} & set(page.tags)


def test_events_are_told_in_words(tmp_path):
    events = [
        {"t_s": 91.0, "node": "FSW", "event": 1, "severity": 0, "argument": 2},
        {"t_s": 95.5, "node": "COIL", "event": 200, "severity": 2, "argument": 4},
    ]
    page = Run(ticks=20, pulses=(), events=events).write(tmp_path)
    assert "91.000 FSW info mode ACQUIRE 95.500 COIL error event 200 (4)" in " ".join(page.text)


# --- size and time


def test_a_hundred_orbits_stay_small(tmp_path):
    pulses = tuple(
        Pulse(i % 3, (-3, -2, -1, 1, 2, 3)[i * 7 % 6], Fraction(103 * i + 100), Fraction(103 * i + 103))
        for i in range(5800)
    )
    run = Run(ticks=600_000, pulses=pulses)
    noise = np.random.default_rng(5).standard_normal((600_000, 3))
    lit = (np.arange(600_000) % 6041 > 2000).astype(float)
    chatter = replace(run.estimates(), mode=np.arange(600_000) // 30 % 4)
    started = time.perf_counter()
    page = run.write(tmp_path, chatter, omega_body_orbit_radps=1e-4 * noise, lit=lit)
    assert time.perf_counter() - started < 30.0
    assert len(page.source.encode()) < 1_500_000
    assert set(CHARTS) <= set(page.values("id"))
    (bands,) = page.drawn("chart-pointing", "eclipse")
    assert bands.count("M") == 100


def test_who_draws_nothing_does_not_wait_for_matplotlib():
    code = (
        "import sys, sim.report.page\n"
        "assert not [name for name in sys.modules if name.startswith('matplotlib')]\n"
        "import sim.report.sections\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
