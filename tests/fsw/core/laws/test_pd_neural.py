"""The PD law whose gains two dynamic units choose: what a unit sees, how it lags, and its factor."""

import json
from dataclasses import asdict
from math import log, tanh
from pathlib import Path

import numpy as np
import pytest

from fsw.core.laws.pd import pd_far
from fsw.core.laws.pd_neural import NeuralGains, neural, unit_inputs

K_W, K_A = 5e6, 1200.0
KEPT = Path(__file__).resolve().parents[4] / "sim" / "design" / "neural_found.json"
NOTHING = NeuralGains(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1)


@pytest.fixture
def inputs(bench, turned):
    c = turned((1, -2, 3), 25.0)
    orbit = bench.Orbit()
    body_from_eci = c @ orbit.c_orbit_from_eci(70.0)
    return bench.inputs_at(orbit, 7, 10.0, body_from_eci, np.array([1e-3, -2e-3, 3e-3]), None)


@pytest.fixture
def ask(bench, inputs):
    def asked(gains, memory=(), inputs=inputs, step_s=10.0):
        config = bench.config(bench.Body(), step_s, {"pd_neural": gains})
        return neural(inputs, memory, bench.setpoint(k_w=K_W, k_a=K_A), config)

    return asked


def test_what_a_unit_sees():
    assert unit_inputs(0.06, 0.0, 1e-3) == pytest.approx((log(4.0), 0.0))
    assert unit_inputs(0.0, 1e-4, 1e-3) == pytest.approx((0.0, log(6.0)))


def test_with_no_weights_it_is_the_pd_law_of_the_far_error(bench, inputs, ask):
    config = bench.config(bench.Body(), 10.0)
    expected = pd_far(inputs, (), bench.setpoint(k_w=K_W, k_a=K_A), config)
    assert ask(NOTHING).m_body_am2 == pytest.approx(expected.m_body_am2, rel=1e-12)


@pytest.mark.parametrize(("gains", "of_rate", "of_error"), [((0.5, 0.0), 0.5, 0.0), ((0.0, -0.7), 0.0, -0.7)])
def test_each_unit_has_a_gain_of_its_own(bench, inputs, ask, gains, of_rate, of_error):
    first, second = gains
    config = bench.config(bench.Body(), 10.0)
    factors = {"k_w": K_W * 8.0 ** tanh(of_rate), "k_a": K_A * 8.0 ** tanh(of_error)}
    expected = pd_far(inputs, (), bench.setpoint(**factors), config)
    demand = ask(NeuralGains(w0=first, w1=0.0, w2=0.0, a0=second, a1=0.0, a2=0.0))
    assert demand.m_body_am2 == pytest.approx(expected.m_body_am2, rel=1e-12)


def test_error_and_rate_have_weights_of_their_own(inputs, ask):
    attitude, w0 = inputs.attitude, inputs.reference.orbit_rate_radps
    error = 4.0 * np.linalg.norm(attitude.q_body_from_orbit[1:])
    by_error, by_rate = unit_inputs(error, float(np.linalg.norm(attitude.omega_body_orbit_radps)), w0)
    memory = ask(NeuralGains(w0=0.1, w1=0.2, w2=-0.3, a0=-0.4, a1=0.5, a2=0.6)).memory
    rate_unit, error_unit = 0.1 + 0.2 * by_error - 0.3 * by_rate, -0.4 + 0.5 * by_error + 0.6 * by_rate
    assert memory == pytest.approx((rate_unit, rate_unit, error_unit, error_unit))


def test_two_lags_in_a_row_follow_what_changes(ask, inputs):
    """After n ticks of a step of 1: v2 = 1 - (1 - p)^n (1 + n p)."""
    lag_orbits, step_s = 0.05, 10.0
    part = step_s / (2.0 * np.pi / inputs.reference.orbit_rate_radps * lag_orbits + step_s)
    memory = (0.0, 0.0, 0.0, 0.0)
    for n in range(1, 40):
        memory = ask(
            NeuralGains(w0=1.0, w1=0.0, w2=0.0, a0=-1.0, a1=0.0, a2=0.0, lag_orbits=lag_orbits), memory
        ).memory
        expected = 1.0 - (1.0 - part) ** n * (1.0 + n * part)
        assert (memory[1], memory[3]) == pytest.approx((expected, -expected))


def test_without_an_attitude_nothing_is_asked_for(inputs, ask):
    unknown = inputs.replace(attitude=inputs.attitude.invalid())
    for absent in (unknown, inputs.replace(reference=None)):
        demand = ask(NOTHING, inputs=absent)
        assert (demand.m_body_am2, demand.memory) == ((0.0, 0.0, 0.0), ())


def test_its_weights_are_those_that_training_found():
    kept = json.loads(KEPT.read_text(encoding="utf-8"))
    assert list(asdict(NeuralGains()).values()) == kept["weights"]
    assert kept["cost"] < kept["cost_of_constant_gains"]


@pytest.mark.long
def test_it_points_a_satellite(bench, turned):
    flown = bench.fly_from_rest(
        neural,
        bench.setpoint(k_w=6.2694e6, k_a=1614.9),
        gains={"pd_neural": NeuralGains()},
        body=bench.Body(most_am2=5.0),
        c_body_from_orbit=turned((1, 2, 3), 20.0),
        orbits=4.0,
        step_s=10.0,
    )
    assert flown.angle_deg[-600:].max() < 1.0


@pytest.mark.parametrize("lag_orbits", [0.0, -1.0])
def test_a_lag_without_a_length_is_refused(lag_orbits):
    with pytest.raises(ValueError, match="lag_orbits"):
        NeuralGains(lag_orbits=lag_orbits)
