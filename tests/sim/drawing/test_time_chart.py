"""Charts against time: the picture and the data of the script say the same."""

from base64 import b64decode

import numpy as np
import pytest

from sim.drawing.canvas import INK, TimeAxis, style
from sim.drawing.time_chart import Level, Panel, Series, TimeChart, draw, packed, time_data

TIME = TimeAxis("minutes", 60.0, 0.0, 600.0, ((60.0, 120.04),))


def unpacked(text):
    return np.frombuffer(b64decode(text), "<f4")


def drawn(y, **panel):
    t_s = np.linspace(0.0, 600.0, len(y))
    chart = Panel("Error", "error [deg]", 2.0, (Series("error", np.array(y), INK),), **panel)
    with style():
        return draw(TIME, TimeChart(t_s, (chart,)))


def test_the_data_hold_every_value_and_a_gap_where_there_is_none():
    (panel,) = drawn([1.0, np.nan, 3.0]).data["panels"]
    (series,) = panel["series"]
    assert unpacked(series["y"]) == pytest.approx([1.0, np.nan, 3.0], nan_ok=True)
    assert (panel["title"], panel["label"], series["label"]) == ("Error", "error [deg]", "error")


def test_the_ordinate_of_the_data_is_that_of_the_picture():
    chart = drawn([0.001, 1.0, 100.0], decades=2.0)
    (axes,) = chart.picture.axes
    (panel,) = chart.data["panels"]
    assert panel["decades"] == 2.0
    assert panel["reach"] == list(axes.get_ylim())


def test_nearly_equal_values_are_not_logarithmic():
    (panel,) = drawn([1.0, 1.1, 1.2], decades=2.0).data["panels"]
    assert panel["decades"] is None


def test_levels_are_lines_with_a_label_in_both():
    chart = drawn([1.0, 2.0], levels=(Level(5.0, "5°"),), reach=(0.0, 6.0))
    (panel,) = chart.data["panels"]
    assert [(level["value"], level["label"]) for level in panel["levels"]] == [(5.0, "5°")]
    assert panel["reach"] == [0.0, 6.0]
    labels = [text.get_text() for text in chart.picture.axes[0].get_legend().get_texts()]
    assert labels == ["error", "5°"]


def test_the_time_axis_is_given_once():
    data = time_data(TIME, np.array([0.0, 600.0]), 1_000_000)
    assert data["eclipses"] == [[60.0, 120.0]]
    assert unpacked(data.pop("t_s")).tolist() == [0.0, 600.0]
    assert data | {"eclipses": []} == {
        "label": "minutes", "unit_s": 60.0, "start_unix_s": 1_000_000, "end_s": 600.0, "eclipses": [],
    }  # fmt: skip


def test_numbers_are_packed_little_end_first():
    assert packed(np.array([1.0])) == "AACAPw=="
