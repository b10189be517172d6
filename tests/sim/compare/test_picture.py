"""The picture: every law named, names apart, nothing drawn of what did not fly."""

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from fsw.core.laws.table import LAWS
from sim.compare import picture as drawing
from sim.compare.case import Driver
from sim.compare.picture import picture, spread
from sim.compare.score import History, Result, Score
from sim.drawing.canvas import TimeAxis
from sim.scenario.controlled import Controlled

TIME = TimeAxis("orbits", 6000.0, 0.0, 12000.0, ((1000.0, 3000.0),))
T_S = np.linspace(0.0, 12000.0, 120)
ATTITUDE = Controlled("attitude", "whole attitude", "deg", 5.0)
SPIN = Controlled("spin", "spin rate about axis 1", "deg/s", 0.1)


def result(law, error_deg, driver=Driver.PULSED):
    score = Score(law, LAWS[law].aim, driver, error_rms=error_deg)
    return Result(score, History(TIME, T_S, error_deg + 40.0 * np.exp(-T_S / 900.0)))


@pytest.fixture
def drawn(tmp_path, monkeypatch):
    """Draws results; gives the panels that were saved."""
    saved = []
    save = Figure.savefig

    def keep(figure, *args, **kwargs):
        saved.append(figure)
        save(figure, *args, **kwargs)

    monkeypatch.setattr(Figure, "savefig", keep)

    def draw(results, by=ATTITUDE):
        picture(tmp_path / "x.png", "microsat", results, by)
        return saved[-1].axes if saved else [], tmp_path / "x.png"

    return draw


def names(panel):
    return [text.get_text().split()[0] for text in panel.texts if text.get_text().endswith("°")][1:]


@pytest.mark.long
def test_a_panel_a_driver_with_a_named_line_a_law(drawn):
    results = [result(law, 0.5 + number) for number, law in enumerate(("pd", "lqr", "sliding"))]
    results.append(result("pd", 0.3, Driver.CONTINUOUS))
    results.append(Result(Score("mpc", LAWS["mpc"].aim, Driver.CONTINUOUS, failure="no"), None))
    (pulsed, continuous), path = drawn(results)
    assert sorted(names(pulsed)) == ["lqr", "pd", "sliding"]
    assert names(continuous) == ["pd"]
    assert path.read_bytes().startswith(b"\x89PNG")


def test_names_stand_within_the_picture_however_long(drawn):
    law = max(LAWS, key=len)
    (panel,), _ = drawn([result(law, 123.0)])
    (name,) = [text for text in panel.texts if text.get_text().startswith(law)]
    figure = panel.figure
    assert name.get_window_extent(FigureCanvasAgg(figure).get_renderer()).x1 <= figure.bbox.x1


@pytest.mark.long
def test_spins_are_told_apart_by_their_rate(drawn):
    (panel,), _ = drawn([result("spin_up", 0.02)], SPIN)
    assert panel.get_ylabel() == "error of the spin rate about axis 1 [deg/s]"
    assert any(text.get_text().startswith("spin_up  0.0201 deg/s") for text in panel.texts)
    assert [line.get_ydata()[0] for line in panel.lines if line.get_label() not in LAWS] == [0.1]


@pytest.mark.long
def test_a_law_has_one_colour_and_no_two_look_alike(drawn):
    laws = list(LAWS)
    results = [result(law, 1.0 + n, driver) for driver in Driver for n, law in enumerate(laws)]
    looks = []
    for panel in drawn(results)[0]:
        lines = [line for line in panel.lines if line.get_label() in LAWS]
        looks.append(
            {line.get_label(): (line.get_color(), str(line._unscaled_dash_pattern)) for line in lines}
        )
    assert looks[0] == looks[1]
    assert len(set(looks[0].values())) == len(laws)
    assert len(laws) <= len(drawing.COLOURS) * len(drawing.DASHES)


def test_without_a_flight_there_is_no_picture(drawn):
    panels, path = drawn([Result(Score("pd", LAWS["pd"].aim, Driver.PULSED, failure="no"), None)])
    assert not panels
    assert not path.exists()


def test_names_far_apart_stay_where_they_are():
    assert spread([0.1, 0.5, 0.9], 0.05) == pytest.approx([0.1, 0.5, 0.9])


def test_names_that_crowd_move_apart_about_their_middle():
    assert spread([0.5, 0.5, 0.5], 0.1) == pytest.approx([0.4, 0.5, 0.6])


@pytest.mark.parametrize("heights", [[0.0] * 6, [1.0] * 6, [0.0, 0.01, 0.02, 0.5, 0.98, 0.99, 1.0]])
def test_names_stay_in_the_panel_and_apart(heights):
    places = spread(heights, 0.05)
    assert all(0.0 <= place <= 1.0 for place in places)
    assert np.diff(places).min() >= 0.05 - 1e-12


@pytest.mark.long
def test_the_figure_at_the_end_of_a_line_is_where_it_ends(drawn):
    error = 0.5 + 40.0 * np.exp(-T_S / 6000.0)
    score = Score("pd", LAWS["pd"].aim, Driver.PULSED, error_rms=17.0)
    (panel,), _ = drawn([Result(score, History(TIME, T_S, error))])
    texts = [text.get_text() for text in panel.texts]
    assert f"pd  {error[-1]:.3g}°" in texts
    assert "at the end" in texts
