"""Laws for a sphere: an axis to the vertical, and an observer that knows the torque."""

from dataclasses import replace
from math import nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.algebra.quaternion import multiply, normalise
from fsw.core.laws.sphere import (
    ObserverGains,
    VerticalGains,
    observed,
    sphere_output,
    sphere_vertical,
    vertical_torque,
)

SPHERE = np.diag([1.6, 1.6, 1.6])
K_W, K_A = 6.2694e6, 1614.9
B = (2e-5, -1e-5, 3e-5)
LIMITED = {"mean_dipole_am2": 0.25}
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component).filter(lambda v: np.linalg.norm(v) > 0.1)


@pytest.mark.long
@given(vectors, vectors)
def test_the_torque_turns_the_axis_to_the_vertical(a, r):
    a, r = np.array(a) / np.linalg.norm(a), np.array(r) / np.linalg.norm(r)
    torque = np.array(vertical_torque(B, (0.0, 0.0, 0.0), tuple(a), tuple(r), K_W, K_A))
    assert (a + 1e-3 * np.cross(torque / max(np.linalg.norm(torque), 1e-30), a)) @ r >= a @ r
    assert np.linalg.norm(torque) == pytest.approx(2.0 * K_A * np.dot(B, B) * np.linalg.norm(np.cross(a, r)))


def test_any_rate_is_braked():
    torque = vertical_torque(B, (1e-3, -2e-3, 3e-3), (1.0, 0.0, 0.0), (1.0, 0.0, 0.0), K_W, K_A)
    assert torque == pytest.approx(-K_W * np.dot(B, B) * np.array([1e-3, -2e-3, 3e-3]))


@pytest.fixture(scope="module")
def fly(bench, turned):
    def run(law, own, angle_deg, look=lambda inputs: inputs):
        return bench.fly_from_rest(
            law,
            bench.setpoint(k_w=K_W, k_a=K_A),
            gains=own,
            body=bench.Body(SPHERE, most_am2=5.0),
            c_body_from_orbit=turned((0, 1, 2), angle_deg),
            orbits=4.0,
            step_s=10.0,
            look=look,
        )

    return run


def hidden(inputs):
    return inputs.replace(attitude=inputs.attitude.replace(omega_body_orbit_radps=(nan, nan, nan)))


@pytest.mark.long
@pytest.mark.parametrize("axis", [0, 1])
def test_the_axis_comes_to_the_vertical_and_the_body_turns_as_it_likes(fly, axis):
    """The claim of the source, for a sphere."""
    own = VerticalGains(float(axis == 0), float(axis == 1), 0.0)
    run = fly(sphere_vertical, {"sphere_vertical": own}, 60.0)
    off = np.degrees(np.arccos(np.clip(run.c_body_from_orbit[:, axis, 0], -1.0, 1.0)))
    assert off[0] > 40.0
    assert off[-600:].max() < 0.1
    assert run.angle_deg[-600:].min() > 20.0


def test_the_observer_finds_a_rate_that_it_was_not_told():
    """A sphere that turns freely, orbit left out."""
    q, z, w, omega = (
        normalise((0.9, 0.1, -0.2, 0.3)),
        (1.0, 0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        (1e-3, -2e-3, 3e-3),
    )
    for _ in range(1000):
        z, w = observed(z, w, q, (0.0, 0.0, 0.0), 0.02, 1.0)
        half = 0.5 * np.linalg.norm(omega)
        q = normalise(multiply(q, (np.cos(half), *(np.sin(half) * np.array(omega) / np.linalg.norm(omega)))))
    assert w == pytest.approx(omega, rel=1e-3)


@pytest.mark.parametrize("bandwidth_radps", [2e-3, 0.02, 0.3, 2.0, 20.0, 100.0])
@pytest.mark.parametrize("tick_s", [0.1, 1.0, 10.0])
def test_it_follows_with_any_bandwidth_at_any_tick(bandwidth_radps, tick_s):
    """From an error of half a turn, a sphere that turns freely, orbit left out."""
    q, z, w, omega = (0.0, 0.6, 0.8, 0.0), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1e-3, -2e-3, 3e-3)
    half = 0.5 * tick_s * np.linalg.norm(omega)
    turn = (np.cos(half), *(np.sin(half) * np.array(omega) / np.linalg.norm(omega)))
    for _ in range(300 + int(60.0 / (bandwidth_radps * tick_s))):
        q = normalise(multiply(q, turn))
        z, w = observed(z, w, q, (0.0, 0.0, 0.0), bandwidth_radps, tick_s)
    assert w == pytest.approx(omega, rel=1e-3)
    assert abs(np.dot(z, q)) == pytest.approx(1.0, abs=1e-6)


def test_it_knows_a_push_at_once():
    """Of a torque that it is told the rate has no lag."""
    q, z, w = (1.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    _, w = observed(z, w, q, (1e-5, 0.0, 0.0), 0.02, 2.0)
    assert w == (2e-5, 0.0, 0.0)


@pytest.mark.long
def test_without_a_rate_a_sphere_comes_to_the_nominal_attitude(fly):
    """The claim of the source."""
    run = fly(sphere_output, {"sphere_output": ObserverGains()}, 20.0, hidden)
    assert run.angle_deg[0] == pytest.approx(20.0)
    assert run.angle_deg[-600:].max() < 1.5
    assert run.angle_deg[-600:].max() < 0.2 * run.angle_deg[600:1200].max()


def test_the_observer_is_told_the_torque_of_its_own_dipole(bench, turned):
    """The dipole of the last tick moves w by h m x b / J beside what the attitude says."""
    orbit = bench.Orbit()
    c = turned((1, -2, 3), 25.0) @ orbit.c_orbit_from_eci(700.0)
    inputs = bench.inputs_at(orbit, 700, 1.0, c, np.zeros(3), None)
    settings = bench.config(bench.Body(SPHERE), 1.0, {"sphere_output": ObserverGains()})
    q = inputs.attitude.q_body_from_orbit
    at_rest = (*q, 0.0, 0.0, 0.0)
    memories = [
        sphere_output(inputs, (*at_rest, *m), bench.setpoint(k_w=K_W, k_a=K_A), settings).memory
        for m in ((0.0, 0.0, 0.0), (0.1, -0.2, 0.3))
    ]
    pushed = np.subtract(memories[1][4:7], memories[0][4:7])
    assert pushed == pytest.approx(np.cross((0.1, -0.2, 0.3), inputs.b_body_t) / 1.6, rel=1e-9)


def test_the_observer_is_told_how_the_orbital_frame_turns(bench, turned):
    """Of a turned body without a dipole w changes by h w0 w x e3 beside what the attitude says."""
    orbit, rate = bench.Orbit(), np.array([2e-3, -3e-3, 1e-3])
    c = turned((1, -2, 3), 70.0)
    inputs = bench.inputs_at(orbit, 700, 2.0, c @ orbit.c_orbit_from_eci(1400.0), np.zeros(3), None)
    settings = bench.config(bench.Body(SPHERE), 2.0, {"sphere_output": ObserverGains()})
    q = inputs.attitude.q_body_from_orbit
    memory = sphere_output(inputs, (*q, *rate, 0.0, 0.0, 0.0), bench.setpoint(), settings).memory
    _, without = observed(q, tuple(rate), q, (0.0, 0.0, 0.0), ObserverGains().bandwidth_radps, 2.0)
    turned_by = 2.0 * orbit.rate_radps * np.cross(rate, c[:, 2])
    assert np.subtract(memory[4:7], without) == pytest.approx(turned_by, rel=1e-6)


def test_what_the_coils_cannot_give_is_not_remembered(bench, turned):
    """The observer follows what turns the body: with any gain its state stays finite."""
    orbit = bench.Orbit()
    settings = replace(bench.config(bench.Body(SPHERE), 1.0, {"sphere_output": ObserverGains()}), **LIMITED)
    memory = ()
    for tick in range(700, 720):
        c = turned((1, -2, 3), 25.0) @ orbit.c_orbit_from_eci(tick)
        inputs = bench.inputs_at(orbit, tick, 1.0, c, np.zeros(3), None)
        demand = sphere_output(inputs, memory, bench.setpoint(k_w=1e200, k_a=1e200), settings)
        memory, given_am2 = demand.memory, demand.memory[7:]
        assert max(map(abs, given_am2)) == pytest.approx(0.25)
        assert np.cross(given_am2, demand.m_body_am2) / max(map(abs, demand.m_body_am2)) == pytest.approx(
            np.zeros(3), abs=1e-12
        )
        assert np.sign(given_am2).tolist() == np.sign(demand.m_body_am2).tolist()
    assert np.linalg.norm(memory[4:7]) < 0.01


def test_gains_out_of_range_are_refused():
    for axis_1 in (0.0, 1e-200, 1e200):
        with pytest.raises(ValueError, match="axis_1"):
            VerticalGains(axis_1, 0.0, 0.0)
    for bandwidth_radps in (0.0, -1.0, 101.0):
        with pytest.raises(ValueError, match="must be above 0 and at most 100"):
            ObserverGains(bandwidth_radps)
