"""A flight of a rigid body: as linear theory has it, with pulses as the coils give them."""

import numpy as np
import pytest

from fsw.core.algebra.quaternion import dcm
from fsw.input.schema import merge
from sim.design.from_scenario import body_of
from sim.design.theory.floquet import monodromy
from sim.design.theory.linear import Gains, closed_loop, dipole_field
from sim.scenario.schema import load
from sim.tuning.rigid_flight import fly

CALM = {
    "knowledge": "perfect",
    "orbit": {"tle": None, "altitude_km": 800.0, "inclination_deg": 98.6, "raan_deg": 30.0, "u0_deg": 0.0},
    "time": {"epoch_utc": "2025-03-20T09:00:00Z"},
    "field": {"model": "direct_dipole"},
    "body": {"inertia_kgm2": [[1.02, 0.0, 0.0], [0.0, 1.85, 0.0], [0.0, 0.0, 1.95]]},
    "initial": {"axis": [1.0, -2.0, 3.0], "angle_deg": 1.0, "rate_degps": [0.002, -0.003, 0.004]},
    "disturbance": {"torque_nm": [0.0, 0.0, 0.0]},
    "coils": {"driver": "continuous", "max_dipole_am2": 8.0, "on_fraction": 1.0},
    "control": {"law": "pd", "k_i": 0.0},
}


def flown(orbits, **more):
    return fly(load("microsat", merge(CALM, more)), orbits)


def state(flight, row, w0):
    """x = (Omega / w0, theta) of linear theory."""
    return np.concatenate([flight.relative_body_radps[row] / w0, 2.0 * flight.q_body_from_orbit[row, 1:]])


def test_near_nominal_it_is_the_linear_motion():
    scenario = load("microsat", CALM)
    body = body_of(scenario)
    flight = fly(scenario, 1.003, 2.0)
    whole = monodromy(closed_loop(body, Gains(scenario.control.k_w, scenario.control.k_a)))
    first, row = state(flight, 0, body.rate_radps), round(flight.orbit_s / 2.0)
    expected = whole @ first
    got = state(flight, row, body.rate_radps)
    assert np.linalg.norm(got - expected) < 0.05 * np.linalg.norm(expected)
    assert np.linalg.norm(expected) < 0.7 * np.linalg.norm(first)


@pytest.mark.long
def test_without_a_dipole_nothing_but_gravity_acts():
    free = flown(0.5, control={"k_w": 0.0, "k_a": 0.0})
    assert not free.m_body_am2.any()
    assert free.pointing_deg.max() > 1.0
    wheel = flown(0.5, control={"k_w": 0.0, "k_a": 0.0}, body={"wheel_nms": [0.0, 0.0, 0.05]})
    assert not np.allclose(wheel.pointing_deg, free.pointing_deg, rtol=0.1)


def test_constant_torque_and_residual_dipole_turn_the_body():
    """What they add to the momentum in a step, beside the same flight without them."""
    inertia = np.array([[1.02, 0.13, -0.09], [0.13, 1.85, 0.21], [-0.09, 0.21, 1.95]])
    torque, dipole = np.array([3e-7, -2e-7, 5e-7]), np.array([0.02, -0.03, 0.05])
    more = {"control": {"k_w": 0.0, "k_a": 0.0}, "body": {"inertia_kgm2": inertia.tolist()}}
    acting = {"torque_nm": torque.tolist(), "residual_dipole_am2": dipole.tolist()}
    pushed, free = flown(0.01, **more, disturbance=acting), flown(0.01, **more)
    step_s = pushed.t_s[1]
    body = body_of(load("microsat", merge(CALM, more)))
    middle = np.array([0.5 * step_s * body.rate_radps])
    c = np.array(dcm(tuple(free.q_body_from_orbit[0].tolist())))
    b = c @ (body.field_t * dipole_field(middle, body)[0])
    gained = inertia @ (pushed.omega_body_radps[1] - free.omega_body_radps[1]) / step_s
    own = torque + np.cross(dipole + pushed.m_body_am2[0], b)
    assert gained == pytest.approx(own, rel=0.02, abs=0.01 * np.linalg.norm(own))


@pytest.fixture(scope="module")
def flight():
    far = {"initial": {"axis": [1.0, 1.0, 1.0], "angle_deg": 40.0}, "coils": {"driver": "pulsed"}}
    return flown(1.0, **far)


class TestPulses:
    def test_one_coil_a_pulse_with_the_impulse_of_its_level(self, flight):
        driven = flight.m_body_am2[flight.m_body_am2.any(axis=1)]
        assert (np.count_nonzero(driven, axis=1) == 1).all()
        sizes = np.abs(driven).max(axis=1)
        assert set(np.round(sizes / 0.3, 9)) <= {0.5, 2.0, 8.0}, "3 s of a step of 10 s"

    def test_from_one_to_the_next_a_back_off(self, flight):
        at_s = flight.t_s[flight.m_body_am2.any(axis=1)]
        assert len(at_s) > 20
        assert np.diff(at_s).min() == 100.0
        assert at_s[0] >= 90.0

    def test_in_steps_of_a_second_the_pulse_lasts_three(self):
        steps = fly(load("microsat", merge(CALM, {"coils": {"driver": "pulsed"}})), 0.2, 1.0)
        on = steps.m_body_am2.any(axis=1).astype(int)
        begins, ends = np.flatnonzero(np.diff(on) == 1), np.flatnonzero(np.diff(on) == -1)
        assert set(ends[: len(begins)] - begins[: len(ends)]) == {3}
        assert set(np.abs(steps.m_body_am2).max(axis=1)) <= {0.0, 0.5, 2.0, 8.0}


def test_the_coils_give_no_more_than_they_can():
    hard = flown(0.2, control={"k_a": 1e9}, coils={"max_dipole_am2": 2.0})
    assert np.abs(hard.m_body_am2).max() == pytest.approx(2.0, rel=1e-4)


def test_angles_to_a_direction_in_space():
    flight = flown(0.05, initial={"angle_deg": 0.0}, control={"k_w": 0.0, "k_a": 0.0})
    node = np.radians(30.0)
    radius = (np.cos(node), np.sin(node), 0.0)
    assert flight.axis_to_deg(0, radius)[0] == pytest.approx(0.0, abs=0.5)
    assert flight.axis_to_deg(0, tuple(-part for part in radius))[0] == pytest.approx(180.0, abs=0.5)
    assert flight.axis_to_deg(2, radius)[0] == pytest.approx(90.0, abs=0.5)
    normal = np.array(radius)
    assert 60.0 < flight.momentum_to_deg(normal)[0] < 120.0
