"""Coil levels for a satellite."""

import pytest

from sim.design.from_scenario import body_of
from sim.scenario.schema import load, parse_settings
from sim.sizing.expectation import expect, field_across, torque_balance
from sim.sizing.levels import COARSE, FINE, levels_against, levels_for, two_digits


@pytest.mark.parametrize("name", ["microsat", "cubesat3u", "cubesat6u"])
def test_they_are_of_the_size_of_those_that_fly(name):
    chosen = load(name)
    for suggested, flown in zip(levels_for(body_of(chosen), 3.0), chosen.coils.levels_am2, strict=True):
        assert 0.4 < suggested / flown < 2.5


def test_a_pulse_changes_the_rate_by_the_stated_part_of_the_orbital_rate():
    body = body_of(load("cubesat6u"))
    low, _, high = levels_for(body, 3.0)
    impulse = 3.0 * field_across(body) / body.rate_radps
    assert low * impulse / 0.051 == pytest.approx(1.0 / FINE, rel=0.05)
    assert high * impulse / 0.154 == pytest.approx(1.0 / COARSE, rel=0.05)


def test_a_strong_disturbance_asks_for_a_stronger_level():
    disturbed = load("cubesat3u", parse_settings(("disturbance.torque_nm=[2e-8,2e-8,2e-8]",)))
    high = levels_against(disturbed, torque_balance(disturbed).load)[2]
    stronger = load(
        "cubesat3u",
        parse_settings(("disturbance.torque_nm=[2e-8,2e-8,2e-8]", f"coils.levels_am2=[0.003,0.05,{high}]")),
    )
    assert expect(stronger).load == pytest.approx(0.1, rel=0.05)


@pytest.mark.parametrize(("value", "rounded"), [(0.01234, 0.012), (0.0995, 0.1), (123.0, 120.0), (1.0, 1.0)])
def test_two_digits(value, rounded):
    assert two_digits(value) == pytest.approx(rounded)
