"""A satellite that is wired otherwise, and whose table says so, flies as one that is wired right."""

import numpy as np
import pytest

from sim.commissioning.calibrate.flown.wiring import body_from_outputs, channels_from_body
from sim.flight.virtual import fly_virtual
from sim.record import run_dir
from sim.record.pace import Pace
from sim.record.truth import read_truth
from sim.scenario.schema import load

TICKS = 420
COILS, CHANNELS = (-3, 1, 2), (2, -1, 3)
START = {"initial": {"angle_deg": 25.0, "axis": [1.0, -0.4, 0.3], "rate_degps": [0.05, -0.02, 0.03]}}
WIRED = {
    **START,
    "coils": {"wiring": list(COILS)},
    "sensors": {"magnetometer": {"wiring": list(CHANNELS), "bias_nt": [9000.0, -22000.0, 4000.0]}},
}
OFFSET = (channels_from_body(CHANNELS) @ (9000.0, -22000.0, 4000.0)).tolist()
CALIBRATION = {
    "magnetometer": {"offset_nt": OFFSET, "matrix": channels_from_body(CHANNELS).T.tolist()},
    "coils": {"matrix": body_from_outputs(COILS).tolist()},
}


@pytest.fixture(scope="module")
def fly(tmp_path_factory):
    """Histories of the truth of a flight."""

    def histories(settings):
        scenario = load("microsat", settings)
        folder = tmp_path_factory.mktemp("flight") / "run"
        run_dir.begin(folder, scenario, 7, TICKS, "virtual", Pace())
        fly_virtual(folder, scenario, lambda tick: None)
        return read_truth(folder / run_dir.TRUTH)

    return histories


@pytest.fixture(scope="module")
def right(fly):
    return fly(START)


def pulses(histories):
    """(begin, body axis, sign) of each pulse."""
    m = histories["m_body_am2"]
    on = np.abs(m).max(axis=1) > 0.4
    begins = np.flatnonzero(on & ~np.roll(on, 1))
    return [
        (int(k), int(np.argmax(np.abs(m[k]))), float(np.sign(m[k][np.argmax(np.abs(m[k]))]))) for k in begins
    ]


def wired(coils):
    """The settings of a satellite whose coils are wired so, and whose table says it."""
    calibration = {**CALIBRATION, "coils": {"matrix": body_from_outputs(coils).tolist()}}
    return {**WIRED, "coils": {"wiring": list(coils)}, "flight": {"calibration": calibration}}


@pytest.mark.long
def test_with_its_calibration_it_fires_and_moves_the_same(fly, right):
    """The outputs keep their places, so that the lockout of each coil is reported in the same ticks."""
    turned = fly(wired((-1, 2, -3)))
    assert len(pulses(right)) >= 2
    assert turned["m_body_am2"] == pytest.approx(right["m_body_am2"], abs=1e-12)
    assert turned["q_body_from_orbit"] == pytest.approx(right["q_body_from_orbit"], abs=1e-9)


@pytest.mark.long
def test_with_coils_in_other_places_each_pulse_is_along_the_axis_that_was_asked_for(fly):
    """The law asks for one after the other, so that nothing depends on when a lockout is reported."""
    flown = pulses(fly({**wired(COILS), "control": {"law": "phasing"}}))
    assert [(axis, sign) for _, axis, sign in flown[:3]] == [(0, 1.0), (1, 1.0), (2, 1.0)]
    unknown = pulses(fly({**WIRED, "control": {"law": "phasing"}}))
    assert [(axis, sign) for _, axis, sign in unknown[:3]] == [(2, -1.0), (0, 1.0), (1, 1.0)]


def test_without_it_it_does_not(fly, right):
    unknown = fly(WIRED)
    assert np.abs(unknown["m_body_am2"] - right["m_body_am2"]).max() > 1.0


@pytest.mark.long
def test_a_coil_of_half_the_gain_is_reckoned_with(fly, right):
    """Its pulses turn the body half as far, and the table knows: more is asked of it, or of others."""
    half = {"coils": {"matrix": [[1.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 1.0]]}}
    scale = {**START, "coils": {"dipole_scale": [1.0, 0.5, 1.0]}}
    known, unknown = fly({**scale, "flight": {"calibration": half}}), fly(scale)
    assert np.isfinite(known["q_body_from_orbit"]).all()
    assert pulses(known)[0] != pulses(unknown)[0] or not np.array_equal(
        known["m_body_am2"], unknown["m_body_am2"]
    )
