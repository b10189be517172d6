"""What the charts of the report draw: eclipses, pulses and back-offs, each where it was."""

import re
from fractions import Fraction

import numpy as np
import pytest

from sim.audit.auditor import AuditLimits
from sim.audit.findings import DrivenPulse

CHARTS = {
    "chart-pointing": ["Pointing error", "pointing error [deg]", "axis 1 from the vertical"],
    "chart-modes": ["Mode", "SAFE", "DETUMBLE", "ACQUIRE", "POINT"],
    "chart-rates": ["relative rate [mdeg/s]", "axis 1", "axis 2", "axis 3"],
    "chart-estimate": ["attitude error [deg]", "rate error [mdeg/s]", "true error", "3σ of the filter"],
    "chart-raster": ["coil 0", "coil 1", "coil 2", "+3", "-3"],
    "chart-zoom": ["coil 0", "coil 1", "coil 2", "3 s"],
    "chart-duty": ["duty [%]", "2.91 %: limit of all coils"],
    "chart-gaps_and_levels": ["gap to the next pulse [s]", "100 s back-off", "level"],
    "chart-field_and_dipole": ["field [µT]", "dipole [A m²]"],
    "chart-torques": ["torque [µN m]", "gravity gradient", "coils, mean of 10 min"],
}
"""The figures, and words that each of them must hold."""


@pytest.mark.long
@pytest.mark.parametrize("chart", CHARTS)
def test_every_chart_is_there_with_its_labels(page, chart):
    assert chart in page.values("id")
    for word in CHARTS[chart]:
        assert word in page.texts[chart]
    assert len(page.paths[chart]) > 5


@pytest.mark.long
def test_time_runs_in_orbits_under_every_chart_of_the_whole_flight(page):
    for chart in set(CHARTS) - {"chart-zoom", "chart-gaps_and_levels"}:
        assert "orbits of 100.7 min" in page.texts[chart]
    assert "minutes from the start" in page.texts["chart-zoom"]


def test_no_number_that_is_none_gets_into_a_chart(page):
    drawn = " ".join(path for paths in page.paths.values() for path in paths)
    assert re.search(r"[^MLCQzZ\s\d.\-]", drawn) is None


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
    figure_text = page.source[start : page.source.index("</figure>", start)].partition('class="narrow"')[0]
    x, width = re.search(r'<rect x="([\d.]+)" y="[\d.]+" width="([\d.]+)"', figure_text).groups()
    return float(x), float(x) + float(width)


@pytest.mark.parametrize("chart", sorted(set(CHARTS) - {"chart-zoom", "chart-gaps_and_levels"}))
def test_eclipses_are_shaded_in_every_chart_of_the_whole_flight(page, chart):
    bands = page.drawn(chart, "eclipse")
    assert bands
    for band in bands:
        shown = spans_on(band, time_axis(page, chart))
        assert shown == [pytest.approx((1000 / 7000, 3000 / 7000), abs=1e-4)]


@pytest.mark.long
def test_a_flight_in_sunlight_has_no_bands(tmp_path, made_run):
    page = made_run(ticks=300, pulses=()).write(tmp_path, lit=np.ones(300))
    assert 'class="eclipse"' not in page.source


def test_every_pulse_is_a_bar_up_or_down_by_its_polarity(page, made_run):
    for coil in (0, 1, 2):
        (bars,) = page.drawn("chart-raster", f"pulses-{coil}")
        ends = [
            (float(foot), float(tip))
            for foot, tip in re.findall(r"M [\d.]+ ([\d.]+)\s+L [\d.]+ ([\d.]+)", bars)
        ]
        levels = [pulse.level for pulse in made_run().pulses if pulse.coil == coil]
        assert len({foot for foot, _ in ends}) == 1
        assert [np.sign(foot - tip) for foot, tip in ends] == list(np.sign(levels))
        heights = np.array([abs(foot - tip) for foot, tip in ends])
        assert heights / np.abs(levels) == pytest.approx(heights[0] / abs(levels[0]), rel=2e-2)


@pytest.mark.long
def test_the_zoom_shows_pulses_to_scale_and_the_backoff_after_each(tmp_path, made_run):
    pulses = (
        DrivenPulse(0, 1, Fraction(100), Fraction(103)),
        DrivenPulse(2, -2, Fraction(250), Fraction("251.5")),
    )
    page = made_run(ticks=600, pulses=pulses).write(tmp_path)
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


@pytest.mark.long
def test_a_backoff_of_each_coil_shades_the_lane_of_that_coil_alone(tmp_path, made_run):
    pulses = (
        DrivenPulse(0, 1, Fraction(100), Fraction(103)),
        DrivenPulse(2, 1, Fraction(103), Fraction(106)),
    )
    page = made_run(ticks=600, pulses=pulses, limits=AuditLimits(shared=False)).write(tmp_path)
    shaded = [spans_on(lane, time_axis(page, "chart-zoom")) for lane in page.drawn("chart-zoom", "backoff")]
    assert shaded == [
        [pytest.approx((103 / 600, 203 / 600), abs=1e-4)],
        [pytest.approx((106 / 600, 206 / 600), abs=1e-4)],
    ]
    assert "2.91 %: limit of each coil" in page.texts["chart-duty"]
    assert "gap to the next pulse of the same coil [s]" in page.texts["chart-gaps_and_levels"]
