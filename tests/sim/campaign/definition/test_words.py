"""Columns in words: every figure has its own, with its unit; what is drawn has those of its key."""

import pytest

from sim.campaign.definition.columns import NUMBERS, input_cells, input_keys
from sim.campaign.definition.words import FIGURE_WORDS, KINDS, ColumnWords, input_words, percent


def test_every_figure_of_a_run_has_words_of_its_own():
    assert FIGURE_WORDS.keys() == {*NUMBERS}
    assert len({str(words) for words in FIGURE_WORDS.values()}) == len(NUMBERS)


@pytest.mark.parametrize("name", NUMBERS)
def test_no_key_is_left_in_the_words(name):
    found = FIGURE_WORDS[name]
    assert "_" not in found.words
    assert found.kind in KINDS
    for part, unit in (("deg", "deg"), ("degps", "deg/s"), ("radps", "rad/s")):
        if part in name.split("_") and "settle" not in name and "under" not in name and "3sigma" not in name:
            assert found.unit == unit


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("initial.angle_deg", ColumnWords("initial", "initial angle", "deg")),
        (
            "sensors.magnetometer.bias_nt.0",
            ColumnWords("magnetometer", "magnetometer bias, component 1", "nT"),
        ),
        ("body.inertia_kgm2.0.1", ColumnWords("body", "body inertia, component 1.2", "kg m²")),
        (
            "disturbance.residual_dipole_am2.length",
            ColumnWords("disturbance", "disturbance residual dipole, length", "A m²"),
        ),
        (
            "flight.estimator.sun_sigma_deg",
            ColumnWords("onboard table estimator", "onboard table estimator sun sigma", "deg"),
        ),
        ("control.k_w", ColumnWords("control", "control k_w", "N m s/T²")),
        ("knowledge", ColumnWords("scenario", "knowledge")),
    ],
)
def test_a_key_in_words(key, words):
    assert input_words(key) == words


def test_the_unit_stands_in_brackets_where_there_is_one():
    assert str(ColumnWords("", "angle", "deg")) == "angle [deg]"
    assert str(ColumnWords("", "driver")) == "driver"


def test_columns_and_keys_of_what_is_drawn_go_together(small):
    inputs = small.draw(0).inputs
    keys = input_keys(inputs)
    assert keys.keys() == input_cells(inputs).keys()
    assert keys["input_sensors_magnetometer_bias_nt_0"] == "sensors.magnetometer.bias_nt.0"


@pytest.mark.parametrize(
    ("fraction", "words"),
    [(0.95, "95 %"), (0.5, "50 %"), (0.9999999, "99.99999 %"), (0.0500001, "5.00001 %"), (1.0, "100 %")],
)
def test_probabilities_that_differ_have_different_words(fraction, words):
    assert percent(fraction) == words
