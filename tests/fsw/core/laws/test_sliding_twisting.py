"""Super-twisting: the bent surface, its finite time with full control, and what the coils make of it."""

import numpy as np
import pytest

from fsw.core.laws.sliding_twisting import (
    SuperTwistingGains,
    bent,
    sliding_twisting,
    terminal_surface,
    twisting,
)

INERTIA = np.array([[1.02, 0.13, -0.09], [0.13, 1.85, 0.21], [-0.09, 0.21, 1.95]])
MOMENT, TICK_S = 4.82 / 3.0, 0.5


def test_the_surface_bends_with_the_power_and_the_sign():
    s = terminal_surface((1e-3, 0.0, -2e-3), (0.04, -0.25, 0.0), 0.01, 0.5, 0.1)
    assert s == pytest.approx((1e-3 + 0.01 * (0.2 + 0.004), -0.01 * (0.5 + 0.025), -2e-3))


def test_on_the_surface_the_error_ends_where_a_straight_one_would_only_decay():
    """dq/dt = -1/2 k |q|^p sign(q) from 0.1: at zero by t = 2 |q|^(1-p) / (k (1 - p))."""

    def left(power):
        q, k, step = 0.1, 1.0, 1e-3
        for _ in range(int(7.0 / step)):
            q -= step * 0.5 * k * bent(q, power)
        return abs(q)

    assert 2.0 * 0.1**0.2 / 0.2 < 7.0
    assert left(0.8) < 1e-9
    assert left(1.0) > 2e-3


def test_with_full_control_an_unknown_push_is_overcome_without_a_relay():
    """A double integral of the law on r' = u + d(t), |d'| < L: r ends near zero, and u has no jumps."""
    level, step_s, r, v = 1e-3, 0.05, np.array([0.05, -0.02, 0.03]), np.zeros(3)
    pushes, sizes = [], []
    for tick in range(6000):
        u = np.array(twisting(tuple(r), tuple(v), level))
        v = v - step_s * 1.1 * level * r / max(np.linalg.norm(r), 1e-12)
        r = r + step_s * (u + 0.02 * np.sin(0.03 * tick * step_s + np.arange(3)))
        pushes.append(u)
        sizes.append(np.linalg.norm(r))
    assert max(sizes[-2000:]) < 1e-4
    assert np.abs(np.diff(pushes[-2000:], axis=0)).max() < 0.1 * np.abs(pushes[-2000:]).max()


@pytest.fixture
def asked(bench, turned):
    orbit = bench.Orbit()
    c_body_from_eci = turned((1, -2, 3), 25.0) @ orbit.c_orbit_from_eci(700.0)
    inputs = bench.inputs_at(orbit, 700, 1.0, c_body_from_eci, np.array([1e-3, 2e-3, -1e-3]), None)

    def ask(memory=(), most_am2=5.0, **changed):
        own = {"sliding_twisting": SuperTwistingGains(**changed)}
        settings = bench.config(bench.Body(INERTIA, most_am2=most_am2), TICK_S, own)
        return inputs, sliding_twisting(inputs, memory, bench.setpoint(), settings)

    return ask


def test_torque_and_integral_are_those_of_the_equations(asked):
    """-1.5 L^(1/2) r / |r|^(1/2) + v less its part along the field, and v' = -1.1 L r / |r| - leak v."""
    v = np.array([2e-9, -5e-9, 4e-9])
    inputs, demand = asked(tuple(v))
    w0, q = inputs.reference.orbit_rate_radps, np.array(inputs.attitude.q_body_from_orbit)
    qv = q[1:] * np.sign(q[0])
    k = 0.15 * w0 * MOMENT
    s = INERTIA @ inputs.attitude.omega_body_orbit_radps + k * (np.abs(qv) ** 0.8 * np.sign(qv) + 0.5 * qv)
    n = np.array(inputs.b_body_t) / np.linalg.norm(inputs.b_body_t)
    r, level = (s - n * (n @ s)) / MOMENT, 0.03 * w0**3
    size = np.linalg.norm(r)
    wanted = MOMENT * (v - 1.5 * np.sqrt(level / size) * r)
    torque = np.cross(demand.m_body_am2, inputs.b_body_t)
    assert torque == pytest.approx(wanted - n * (n @ wanted), rel=1e-9)
    change = -1.1 * level * r / size - 0.3 * w0 * v
    assert np.array(demand.memory) - v == pytest.approx(TICK_S * change, rel=1e-6, abs=0.0)


def test_the_integral_is_limited_to_what_the_coils_can_hold(asked):
    memory, most_am2 = (), 1e-3
    for _ in range(200):
        inputs, demand = asked(memory, most_am2, level=1.0, leak=0.0)
        memory = demand.memory
    limit = most_am2 * np.linalg.norm(inputs.b_body_t) / MOMENT
    assert np.linalg.norm(memory) == pytest.approx(limit, rel=1e-6)


@pytest.mark.long
def test_the_attitude_converges(bench, turned):
    flight = bench.fly_from_rest(
        sliding_twisting,
        bench.setpoint(),
        gains={"sliding_twisting": SuperTwistingGains()},
        body=bench.Body(most_am2=5.0),
        c_body_from_orbit=turned((1, 2, 3), 20.0),
        orbits=5.0,
        step_s=10.0,
    )
    assert np.sqrt(np.mean(flight.angle_deg[-600:] ** 2)) < 1.5


@pytest.mark.parametrize(
    "changed",
    [{"power": 0.5}, {"power": 1.1}, {"slope": 0.0}, {"level": 0.0}, {"share": -1.0}, {"leak": -1.0}],
)
def test_gains_out_of_range_are_refused(changed):
    with pytest.raises(ValueError, match="must"):
        SuperTwistingGains(**changed)
