"""Sliding control: the surface is reached and the attitude follows; integrals answer what is constant."""

from math import isfinite

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.projection import torque_dipole
from fsw.core.laws.sliding import SlidingGains, SlidingIntegralGains, lost_torque, surface
from fsw.core.laws.table import LAWS

INERTIA = np.diag([1.02, 1.85, 1.95])
UNEVEN = np.array([[1.02, 0.13, -0.09], [0.13, 1.85, 0.21], [-0.09, 0.21, 1.95]])
"""The same with products of inertia."""
TICK_S = 0.5
MOMENT = 4.82 / 3.0
MOST_AM2 = 5.0
TORQUE = (1e-7, 1e-7, 1e-7)
OWN = {"sliding": SlidingGains, "sliding_integral": SlidingIntegralGains}

component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.filter(lambda v: np.linalg.norm(v) > 0.1).map(lambda v: tuple(4e-5 * c for c in v))
torques = vectors.map(lambda v: tuple(1e-5 * c for c in v))


@pytest.fixture(scope="module")
def flight(bench, turned):
    """From 20 deg off."""

    def fly(name, own=None, orbits=5.0, torque=(0.0, 0.0, 0.0)):
        return bench.fly_from_rest(
            LAWS[name].point,
            bench.setpoint(),
            gains={name: own or OWN[name]()},
            body=bench.Body(INERTIA, most_am2=MOST_AM2, torque=torque),
            c_body_from_orbit=turned((1, 2, 3), 20.0),
            orbits=orbits,
            step_s=10.0,
        )

    return fly


@pytest.fixture
def inputs(bench, turned):
    orbit = bench.Orbit()
    c_body_from_eci = turned((1, -2, 3), 25.0) @ orbit.c_orbit_from_eci(700.0)
    return bench.inputs_at(orbit, 700, 1.0, c_body_from_eci, np.array([1e-3, 2e-3, -1e-3]), None)


@pytest.fixture
def asked(bench):
    def ask(name, inputs, memory=(), own=None, most_am2=MOST_AM2):
        settings = bench.config(bench.Body(UNEVEN, most_am2=most_am2), TICK_S, {name: own or OWN[name]()})
        return LAWS[name].point(inputs, memory, bench.setpoint(), settings)

    return ask


def rms_deg(run, orbits):
    """Over the last orbit."""
    return float(np.sqrt(np.mean(run.angle_deg[-int(len(run.t_s) / orbits) :] ** 2)))


def surfaces(run, rate_radps):
    """J Omega + K q along a flight, in w0 J, small angles."""
    c = run.c_body_from_orbit
    twice = np.stack([c[:, 1, 2] - c[:, 2, 1], c[:, 2, 0] - c[:, 0, 2], c[:, 0, 1] - c[:, 1, 0]], axis=1)
    momentum = run.relative_body @ INERTIA
    return np.linalg.norm(momentum / (rate_radps * MOMENT) + SlidingGains().slope * 0.25 * twice, axis=1)


def test_both_integrals_grow_by_what_they_are_of(inputs, asked):
    """The attitude, and the torque along the field that the coils cannot give."""
    gains = SlidingIntegralGains(lost=0.3)
    held, w0 = np.array([2e-6, -1e-6, 3e-6, -2e-6, 1e-6, 4e-6]), inputs.reference.orbit_rate_radps
    memory = np.array(asked("sliding_integral", inputs, tuple(held), gains).memory)
    q0, *vector = inputs.attitude.q_body_from_orbit
    vector = np.copysign(1.0, q0) * np.array(vector)
    mean = held[:3] + gains.integral * w0**2 * MOMENT * TICK_S * vector
    momentum = UNEVEN @ inputs.attitude.omega_body_orbit_radps
    s = momentum + gains.slope * w0 * MOMENT * vector + mean + held[3:]
    b = np.array(inputs.b_body_t)
    lost = b * (b @ (-gains.reach * w0 * s)) / (b @ b)
    assert memory[:3] == pytest.approx(mean, rel=1e-9)
    assert memory[3:] - held[3:] == pytest.approx(gains.lost * TICK_S * lost, rel=1e-6)
    assert np.linalg.norm(lost) > 1e-9


@pytest.mark.parametrize("first", [0, 3])
def test_an_integral_beyond_what_the_coils_give_keeps_its_direction(inputs, asked, first):
    held = np.zeros(6)
    held[first : first + 3] = (0.3, -0.4, 1.2)
    kept = np.array(asked("sliding_integral", inputs, tuple(held)).memory)[first : first + 3]
    assert np.linalg.norm(kept) < 0.1
    assert kept / np.linalg.norm(kept) == pytest.approx(held[first : first + 3] / 1.3, abs=0.02)


def test_the_surface_is_that_of_the_source():
    assert surface((1e-3, -2e-3, 0.0), (0.1, 0.2, -0.3), 0.01) == pytest.approx((2e-3, 0.0, -3e-3), abs=1e-18)


@given(torques, fields)
def test_what_coils_give_and_what_is_lost_is_the_whole_torque(torque, b):
    """So with the lost part integrated, ds/dt is what full control would make it."""
    given_ = np.cross(torque_dipole(torque, b), b)
    assert given_ + lost_torque(torque, b) == pytest.approx(torque, abs=1e-17)


def test_without_a_field_the_whole_torque_is_lost():
    assert lost_torque((1e-6, 2e-6, 3e-6), (0.0, 0.0, 0.0)) == (1e-6, 2e-6, 3e-6)


def test_the_torque_asked_for_is_parallel_to_the_surface(bench, inputs, asked):
    """Its projection is what flies."""
    m = np.array(asked("sliding", inputs).m_body_am2)
    w0, own = inputs.reference.orbit_rate_radps, SlidingGains()
    omega, q = inputs.attitude.omega_body_orbit_radps, inputs.attitude.q_body_from_orbit
    s = UNEVEN @ omega + own.slope * w0 * MOMENT * np.array(q[1:]) * np.sign(q[0])
    unit = np.array(inputs.b_body_t) / np.linalg.norm(inputs.b_body_t)
    wanted = -own.reach * w0 * s
    assert np.cross(m, inputs.b_body_t) == pytest.approx(wanted - unit * (unit @ wanted), rel=1e-9)


@pytest.mark.long
def test_the_surface_is_reached_and_the_attitude_follows(bench, flight):
    run = flight("sliding")
    orbit = bench.Orbit()
    off = surfaces(run, orbit.rate_radps)
    second = int(2.0 * orbit.period_s / 10.0)
    assert off[second:].max() < 0.02 * off[:60].max()
    assert run.angle_deg[second:].max() < 1.0
    assert rms_deg(run, 5.0) < 0.01


@pytest.mark.long
def test_on_the_mean_a_constant_torque_is_answered_by_the_integral(flight):
    """Claimed by the source for the surface with integrals."""
    plain = rms_deg(flight("sliding", torque=TORQUE), 5.0)
    own = rms_deg(flight("sliding_integral", torque=TORQUE), 5.0)
    assert plain > 10.0
    assert own < 2.5


def test_without_integrals_both_laws_are_one(inputs, asked):
    own = SlidingIntegralGains(integral=0.0, lost=0.0)
    assert asked("sliding_integral", inputs, own=own).m_body_am2 == asked("sliding", inputs).m_body_am2


def test_a_lost_torque_is_remembered_where_it_counts(inputs, asked):
    """It moves the surface by what no dipole could give, along b."""
    own = SlidingIntegralGains(integral=0.0, lost=1.0)
    first = asked("sliding_integral", inputs, own=own)
    missed = np.array(first.memory[3:])
    assert np.linalg.norm(missed) > 0.0
    assert np.cross(missed, inputs.b_body_t) == pytest.approx(np.zeros(3), abs=1e-20)


@pytest.mark.parametrize("lost", [0.0, 1.0])
def test_integrals_are_limited_to_what_the_coils_can_hold(inputs, asked, lost):
    own, memory, most_am2 = SlidingIntegralGains(integral=1e3, lost=lost), (), 1e-4
    for _ in range(300):
        memory = asked("sliding_integral", inputs, memory, own, most_am2).memory
    limit = most_am2 * np.linalg.norm(inputs.b_body_t) / (own.reach * inputs.reference.orbit_rate_radps)
    assert np.linalg.norm(memory[:3]) == pytest.approx(limit)
    assert np.linalg.norm(memory[3:]) <= limit * (1.0 + 1e-12)


@pytest.mark.parametrize("name", OWN)
@pytest.mark.parametrize("missing", ["attitude", "reference"])
def test_without_knowledge_nothing_is_asked_for_and_integrals_stay(inputs, asked, name, missing):
    held = (1e-6, 2e-6, 3e-6, -1e-6, -2e-6, -3e-6) if name == "sliding_integral" else ()
    less = inputs.replace(**{missing: UNKNOWN if missing == "attitude" else None})
    demand = asked(name, less, held)
    assert demand.m_body_am2 == (0.0, 0.0, 0.0)
    assert demand.memory == held


@pytest.mark.parametrize("name", OWN)
def test_without_a_field_nothing_is_asked_for(inputs, asked, name):
    demand = asked(name, inputs.replace(b_body_t=(0.0, 0.0, 0.0)))
    assert demand.m_body_am2 == (0.0, 0.0, 0.0)
    assert all(map(isfinite, demand.memory))


@pytest.mark.parametrize("foreign", [(1.0, 2.0, 3.0), (1.0,) * 136])
def test_another_laws_memory_is_not_read(inputs, asked, foreign):
    assert asked("sliding_integral", inputs, foreign) == asked("sliding_integral", inputs, ())
