"""Phasing of a satellite whose coils and magnetometer are both wired wrongly, flown once."""

from dataclasses import replace

import numpy as np
import pytest

from sim.commissioning.calibrate.flown.wiring import RIGHT, channels_from_body
from sim.commissioning.phasing import words
from sim.commissioning.phasing.judge import PhasingPremises, phasing
from sim.record import run_dir
from sim.record.candump import read_log


@pytest.fixture(scope="module")
def found(flown):
    _, samples, table = flown()
    return phasing(samples, table, PhasingPremises())


@pytest.mark.long
def test_both_wirings_are_told(found, wired):
    assert found.wiring == wired


def test_the_verdict_is_in_words(found, flown):
    table = flown()[2]
    assert words.verdict(found, table) == (
        "magnetometer: turned 90 deg about axis 3; coils: coil 1 is along axis -3, coil 2 is along axis +1, "
        "coil 3 is along axis +2"
    )


def test_the_matrices_are_those_of_the_plant_within_their_uncertainty(found, wired):
    channels, coils = wired
    true = channels_from_body(coils).T
    sigma = np.sqrt(found.coils.covariance.diagonal()).reshape(3, 3)
    assert (np.abs(found.coils.matrix - true) < 4.0 * sigma + 0.02).all()
    assert sigma.max() < 0.3
    errors = (1.03, 0.98, 1.01)
    own = np.array([[1500.0, 700.0, -200.0], [-900.0, 2100.0, 400.0], [300.0, -100.0, 1800.0]])
    response = channels_from_body(channels) @ np.diag(errors) @ own @ true
    assert found.response.nt_per_am2 == pytest.approx(response, abs=90.0)
    assert found.response.delay_ticks == pytest.approx(0.6, abs=0.03)


def test_pulses_were_within_the_limits_of_the_scheduler(flown):
    from torquer.api.audit import check

    assert check(flown()[0]).ok


def test_the_wiring_of_the_magnetometer_changes_nothing_but_the_channels(flown, wired):
    """The sequence acts without looking: so a log may stand for all 48."""
    _, turned, _ = flown(ticks=150)
    _, right, _ = flown(channels=RIGHT, ticks=150)
    assert np.array_equal(turned.field_nt, right.field_nt @ channels_from_body(wired[0]).T)
    assert np.array_equal(turned.level, right.level)
    assert np.array_equal(turned.sun, right.sun, equal_nan=True)


def test_in_the_dark_the_wiring_of_the_magnetometer_is_not_told_and_no_verdict_is_wrong(flown, wired):
    _, samples, table = flown()
    dark = phasing(replace(samples, sun=np.full_like(samples.sun, np.nan)), table, PhasingPremises())
    assert dark.wiring is None
    assert wired in dark.pairs
    assert any("Sun" in reason for reason in dark.missing)


@pytest.mark.long
@pytest.mark.slow
def test_a_sun_sensor_that_lies_is_told_as_a_thing_that_no_wiring_explains(flown):
    _, samples, table = flown()
    draw = np.random.default_rng(1)
    sun = draw.normal(size=samples.sun.shape)
    sun /= np.linalg.norm(sun, axis=1)[:, None]
    lost = phasing(replace(samples, sun=sun), table, PhasingPremises())
    assert lost.wiring is None
    assert any("no wiring explains field and Sun" in reason for reason in lost.missing)


def test_at_rest_the_coils_field_tells_the_product_alone(flown, wired):
    _, samples, table = flown()
    own = np.array([[1500.0, 700.0, -200.0], [-900.0, 2100.0, 400.0], [300.0, -100.0, 1800.0]])
    at_rest = phasing(samples, table, PhasingPremises(own, in_orbit=False))
    assert wired in at_rest.pairs
    assert (tuple(-x for x in wired[0]), tuple(-x for x in wired[1])) in at_rest.pairs
    listed = words.lines(at_rest, table)
    assert "cannot be told apart:" in listed
    assert at_rest.wiring is None


def test_a_known_field_without_a_sample_of_it_is_missing_evidence_and_no_contradiction(flown, wired):
    """As in a log in which a coil is on all the time."""
    _, samples, table = flown()
    always = replace(samples, level=np.where(samples.level == 0, 1, samples.level))
    bench = phasing(always, table, PhasingPremises(field_around_nt=np.array([20e3, -15e3, 35e3])))
    assert wired in bench.pairs
    assert any("the field around tells nothing" in reason for reason in bench.missing)


def test_pulses_were_asked_for_by_telecommand(flown):
    from fsw.wire.messages import TcLaw

    folder = flown()[0]
    assert any(entry.frame.can_id == TcLaw.ID for entry in read_log(folder / run_dir.BUS_LOG))
