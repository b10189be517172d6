"""What is written in the pictures can be read: no number and no title runs into the next."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from sim.campaign.definition.campaign import IndexLimits
from sim.campaign.definition.words import input_words
from sim.campaign.report import pictures
from sim.drawing.canvas import NARROW_IN, WIDTH_IN, style
from sim.statistics.sensitivity import spearman

LONG = "input_disturbance_residual_dipole_am2_length"


def boxes(texts, renderer):
    shown = [text for text in texts if text.get_visible() and text.get_text()]
    return sorted((text.get_window_extent(renderer) for text in shown), key=lambda box: box.x0)


def rows_of(figure, renderer):
    """The numbers on each abscissa, and the titles of the panels side by side."""
    for panel in figure.axes:
        low, high = panel.get_window_extent(renderer).intervalx
        numbers = [*panel.xaxis.get_ticklabels(), *panel.xaxis.get_ticklabels(minor=True)]
        yield [box for box in boxes(numbers, renderer) if low - 1 <= (box.x0 + box.x1) / 2 <= high + 1]
    rows = {}
    for panel in figure.axes:
        titles = [child for child in panel.get_children() if isinstance(child, Text) and child.get_text()]
        rows.setdefault(round(panel.get_position().y0, 3), []).extend(titles)
    for titles in rows.values():
        yield boxes(titles, renderer)


def assert_readable(draw):
    with style():
        drawn = draw()
        for figure in drawn if isinstance(drawn, list) else [drawn]:
            canvas = FigureCanvasAgg(figure)
            canvas.draw()
            renderer = canvas.get_renderer()
            for row in rows_of(figure, renderer):
                for left, right in pairwise(row):
                    assert left.x1 < right.x0
                assert all(box.x1 <= figure.bbox.x1 + 1 for box in row), "no word runs out of its picture"


@pytest.fixture
def narrow(analysis):
    """The statistics with inputs of long names and small numbers."""
    runs = analysis.done
    inputs = {
        f"{LONG}_{number}": low + np.linspace(0.0, span, runs)
        for number, (low, span) in enumerate([(-0.0075, 0.0125), (1.5, 48.0), (0.001, 0.009), (-2e-5, 5e-5)])
    }
    sensitivities = tuple(
        replace(
            analysis.sensitivities[0],
            column=name,
            correlation=spearman(values, analysis.figures[0].values, 0.9),
        )
        for name, values in inputs.items()
    )
    words = {
        name: input_words(f"disturbance.residual_dipole_am2.{number}") for number, name in enumerate(inputs)
    }
    return replace(analysis, inputs=inputs, sensitivities=sensitivities, input_words=words)


@pytest.mark.long
@pytest.mark.parametrize(("low", "high"), [(0.25, 8.0), (2.0, 3.0), (1e-4, 40.0)])
def test_indices(analysis, low, high):
    profiles = {
        name: np.geomspace(low, high, values.size).reshape(values.shape)
        for name, values in analysis.profiles.items()
    }
    assert_readable(lambda: pictures.indices(replace(analysis, profiles=profiles), 0.95, IndexLimits()))


@pytest.mark.long
@pytest.mark.parametrize("width_in", [WIDTH_IN, NARROW_IN])
def test_titles_of_every_width(campaign_of_40, analysis, width_in):
    assert_readable(lambda: pictures.converging(analysis, campaign_of_40.statistics, width_in))
    assert_readable(lambda: pictures.worst_runs(analysis, width_in))


@pytest.mark.long
def test_inputs_of_long_names_and_small_numbers(narrow):
    assert_readable(lambda: pictures.scatter(narrow))


def test_runs_of_different_lengths_are_compared_at_the_same_times():
    x, errors = pictures.over_time([np.array([4.0, 2.0]), np.full(4, 1.0)], np.array([0.5, 1.0]))
    assert x.tolist() == [0.125, 0.375, 0.625, 0.875]
    assert errors[0, :2].tolist() == [4.0, 2.0]
    assert np.isnan(errors[0, 2:]).all(), "the first run has ended"
    assert errors[1].tolist() == [1.0] * 4


def test_runs_of_one_length_are_shown_as_they_are():
    given = [np.linspace(9.0, 1.0, 7), np.linspace(3.0, 2.0, 7)]
    _, errors = pictures.over_time(given, np.array([3.0, 3.0]))
    assert np.array_equal(errors, given)


@pytest.mark.long
def test_the_worst_runs_are_drawn_where_lengths_differ(analysis):
    errors = {run: values[: 5 + run % 3] for run, values in analysis.errors.items()}
    orbits = np.array([0.01 * len(values) for values in errors.values()])
    assert_readable(lambda: pictures.worst_runs(replace(analysis, errors=errors, orbits=orbits)))
