"""Figures for papers: what stands over the axes fits in a column."""

import matplotlib.pyplot as plt
import pytest
from matplotlib.figure import Figure

from sim.report.paper import COLUMN_IN, FIGURES, fitting_columns, paper_style


@pytest.mark.parametrize(
    ("lengths", "letters", "columns"),
    [
        ([6, 6, 6, 7], 60.0, 4),
        ([24, 14, 2, 7], 60.0, 3),
        ([24, 14, 2, 7], 45.0, 2),
        ([24, 14, 2, 7], 30.0, 1),
        ([4, 22, 4, 16, 14, 7], 62.0, 2),
        ([100], 20.0, 1),
    ],
)
def test_a_legend_has_the_columns_that_fit(lengths, letters, columns):
    assert fitting_columns(lengths, letters) == columns


@pytest.mark.parametrize("name", FIGURES)
def test_nothing_stands_outside_a_column(made_run, name):
    made = made_run()
    torque = made.truth()["torque_body_nm/gravity_gradient"]
    sources = ("solar_pressure", "drag", "residual_dipole", "bias")
    flight = made.flown(**{f"torque_body_nm/{source}": torque for source in sources})
    before = dict(plt.rcParams)
    with paper_style():
        figure = Figure(figsize=(COLUMN_IN, FIGURES[name].aspect * COLUMN_IN))
        FIGURES[name].draw(figure.subplots(), flight)
        figure.draw_without_rendering()
        reach = figure.get_tightbbox()
    assert reach.x0 >= 0.0
    assert reach.x1 <= COLUMN_IN
    assert dict(plt.rcParams) == before
