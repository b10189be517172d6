"""Gains that no one would choose: refused when the table is read, or flown without an exception."""

from dataclasses import fields

import numpy as np
import pytest

from fsw.core.laws.interface import MAX_GAIN, FieldSample
from fsw.core.laws.table import LAWS
from fsw.input.schema import TableError
from fsw.table.config import flight_config
from fsw.table.table import flight_table

BODY = {"inertia_kgm2": [1.02, 1.85, 1.95], "wheel_nms": [0.0, 0.0, 0.05]}
DRIVEN = {"inertia_kgm2": 2e-4, "max_torque_nm": 2e-3, "max_momentum_nms": 0.12}
OF_DRIVEN_WHEEL = {"two_coils", "wheel_allocation", "pitch_wheel"}
EXTREMES = (0.0, -1.0, 1e15)
OWN_GAINS = [(law, field.name) for law, entry in LAWS.items() if entry.gains for field in fields(entry.gains)]
TICKS = 3


def control(law, **own):
    """The configuration of a table with this law.

    Raises:
        TableError: it is refused.
    """
    driven = {"wheel": DRIVEN, "body": {**BODY, "wheel_nms": [0.0, 0.0, 0.0]}}
    sections = {"body": BODY, "control": {"law": law, **own}} | (driven if law in OF_DRIVEN_WHEEL else {})
    return flight_config(flight_table(sections, "table")).control


def read(law, **own):
    """The same, or the sentence with which it is refused."""
    try:
        return control(law, **own)
    except TableError as error:
        return str(error)


@pytest.fixture
def flown(bench):
    """Flies a law for a few ticks, in both forms."""

    def fly(law, config):
        orbit = bench.Orbit()
        for form in ("acquire", "point"):
            memory = ()
            for tick in range(100, 100 + TICKS):
                inputs = bench.inputs_at(
                    orbit,
                    tick,
                    1.0,
                    np.array([[0.0, 0.6, 0.8], [-1.0, 0.0, 0.0], [0.0, -0.8, 0.6]]),
                    np.array([0.004, -0.003, 0.005]),
                    FieldSample((1.5e-5, -2.6e-5, 3.3e-5), tick=tick - 1),
                    sun_eci=np.array([0.6, 0.0, 0.8]),
                ).replace(ephemeris=bench.model_of(orbit), wait_ticks=(0, 0, 0), wheel_nms=0.05)
                memory = getattr(LAWS[law], form)(inputs, memory, config.setpoint, config).memory

    return fly


@pytest.mark.parametrize("value", EXTREMES)
@pytest.mark.parametrize(("law", "gain"), OWN_GAINS)
def test_a_gain_of_a_law_is_refused_with_a_sentence_or_flown(flown, law, gain, value):
    config = read(law, gains={law: {gain: value}})
    if isinstance(config, str):
        assert f": control: gains.{law}: " in config
    else:
        flown(law, config)


@pytest.mark.parametrize("value", [0.0, MAX_GAIN])
@pytest.mark.parametrize("law", LAWS)
def test_the_gains_of_the_setpoint_are_flown_up_to_their_bound(flown, law, value):
    flown(law, control(law, k_w=value, k_a=value, k_i=value))


@pytest.mark.parametrize("gain", ["k_w", "k_a", "k_i"])
@pytest.mark.parametrize("value", [-1.0, 1e15])
def test_beyond_it_they_are_refused(gain, value):
    with pytest.raises(TableError, match=rf"control\.{gain} = "):
        control("pd", **{gain: value})


@pytest.mark.parametrize(
    ("law", "gain", "value"),
    [
        ("sliding", "reach", 0.0),
        ("sliding_integral", "reach", 0.0),
        ("sliding_integral", "reach", -1.0),
        ("sliding", "slope", 0.0),
        ("sliding", "slope", -0.5),
        ("sliding_integral", "slope", -0.5),
        ("output_feedback", "bandwidth_radps", -1.0),
        ("output_feedback", "bandwidth_radps", 1e15),
        ("sphere_output", "bandwidth_radps", 1e15),
    ],
)
def test_what_a_law_cannot_fly_with_is_refused(law, gain, value):
    with pytest.raises(TableError, match=f"{law}: {gain} must be"):
        control(law, gains={law: {gain: value}})


@pytest.mark.parametrize(
    ("law", "gain"),
    [
        ("bdot_switched", "below_radps"),
        ("bdot_switched", "factor"),
        ("field_tracking_pd", "share_w"),
        ("field_tracking_pd", "share_a"),
        ("reorientation", "k_h"),
        ("target_precession", "k_h"),
        ("three_term", "k_h"),
        ("three_term", "k_spin"),
        ("sliding_integral", "integral"),
        ("sliding_integral", "lost"),
        ("dual_spin", "stiffness"),
        ("nmpc_reference", "steepness"),
    ],
)
def test_a_gain_that_would_drive_the_satellite_away_is_refused(law, gain):
    with pytest.raises(TableError, match=rf"{law}: .*{gain}\b.* must"):
        control(law, gains={law: {gain: -0.5}})


def test_a_gain_that_a_law_does_not_use_is_no_key():
    with pytest.raises(TableError, match="k_h"):
        control("spin_relay", gains={"spin_relay": {"k_h": 1e6}})
