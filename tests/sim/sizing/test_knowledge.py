"""How well the filter will know the attitude, by its own covariance, and how near that is to flights."""

from dataclasses import replace

import numpy as np
import pytest

from sim.campaign.flight import record_scenario
from sim.new_scenario.command import scenario_made, scenario_text
from sim.new_scenario.satellite import NewSatellite
from sim.report.figures.attitude_arrays import angle_rad
from sim.report.figures.estimate_error import estimate_error
from sim.scenario.schema import load
from sim.sizing.knowledge import knowledge_of

THREE_U = NewSatellite("three-u", None, 550.0, 97.6, 4.5, (0.1, 0.1, 0.34), continuous=True, dipole_am2=0.2)
ONE_U = NewSatellite("one-u", None, 500.0, 97.4, 1.3, (0.1, 0.1, 0.1135))


def made(satellite, settings=None):
    return scenario_made(scenario_text(satellite, "mine.toml"), settings)


def test_nothing_is_unknown_where_the_plant_tells_the_attitude():
    found = knowledge_of(load("microsat", {"knowledge": "perfect"}))
    assert (found.rms_deg, found.most_deg) == (0.0, 0.0)


def test_a_small_body_in_a_low_orbit_is_lost_in_the_shadow_and_a_large_high_one_is_not():
    assert knowledge_of(made(ONE_U)).most_deg > 10.0
    assert knowledge_of(made(replace(ONE_U, altitude_km=800.0))).most_deg < knowledge_of(made(ONE_U)).most_deg
    assert knowledge_of(load("microsat")).most_deg < 1.0


def test_where_the_orbit_has_no_shadow_the_sun_holds_it():
    """A dawn-dusk orbit: the node is 90 deg from the Sun, which is at right ascension 0 at the equinox."""
    dark, lit = ({"orbit": {"raan_deg": raan_deg, "inclination_deg": 98.0}} for raan_deg in (0.0, 90.0))
    assert knowledge_of(made(ONE_U, lit)).most_deg < 0.3 * knowledge_of(made(ONE_U, dark)).most_deg


@pytest.mark.parametrize(
    "tighter",
    [
        {"torque_nm": 1e-9},
        {"magnetometer_shadow_nt": 0.0},
        {"shadow_impulse_nms": 0.0},
        {"remanence_percent": 0.0},
        {"storm_nt": 0.0},
    ],
)
def test_a_tighter_bound_is_worth_something(tighter):
    known, of_all = (knowledge_of(made(ONE_U, {"flight": {"uncertainty": keys}})) for keys in (tighter, {}))
    assert known.rms_deg < of_all.rms_deg


@pytest.mark.parametrize("up", ["x", "z"])
def test_the_names_of_the_axes_make_no_difference(up):
    body = {"inertia_kgm2": [0.008, 0.04, 0.041]} if up == "x" else {"inertia_kgm2": [0.04, 0.041, 0.008]}
    body |= {"up": up, "ahead": {"x": "y", "z": "x"}[up]}
    expected = knowledge_of(
        made(THREE_U, {"body": {"inertia_kgm2": [0.008, 0.04, 0.041], "up": "x", "ahead": "y"}})
    )
    assert knowledge_of(made(THREE_U, {"body": body})).rms_deg == pytest.approx(expected.rms_deg, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("seed", [201, 202])
def test_a_flight_is_wrong_by_a_third_to_three_times_of_it(seed):
    scenario = made(THREE_U)
    record = record_scenario(scenario, seed, 4.0)
    last = slice(-5700, None)
    error_deg = np.degrees(angle_rad(estimate_error(record.truth, record.estimates)[last]))
    flown = float(np.sqrt(np.mean(error_deg**2)))
    assert 1.0 / 3.0 < flown / knowledge_of(scenario).rms_deg < 3.0
