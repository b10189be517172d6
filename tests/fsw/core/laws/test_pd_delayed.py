"""The delay for the rate: the mean rate of the time between, and an attitude that converges on it."""

from math import nan

import numpy as np
import pytest

from fsw.core.algebra.quaternion import multiply, normalise
from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.pd import pd_far
from fsw.core.laws.pd_delayed import DelayGains, delayed, mean_rate

K_W, K_A = 6.2694e6, 1614.9
Q = normalise((0.9, 0.1, -0.2, 0.3))


def turned_on(q, omega, seconds):
    half = 0.5 * seconds * np.linalg.norm(omega)
    axis = np.array(omega) / np.linalg.norm(omega)
    return normalise(multiply(q, (np.cos(half), *(np.sin(half) * axis))))


def test_the_mean_rate_of_a_steady_turn_is_its_rate():
    """To the third order of the angle turned."""
    omega = (3e-4, -2e-4, 4e-4)
    now = turned_on(Q, omega, 100.0)
    assert mean_rate(now, Q, 100.0) == pytest.approx(omega, rel=1e-3)


def test_the_sign_of_a_quaternion_means_nothing():
    now = turned_on(Q, (3e-4, -2e-4, 4e-4), 100.0)
    assert mean_rate(now, tuple(-part for part in Q), 100.0) == mean_rate(now, Q, 100.0)


@pytest.fixture
def seen(bench, turned):
    """What the law sees of a body that turns at 1e-3 rad/s, the rate itself hidden."""

    def at(tick):
        orbit = bench.Orbit()
        c = turned((1, -2, 3), 25.0 + 0.05729578 * tick) @ orbit.c_orbit_from_eci(float(tick))
        inputs = bench.inputs_at(orbit, tick, 1.0, c, np.zeros(3), None)
        hidden = inputs.attitude.replace(omega_body_orbit_radps=(nan, nan, nan))
        return inputs.replace(attitude=hidden)

    return at


def test_attitudes_are_kept_every_delay_and_the_older_one_is_used(bench, seen):
    settings = bench.config(bench.Body(), 1.0, {"pd_delayed": DelayGains(5.0)})
    point, memory, ticks = bench.setpoint(k_w=K_W, k_a=K_A), (), []
    for tick in range(700, 722):
        memory = delayed(seen(tick), memory, point, settings).memory
        ticks.append((memory[0], memory[5]))
    assert ticks[5] == (700.0, 705.0)
    assert ticks[14] == (705.0, 710.0)
    assert ticks[21] == (715.0, 720.0)


def test_a_body_that_turns_steadily_is_braked_as_by_its_rate(bench, seen):
    settings = bench.config(bench.Body(), 1.0, {"pd_delayed": DelayGains(5.0)})
    point, memory, demand = bench.setpoint(k_w=K_W, k_a=K_A), (), None
    for tick in range(700, 722):
        demand = delayed(seen(tick), memory, point, settings)
        memory = demand.memory
    rate = 1e-3 * np.array([1.0, -2.0, 3.0]) / np.sqrt(14.0)
    known = seen(721)
    known = known.replace(attitude=known.attitude.replace(omega_body_orbit_radps=tuple(rate)))
    assert demand.m_body_am2 == pytest.approx(pd_far(known, (), point, settings).m_body_am2, rel=1e-3)


def test_an_unknown_attitude_asks_for_nothing_and_forgets(bench, seen):
    settings = bench.config(bench.Body(), 1.0, {"pd_delayed": DelayGains()})
    demand = delayed(seen(700).replace(attitude=UNKNOWN), (0.0,) * 10, bench.setpoint(), settings)
    assert demand.m_body_am2 == (0.0, 0.0, 0.0)
    assert demand.memory == ()


@pytest.mark.long
@pytest.mark.parametrize(("delay_s", "low", "high"), [(60.0, 0.0, 0.3), (600.0, 30.0, 181.0)])
def test_it_converges_without_a_rate_while_the_delay_is_short(bench, turned, delay_s, low, high):
    run = bench.fly_from_rest(
        delayed,
        bench.setpoint(k_w=K_W, k_a=K_A),
        gains={"pd_delayed": DelayGains(delay_s)},
        body=bench.Body(most_am2=5.0),
        c_body_from_orbit=turned((1, 2, 3), 20.0),
        orbits=5.0,
        step_s=10.0,
        look=lambda inputs: inputs.replace(
            attitude=inputs.attitude.replace(omega_body_orbit_radps=(nan, nan, nan))
        ),
    )
    assert low <= run.angle_deg[-600:].max() < high


def test_no_delay_is_refused():
    with pytest.raises(ValueError, match="greater than 0"):
        DelayGains(0.0)
