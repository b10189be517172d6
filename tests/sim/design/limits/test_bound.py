"""The bound on the field that is flown, beside that of the direct dipole's and below the laws."""

from math import degrees

import pytest

from fsw.table.config import flight_config
from sim.design.from_scenario import body_of
from sim.design.limits.bound import least_deg
from sim.design.limits.linear_flight import fly, orbits_of
from sim.design.theory.feedforward import least_error
from sim.scenario.schema import flight_table, load

TORQUE = (2e-8, 3e-8, 5e-8)
START = (0.005, 0.004, -0.006)
UNEQUAL = {"body": {"inertia_kgm2": [1.02, 1.75, 2.05]}}


def config_of(scenario):
    return flight_config(flight_table(scenario))


@pytest.mark.long
def test_on_the_direct_dipoles_field_it_comes_near_the_periodic_one_from_below():
    """Another method, collocation of the periodic motion; here beginning and end are free, which helps."""
    circle = {"tle": None, "altitude_km": 800.0, "inclination_deg": 98.6}
    scenario = load("microsat", UNEQUAL | {"orbit": circle, "flight": {"field": {"model": "direct_dipole"}}})
    config = config_of(scenario)
    periodic = degrees(least_error(body_of(scenario), TORQUE).rms_rad)
    met = orbits_of(config)
    one_orbit, three_orbits = (
        least_deg(config, TORQUE, met[: round(part * len(met))]) for part in (1 / 3, 1)
    )
    assert one_orbit < three_orbits < periodic
    assert three_orbits > 0.93 * periodic


@pytest.mark.long
def test_it_is_in_proportion_to_the_torque(two_orbits):
    config = config_of(load("microsat", UNEQUAL))
    one, three = (least_deg(config, tuple(n * part for part in TORQUE), two_orbits) for n in (10.0, 30.0))
    assert three == pytest.approx(3.0 * one, rel=0.01)


@pytest.mark.long
@pytest.mark.parametrize("law", ["mpc", "pulse_mpc"])
@pytest.mark.parametrize("torque", [(0.0, 0.0, 0.0), TORQUE])
def test_no_law_is_below_it(law, torque, two_orbits):
    changed = {"control": {"law": law}, "disturbance": {"torque_nm": list(torque)}}
    scenario = load("microsat", UNEQUAL | changed)
    flown = fly(scenario, START, two_orbits).rms_deg()
    assert least_deg(config_of(scenario), torque, two_orbits) < flown
