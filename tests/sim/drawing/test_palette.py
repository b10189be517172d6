"""Colours of charts that suit a light and a dark page."""

import re

import pytest

from sim.compare.picture import COLOURS
from sim.drawing import canvas
from sim.drawing.palette import DARK, css, themed
from sim.report.charts.over_time import MODE_COLOURS

LINES = {*COLOURS, *MODE_COLOURS.values(), *canvas.AXES_COLOURS, *canvas.MORE_COLOURS, canvas.LIMIT}
PAPER = "#ffffff"


def luminance(colour):
    """Relative luminance of WCAG 2."""
    parts = [int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one, other):
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("colour", sorted({*LINES, canvas.INK, canvas.MUTED, canvas.ECLIPSE}))
def test_every_colour_of_charts_has_a_dark_one(colour):
    assert colour in DARK


@pytest.mark.parametrize("colour", sorted(LINES))
def test_lines_stand_out_on_dark_paper(colour):
    assert contrast(DARK[colour], DARK[PAPER]) > 4.5


@pytest.mark.parametrize("colour", [canvas.INK, canvas.MUTED])
def test_text_is_read_on_both(colour):
    assert contrast(colour, PAPER) > 4.5
    assert contrast(DARK[colour], DARK[PAPER]) > 7.0


def test_known_colours_become_variables_and_others_stay():
    assert themed("fill: #1b2733; stroke: #123456") == "fill: var(--plot-1b2733); stroke: #123456"


def test_every_variable_is_declared():
    assert set(re.findall(r"(--plot-\w+):", css())) == {f"--plot-{colour[1:]}" for colour in DARK}
