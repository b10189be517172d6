"""Two turns across the field for one about it: the split is exact, and a sphere over the equator makes it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.algebra.quaternion import conjugate, multiply, normalise
from fsw.core.laws.pd import far_error, pd_dipole, pd_far
from fsw.core.laws.predictive import free_change
from fsw.core.laws.two_step import FIRST, FREE, SECOND, TwoStepGains, first_turn, two_step

SPHERE = np.diag([1.6, 1.6, 1.6])
K_W, K_A = 6.2694e6, 1614.9
component = st.floats(-1.0, 1.0, allow_subnormal=False)
directions = st.tuples(component, component, component).filter(lambda v: np.linalg.norm(v) > 0.1)
quaternions = st.tuples(component, component, component, component).filter(
    lambda q: np.linalg.norm(q) > 0.1 and np.linalg.norm(q[1:]) > 0.01
)


@pytest.mark.long
@given(quaternions, directions)
def test_both_turns_are_across_the_field_and_make_the_whole(q, n):
    q, n = normalise(q), tuple((np.array(n) / np.linalg.norm(n)).tolist())
    p = first_turn(q, n)
    a = multiply(q, conjugate(p))
    assert np.linalg.norm(p) == pytest.approx(1.0)
    assert np.dot(p[1:], n) == pytest.approx(0.0, abs=1e-9)
    assert np.dot(a[1:], n) == pytest.approx(0.0, abs=1e-7)
    assert abs(a[0]) == pytest.approx(abs(p[0]), abs=1e-7)


@pytest.mark.long
@given(quaternions, directions)
def test_of_both_signs_the_smaller_turns_are_taken(q, n):
    """Of q and -q the one with the lesser s^2 = 1 - p0^2."""
    q, n = normalise(q), tuple((np.array(n) / np.linalg.norm(n)).tolist())
    z = float(np.dot(q[1:], n))
    least = min(((1.0 - s) ** 2 + z * z) / (2.0 * (1.0 - s)) for s in (q[0], -q[0]) if s < 1.0)
    assert 1.0 - first_turn(q, n)[0] ** 2 == pytest.approx(least, abs=1e-7)


def test_a_turn_about_the_field_alone_takes_two_half_turns():
    p = first_turn(normalise((0.98, 0.0, 0.0, 0.2)), (0.0, 0.0, 1.0))
    assert p[0] == pytest.approx(0.0, abs=1e-7)


@pytest.fixture(scope="module")
def fly(bench, turned):
    def run(law, inclination_deg=0.0, orbits=3.0):
        return bench.fly_from_rest(
            law,
            bench.setpoint(k_w=K_W, k_a=K_A),
            gains={"two_step": TwoStepGains()},
            orbit=bench.Orbit(inclination_deg=inclination_deg),
            body=bench.Body(SPHERE, most_am2=5.0),
            c_body_from_orbit=turned((0.2, 0.1, 1.0), 40.0),
            orbits=orbits,
            step_s=10.0,
        )

    return run


@pytest.mark.long
def test_over_the_equator_it_brings_a_sphere_home_where_pd_cannot(fly):
    """The claim of the source: three axes although the field never turns."""
    plain, own = fly(pd_far), fly(two_step)
    assert plain.angle_deg[-100:].min() > 35.0
    assert own.angle_deg.max() > 100.0
    assert own.angle_deg[-600:].max() < 2.0


@pytest.fixture
def asked(bench, turned):
    orbit = bench.Orbit(inclination_deg=0.0)
    settings = bench.config(bench.Body(SPHERE), 1.0, {"two_step": TwoStepGains()})

    def ask(q, memory=(), rate=0.0):
        c = turned((0, 0, 1), 0.0) @ orbit.c_orbit_from_eci(700.0)
        inputs = bench.inputs_at(orbit, 700, 1.0, c, np.zeros(3), None)
        attitude = inputs.attitude.replace(q_body_from_orbit=q, omega_body_orbit_radps=(rate, 0.0, 0.0))
        return two_step(inputs.replace(attitude=attitude), memory, bench.setpoint(k_w=K_W, k_a=K_A), settings)

    c = turned((0, 0, 1), 0.0) @ orbit.c_orbit_from_eci(700.0)
    field = np.array(bench.inputs_at(orbit, 700, 1.0, c, np.zeros(3), None).b_body_t)
    ask.field_body = field / np.linalg.norm(field)
    return ask


def test_the_stages_follow_each_other_at_rest_only(asked):
    away = normalise((0.9, 0.1, 0.0, 0.4))
    first = asked(away)
    stage, *p = first.memory
    assert stage == FIRST
    assert asked(tuple(p), first.memory, rate=0.01).memory[0] == FIRST
    second = asked(tuple(p), first.memory)
    assert second.memory == (SECOND, *p)
    assert asked((1.0, 0.0, 0.0, 0.0), second.memory).memory[0] == FREE


def test_a_turn_is_done_though_the_body_is_turned_about_the_field(asked):
    """What is off about the field is the other turn's."""
    field = asked.field_body
    about = (np.cos(0.3), *(np.sin(0.3) * field))
    across = np.cross(field, (1.0, 0.0, 0.0))
    stage, *p = asked(normalise((0.9, 0.1, 0.0, 0.4))).memory
    assert stage == FIRST
    assert asked(multiply(tuple(p), about), (stage, *p)).memory == (SECOND, *p)
    off = (np.cos(0.3), *(np.sin(0.3) * across / np.linalg.norm(across)))
    assert asked(multiply(tuple(p), off), (stage, *p)).memory == (FIRST, *p)


def test_a_small_turn_about_the_field_is_left(asked):
    assert asked(normalise((0.99, 0.1, 0.0, 0.05))).memory[0] == FREE


@pytest.mark.parametrize("stage", [FREE, FIRST, SECOND])
def test_in_both_turns_what_would_bend_the_path_is_taken_off(bench, turned, stage):
    """The torque across the field is that of the PD law to the end of the turn, less J f while it turns."""
    orbit, inertia = bench.Orbit(), np.array([[1.02, 0.13, -0.09], [0.13, 1.85, 0.21], [-0.09, 0.21, 1.95]])
    settings = bench.config(bench.Body(inertia), 1.0, {"two_step": TwoStepGains(begin_deg=170.0)})
    c = turned((1, -2, 3), 30.0) @ orbit.c_orbit_from_eci(700.0)
    inputs = bench.inputs_at(orbit, 700, 1.0, c, np.array([4e-3, 2e-3, -1e-3]), None)
    goal = normalise((0.9, 0.2, -0.3, 0.1))
    m = two_step(inputs, (stage, *goal), bench.setpoint(k_w=K_W, k_a=K_A), settings).m_body_am2
    attitude, b = inputs.attitude, np.array(inputs.b_body_t)
    q = attitude.q_body_from_orbit
    off = far_error(multiply(conjugate(goal), q) if stage == FIRST else q)
    plain = np.cross(pd_dipole(inputs.b_body_t, attitude.omega_body_orbit_radps, off, K_W, K_A), b)
    bending = inertia @ free_change(inputs, inputs.reference, settings) if stage != FREE else np.zeros(3)
    assert np.linalg.norm(bending) > 1e-6 or stage == FREE
    assert np.cross(m, b) - plain == pytest.approx(b * (b @ bending) / (b @ b) - bending, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("changed", [{"begin_deg": 2.0}, {"done_deg": 0.0}, {"done_degps": 0.0}])
def test_gains_out_of_range_are_refused(changed):
    with pytest.raises(ValueError, match="done_deg"):
        TwoStepGains(**changed)
