"""``run.plot`` and ``torquer.report(figures=...)``: the figures of a run for papers."""

import re
import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np
import pytest

import torquer
from sim.report.paper import FIGURES

LABELS = {
    "pointing": "pointing error [deg]",
    "rates": "relative rate [mdeg/s]",
    "rate_magnitude": "relative rate [mdeg/s]",
    "dipoles": "dipole [A m²]",
    "field": "field [µT]",
    "torques": "torque [µN m]",
}
"""The ordinates of those that have a unit."""


@pytest.fixture(autouse=True)
def closed():
    plt.close("all")
    yield
    plt.close("all")


@pytest.mark.parametrize("name", [*LABELS, "pulses", "modes"])
def test_a_figure_is_a_column_wide_and_says_its_units(flown, name):
    axes = getattr(flown.plot, name)()
    assert axes.figure.get_figwidth() == 3.5
    assert axes.get_xlabel() == "time [min]"
    assert axes.get_ylabel() == LABELS.get(name, "")
    assert axes.get_title() == ""
    axes.figure.draw_without_rendering()


@pytest.mark.parametrize(
    ("of", "label"), [("attitude", "attitude error [deg]"), ("rate", "rate error [mdeg/s]")]
)
def test_errors_of_the_estimate_stand_beside_what_the_filter_expects(flown, of, label):
    axes = flown.plot.estimate_errors(of)
    error, sigma3 = axes.get_lines()[:2]
    assert (error.get_label(), sigma3.get_label(), axes.get_ylabel()) == (
        "true error",
        "3σ of the filter",
        label,
    )
    assert len(error.get_ydata()) == flown.summary["ticks"]


def test_lines_are_the_histories_of_the_run(flown):
    whole = flown.plot.pointing().get_lines()[1]
    assert whole.get_label() == "whole attitude"
    np.testing.assert_allclose(whole.get_ydata(), flown.truth.pointing_deg)
    np.testing.assert_allclose(60.0 * whole.get_xdata(), flown.truth.time)
    along = flown.plot.dipoles().get_lines()
    np.testing.assert_allclose([line.get_ydata() for line in along], flown.truth.m_body_am2.T)


def test_it_is_drawn_on_axes_that_are_given_in_their_look(flown):
    before = dict(plt.rcParams)
    figure, (above, below) = plt.subplots(2, 1, sharex=True)
    assert flown.plot.pointing(ax=above) is above
    assert flown.plot.rates(ax=below) is below
    assert (above.get_xlabel(), below.get_xlabel()) == ("", "time [min]")
    assert above.yaxis.label.get_fontsize() == plt.rcParams["font.size"]
    assert dict(plt.rcParams) == before
    assert plt.get_fignums() == [figure.number]


def test_a_figure_may_be_as_wide_as_a_page_and_does_not_grow_high(flown):
    figure = flown.plot.pointing(width_in=7.0).figure
    assert figure.get_figwidth() == 7.0
    assert figure.get_figheight() < 3.5


def test_all_are_written_into_the_folder_of_the_run(copy):
    drawn = torquer.report(copy, figures="svg")
    assert [file.name for file in drawn.figures] == [f"{name}.svg" for name in FIGURES]
    assert all(file.parent == copy.path / "figures" for file in drawn.figures)
    texts = [file.read_text() for file in drawn.figures]
    assert all(text.startswith("<?xml") and "<svg" in text for text in texts)
    assert not any(re.search(r"<dc:date>|20\d\d-\d\d-\d\d", text) for text in texts)
    assert torquer.report(copy).figures == ()


@pytest.mark.long
@pytest.mark.parametrize("kind", ["pdf", "svg"])
@pytest.mark.slow
def test_another_process_writes_the_same_bytes(copy, kind):
    files = torquer.report(copy, figures=kind).figures
    before = [file.read_bytes() for file in files]
    code = f"import torquer; torquer.report({str(copy.path)!r}, figures={kind!r})"
    subprocess.run([sys.executable, "-c", code], check=True)
    assert [file.read_bytes() for file in files] == before
    assert not any(b"CreationDate" in content for content in before)


@pytest.mark.long
@pytest.mark.slow
def test_what_a_flight_has_not_is_left_out_and_said_where_it_is_asked_for(tmp_path):
    run = torquer.fly("posat1", orbits=0.01, out=tmp_path / "run")
    names = {file.stem for file in torquer.report(run, figures="pdf").figures}
    assert names == set(FIGURES) - {"attitude_error", "rate_error", "pulses"}
    with pytest.raises(torquer.InputError, match="the flight software had no estimate"):
        run.plot.estimate_errors()
    with pytest.raises(torquer.InputError, match="no pulse was fired"):
        run.plot.pulses()
    assert plt.get_fignums() == []


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda run: run.plot.pointing(width_in=0.0), "plot.pointing: width_in"),
        (lambda run: run.plot.estimate_errors("position"), "allowed is 'attitude' or 'rate'"),
        (lambda run: torquer.report(run, figures="png"), "report: figures = 'png' is not allowed"),
    ],
)
def test_a_wrong_argument_is_one_sentence(copy, call, sentence):
    with pytest.raises(torquer.InputError, match=sentence) as caught:
        call(copy)
    assert "\n" not in str(caught.value)
    assert not (copy.path / "figures").exists()
