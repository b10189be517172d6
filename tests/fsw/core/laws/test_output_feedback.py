"""Three axes from the attitude alone: the lag tells the rate, and no rate is looked at."""

from math import nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.algebra.quaternion import multiply, normalise
from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.output_feedback import (
    FilterGains,
    follow,
    lagged_rate,
    nearer_sign,
    output_feedback,
)
from fsw.core.laws.pd import pd, pd_far

K_W, K_A = 6.2694e6, 1614.9
BANDWIDTH_RADPS = 0.02
STEP_S = 0.5
Q = normalise((0.9, 0.1, -0.2, 0.3))


def negative(q):
    return tuple(-part for part in q)


@pytest.fixture
def settings(bench):
    gains = {"output_feedback": FilterGains(BANDWIDTH_RADPS)}
    return bench.config(bench.Body(), STEP_S, gains)


@pytest.fixture
def inputs(bench, turned):
    orbit = bench.Orbit()
    c_body_from_eci = turned((1, -2, 3), 25.0) @ orbit.c_orbit_from_eci(700.0)
    return bench.inputs_at(orbit, 1400, STEP_S, c_body_from_eci, np.array([1e-3, 2e-3, -1e-3]), None)


def with_attitude(inputs, q, omega=(nan, nan, nan)):
    return inputs.replace(attitude=inputs.attitude.replace(q_body_from_orbit=q, omega_body_orbit_radps=omega))


@pytest.fixture(scope="module")
def flight(bench, turned):
    """From 20 deg off, the rate unknown to the law where it is told to be blind."""

    def fly(law, orbits=6.0, blind=False, k_w=K_W):
        def look(inputs):
            return with_attitude(inputs, inputs.attitude.q_body_from_orbit) if blind else inputs

        orbit, c = bench.Orbit(), turned((1, 2, 3), 20.0)
        return bench.fly(
            law,
            bench.setpoint(k_w=k_w, k_a=K_A),
            gains={"output_feedback": FilterGains(BANDWIDTH_RADPS)},
            orbit=orbit,
            body=bench.Body(),
            c_body_from_orbit=c,
            omega_body=orbit.rate_radps * c[:, 2] + 1e-3,
            seconds=orbits * orbit.period_s,
            step_s=10.0,
            look=look,
        )

    return fly


def test_the_lag_of_a_steady_turn_is_its_rate():
    """The part of it that the filter passes: the error is of the order of omega / a."""
    omega = np.array([3e-4, -2e-4, 4e-4])
    half = 0.5 * STEP_S * np.linalg.norm(omega)
    turn = (np.cos(half), *(np.sin(half) * omega / np.linalg.norm(omega)))
    part = BANDWIDTH_RADPS * STEP_S / (1.0 + BANDWIDTH_RADPS * STEP_S)
    q = z = Q
    for _ in range(2000):
        q = normalise(multiply(q, turn))
        z, before = follow(q, z, part), z
    assert lagged_rate(q, before, BANDWIDTH_RADPS) == pytest.approx(omega, rel=0.05)


def test_at_first_no_rate_is_assumed(inputs, settings, bench):
    demand = output_feedback(with_attitude(inputs, Q), (), bench.setpoint(k_w=K_W, k_a=K_A), settings)
    at_rest = pd_far(
        with_attitude(inputs, Q, (0.0, 0.0, 0.0)), (), bench.setpoint(k_w=K_W, k_a=K_A), settings
    )
    assert demand.m_body_am2 == pytest.approx(at_rest.m_body_am2)
    assert demand.memory == pytest.approx(Q)


def test_the_sign_of_a_quaternion_means_nothing(inputs, settings, bench):
    point, z = bench.setpoint(k_w=K_W, k_a=K_A), normalise((0.91, 0.09, -0.19, 0.31))
    one, other = (output_feedback(with_attitude(inputs, q), z, point, settings) for q in (Q, negative(Q)))
    assert one.m_body_am2 == pytest.approx(other.m_body_am2, rel=1e-12)
    assert negative(one.memory) == pytest.approx(other.memory, rel=1e-12)


@given(*[st.tuples(*[st.floats(-1.0, 1.0)] * 4)] * 2)
def test_of_both_signs_the_nearer_one_is_taken(z, q):
    found = np.array(nearer_sign(z, q))
    assert {tuple(found), tuple(-found)} == {z, tuple(-np.array(z))}
    assert np.linalg.norm(found - q) <= np.linalg.norm(found + q) + 1e-12


def test_the_filter_takes_the_step_of_its_backward_difference(inputs, settings, bench):
    """z+ = z + a T (q - z+): stable however long the tick."""
    z, point = normalise((0.8, 0.3, -0.1, 0.4)), bench.setpoint(k_w=K_W, k_a=K_A)
    after = np.array(output_feedback(with_attitude(inputs, Q), z, point, settings).memory)
    step = BANDWIDTH_RADPS * STEP_S
    assert after == pytest.approx(np.array(z) + step * (np.array(Q) - after), abs=1e-12)


@pytest.mark.long
def test_without_a_rate_the_attitude_converges(flight):
    """The property claimed by the source; the law sees no number in place of the rate."""
    run = flight(output_feedback, blind=True)
    assert run.angle_deg[0] == pytest.approx(20.0)
    assert run.angle_deg[-600:].max() < 0.3


@pytest.mark.long
def test_without_damping_it_would_not(flight):
    """The same spring alone."""
    assert flight(pd, k_w=0.0).angle_deg[-600:].max() > 10.0


@pytest.mark.long
def test_with_the_rate_it_converges_sooner(flight):
    """What the missing rate costs."""
    third_orbit = slice(1200, 1800)
    assert flight(pd).angle_deg[third_orbit].max() < flight(output_feedback).angle_deg[third_orbit].max()


def test_an_unknown_attitude_asks_for_nothing_and_forgets(inputs, settings, bench):
    demand = output_feedback(inputs.replace(attitude=UNKNOWN), Q, bench.setpoint(k_w=K_W, k_a=K_A), settings)
    assert demand.m_body_am2 == (0.0, 0.0, 0.0)
    assert demand.memory == ()


def test_without_a_field_nothing_is_asked_for(inputs, settings, bench):
    dark = with_attitude(inputs, Q).replace(b_body_t=(0.0, 0.0, 0.0))
    demand = output_feedback(dark, (), bench.setpoint(k_w=K_W, k_a=K_A), settings)
    assert demand.m_body_am2 == (0.0, 0.0, 0.0)
