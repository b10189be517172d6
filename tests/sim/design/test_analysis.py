"""The content of the analysis, as text, as JSON and as pictures."""

import json
from dataclasses import replace

import numpy as np
import pytest

from sim.design.from_scenario import body_of, pulsing_of
from sim.design.render import as_json, as_text
from sim.design.theory.floquet import monodromy, multipliers
from sim.design.theory.linear import closed_loop
from sim.scenario.schema import load, parse_settings


@pytest.mark.long
@pytest.mark.slow
def test_the_progress_never_goes_back(searched):
    progress = searched[2]
    assert progress == sorted(progress)
    assert len(set(progress)) > 50


@pytest.mark.long
def test_multipliers_are_those_of_the_best_gains(searched):
    _, analysis, _ = searched
    loop = closed_loop(analysis.body, analysis.search.best.gains)
    assert analysis.multipliers == pytest.approx(multipliers(monodromy(loop)), abs=1e-12)
    assert analysis.chosen.degree == pytest.approx(np.log(abs(analysis.multipliers[0])) / (2.0 * np.pi))


@pytest.mark.long
def test_json_says_what_the_analysis_holds(searched):
    _, analysis, _ = searched
    result = json.loads(json.dumps(as_json(analysis), allow_nan=False))
    assert result["degree_of_stability"] == analysis.chosen.degree < -0.518
    assert result["stabilised"] is True
    moduli = [abs(complex(*pair)) for pair in result["multipliers"]]
    assert len(moduli) == 6
    assert moduli == sorted(moduli, reverse=True)
    assert result["settling_orbits"] == pytest.approx(np.log(20.0) / (-2.0 * np.pi * analysis.chosen.degree))
    assert result["gains"]["k_w"] == analysis.chosen.gains.k_w
    assert result["steady"]["degree_of_stability_gains_off"] < result["degree_of_stability_gains_off"]
    assert result["integral"]["gains"]["k_i"] > 0.0
    assert result["integral"]["degree_of_stability"] < -0.1
    assert result["periodic_lqr"]["degree_of_stability"] < result["degree_of_stability"]


def test_pulses_are_reported_with_their_number_an_orbit(searched):
    _, analysis, _ = searched
    pulsed = as_json(analysis)["pulsed"]
    assert pulsed["periods_per_orbit"] == 60
    assert pulsed["averaged"] == pytest.approx(analysis.chosen.degree, abs=1e-12)
    assert pulsed["averaged"] < pulsed["sampled"] == pulsed["sampled_in_turn"] < 0.0
    assert pulsed["best"]["degree_of_stability"] < pulsed["sampled"]
    assert "taken as 60 an orbit" in as_text(analysis, searched[0])


def test_text_names_gains_exponents_and_margins(searched):
    scenario, analysis, _ = searched
    result = as_text(analysis, scenario)
    assert f"{analysis.chosen.degree:+.4f}" in result
    assert f"{analysis.chosen.gains.k_w:.6g}" in result
    assert result.count(" i   ") == 6
    assert "no gains stabilise" not in result
    assert "note: of the TLE, mean motion and inclination count" in result


def test_text_says_when_no_gains_stabilise_and_the_best_it_found(searched):
    scenario, analysis, _ = searched
    lost = replace(analysis.search, steady=replace(analysis.search.steady, worst_degree=0.02))
    result = as_text(replace(analysis, search=lost), scenario)
    assert "no gains stabilise this body: the best degree of stability found is" in result
    assert f"{analysis.search.best.degree:+.4f}" in result


def test_gains_that_do_not_stabilise_have_no_margins(searched):
    scenario, analysis, _ = searched
    unstable = replace(analysis, search=None, chosen=replace(analysis.chosen, degree=0.2))
    result = as_text(unstable, scenario)
    assert "the first row is not stable: it has no margins" in result
    assert "never" in result
    assert as_json(unstable)["settling_orbits"] is None
    assert "it has no margins" not in as_text(analysis, scenario)


def test_a_degree_beyond_all_numbers_is_null_in_json(searched):
    analysis = searched[1]
    beyond = replace(analysis, pulsed=replace(analysis.pulsed, sampled=np.inf))
    result = json.loads(json.dumps(as_json(beyond), allow_nan=False))
    assert result["pulsed"]["sampled"] is None
    assert result["pulsed"]["averaged"] == analysis.pulsed.averaged


def test_the_orbit_of_a_tle_is_the_circle_of_its_mean_motion():
    scenario = load("microsat")
    body = body_of(scenario)
    assert body.inclination_deg == 98.6946
    assert 2.0 * np.pi / body.rate_radps == pytest.approx(86400.0 / 14.30166407, rel=1e-12)


def test_the_keys_of_a_circle_are_taken_as_they_are():
    scenario = load("microsat", parse_settings(("orbit.altitude_km=612.5", "orbit.inclination_deg=51.6")))
    body = body_of(scenario)
    assert (body.altitude_km, body.inclination_deg) == (612.5, 51.6)
    assert body.inertia_kgm2 == ((1.02, 0.0, 0.0), (0.0, 1.85, 0.0), (0.0, 0.0, 1.95))


def test_coils_pulse_as_the_scenario_says():
    settings = parse_settings(("coils.backoff=per_coil", "coils.backoff_s=80.0", "control.leak_s=250.0"))
    pulsing = pulsing_of(load("microsat", settings))
    assert (pulsing.pulse_s, pulsing.backoff_s, pulsing.leak_s, pulsing.in_turn) == (3.0, 80.0, 250.0, False)
    assert pulsing_of(load("microsat")).in_turn


def test_a_continuous_driver_has_no_pulses_to_analyse(searched):
    settings = ("coils.driver=continuous", "coils.max_dipole_am2=5.0")
    scenario = load("microsat", parse_settings(settings))
    assert pulsing_of(scenario) is None
    analysis = replace(searched[1], pulsed=None)
    assert "pulsed" not in as_json(analysis)
    assert "pulses" not in as_text(analysis, scenario)


def test_a_body_that_rests_under_a_torque_is_told_to_be_no_equilibrium(searched):
    scenario = load("microsat", parse_settings(("control.law=rate_damping",)))
    result = as_text(replace(searched[1], resting_torque_nm=np.array([0.0, -2.1e-7, 0.0])), scenario)
    assert (
        "note: the nominal attitude is no equilibrium of this body (0.00e+00, -2.10e-07, 0.00e+00 N m"
        in result
    )
    assert "the scenario flies the law rate_damping" in result
    assert "no equilibrium" not in as_text(searched[1], searched[0])
