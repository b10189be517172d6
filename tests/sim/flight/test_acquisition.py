"""A satellite whose coils are weak beside its gains or a torque is caught, and does not tumble on."""

import pytest

from fsw.input.schema import merge
from fsw.wire.messages import Mode
from sim.campaign import population
from sim.campaign.flight import record_scenario
from sim.scenario.schema import load, parse_settings


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("seed", [11, 13, 905])
def test_a_6u_turned_by_40_deg_points_within_two_orbits(seed):
    """Without a limit by what the coils give it tumbles on for three orbits and more."""
    flown = record_scenario(load("cubesat6u"), seed, 2.0)
    assert flown.estimates.mode[-1] == Mode.POINT


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("satellite", [1, 2, 3, 4, 5, 6])
def test_a_3u_of_the_population_with_coils_to_spare_points_within_three_orbits(satellite):
    """Without a limit by the orbital rate two of them still tumble after four."""
    driven = {"coils": {"driver": "continuous", "max_dipole_am2": 0.048}}
    scenario = load("cubesat3u", merge(population.satellite("3u", satellite), driven))
    assert record_scenario(scenario, satellite, 3.0).estimates.mode[-1] == Mode.POINT


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("seed", [911, 912])
def test_a_3u_whose_coils_balance_a_torque_for_a_third_of_their_time_points_within_two_orbits(seed):
    """Without the estimated torque taken off it is over 90 deg away after eight."""
    loaded = parse_settings(("disturbance.torque_nm=[6e-9,6e-9,6e-9]",))
    assert record_scenario(load("cubesat3u", loaded), seed, 2.0).estimates.mode[-1] == Mode.POINT
