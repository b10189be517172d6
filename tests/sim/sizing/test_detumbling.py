"""How long a tumble takes: by what it depends on, and against flights."""

import pytest

from sim.campaign.flight import record_scenario
from sim.scenario.schema import load, parse_settings
from sim.sizing.detumbling import detumbling, detumbling_words

TUMBLES = "initial.rate_degps=[3,3,3]"
FREE = ("coils.driver=continuous", "coils.max_dipole_am2=0.05")


def forecast(*settings, name="cubesat6u"):
    return detumbling(load(name, parse_settings(settings)))


def test_it_is_as_long_as_momentum_over_torque():
    found = forecast(TUMBLES)
    heavier = forecast(TUMBLES, "body.inertia_kgm2=[0.102,0.24,0.308]")
    assert heavier.to_slow_s == pytest.approx(2.0 * found.to_slow_s)
    assert forecast(TUMBLES, "coils.levels_am2=[0.02,0.1,1.0]").to_slow_s == pytest.approx(
        0.5 * found.to_slow_s
    )
    faster = forecast("initial.rate_degps=[6,6,6]")
    assert faster.to_slow_s == pytest.approx(
        found.to_slow_s * (faster.rate_degps - 1.0) / (found.rate_degps - 1.0)
    )


def test_the_limits_of_pulses_are_what_takes_long():
    pulsed, each = forecast(TUMBLES), forecast(TUMBLES, "coils.backoff=per_coil")
    assert pulsed.to_slow_s > each.to_slow_s > 10.0 * each.continuous_to_slow_s
    assert pulsed.continuous_to_slow_s == each.continuous_to_slow_s
    free = forecast(TUMBLES, "coils.driver=continuous", "coils.max_dipole_am2=0.5")
    assert free.to_slow_s == pytest.approx(pulsed.continuous_to_slow_s)


def test_a_slow_start_is_taken_for_a_usual_tumble():
    assert forecast("initial.rate_degps=[0.05,0,0]").rate_degps == pytest.approx(17.32, abs=0.01)


def test_it_is_said_in_hours_and_orbits_with_what_would_be_faster():
    words = detumbling_words(forecast(TUMBLES), continuous=False)
    assert words.startswith("from 5.2 deg/s under 1 deg/s in ")
    assert 'without pulse limits, coils.driver = "continuous"' in words
    assert "without" not in detumbling_words(forecast(TUMBLES, *FREE), continuous=True)


@pytest.mark.long
@pytest.mark.parametrize("seed", [31, 32])
@pytest.mark.parametrize(("settings", "orbits"), [(FREE, 1.5), (("coils.backoff=per_coil",), 3.5)])
def test_flights_take_no_more_than_twice_as_long_and_no_less_than_half(settings, orbits, seed):
    scenario = load("cubesat6u", parse_settings((TUMBLES, *settings)))
    flown_s = record_scenario(scenario, seed, orbits).summary()["rate_degps"]["under_1_s"]
    assert 0.5 < flown_s / detumbling(scenario).to_slow_s < 2.0
