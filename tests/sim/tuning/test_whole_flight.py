"""A whole flight for the search of gains: the plant's truth of the scenario as it is."""

import numpy as np
import pytest

from sim.campaign.flight import Order, record_order
from sim.scenario.schema import load, orbit_period_s
from sim.tuning.rigid_flight import fly
from sim.tuning.search import fly_whole

OFF_AXIS = {
    "body": {"inertia_kgm2": [[0.9, 0.02, -0.01], [0.02, 1.7, 0.03], [-0.01, 0.03, 1.8]]},
    "disturbance": {"torque_nm": [3e-8, -2e-8, 1e-8], "residual_dipole_am2": [0.002, 0.001, -0.003]},
}


@pytest.mark.long
def test_it_is_the_truth_of_the_flight():
    scenario = load("microsat", OFF_AXIS)
    found, truth = fly_whole(scenario, 5, 0.05), record_order(Order("microsat", OFF_AXIS, 5, 0.05)).truth
    assert found.orbit_s == orbit_period_s(scenario)
    assert np.array_equal(found.t_s, truth["t_s"])
    assert np.array_equal(found.q_body_from_orbit, truth["q_body_from_orbit"])
    assert np.array_equal(found.relative_body_radps, truth["omega_body_orbit_radps"])


def test_before_the_first_pulse_it_moves_as_the_rigid_body_does():
    """The lockout after boot lasts 100 s; both rates are relative to the orbital frame, in body axes."""
    scenario = load("microsat", OFF_AXIS)
    whole, rigid = fly_whole(scenario, 5, 0.02), fly(scenario, 0.02)
    rows = slice(0, 100, 10)
    off_deg = np.degrees(np.abs(whole.q_body_from_orbit[rows] - rigid.q_body_from_orbit[:10]).max())
    assert off_deg < 0.1
    assert np.abs(whole.relative_body_radps[rows] - rigid.relative_body_radps[:10]).max() < 2e-5
