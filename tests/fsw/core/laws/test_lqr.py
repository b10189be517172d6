"""The periodic regulator: cheaper than PD, at rest with a constant torque, silent where it knows nothing."""

from dataclasses import replace
from math import isfinite, radians

import numpy as np
import pytest

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.interface import Demand, Wheel
from fsw.core.laws.lqr import (
    STEPS,
    LqrGains,
    balanced_pd,
    exact_torque,
    expected_torque,
    latitude_argument,
    lqr,
    node,
    rotation,
    schedule,
    within,
)
from fsw.core.laws.pd import pd, pd_far
from sim.design.theory.bodies import Body
from sim.design.theory.feedforward import least_error

K_W, K_A = 6.2694e6, 1614.9
MOST_AM2 = 2.0
INERTIA = np.diag([1.02, 1.85, 1.95])
TORQUE = (1e-7, 1e-7, 1e-7)
WEIGHTS = LqrGains()


@pytest.fixture(scope="module")
def settings(bench):
    orbit, body = bench.Orbit(), bench.Body(INERTIA, most_am2=MOST_AM2)
    ready = bench.config(body, 10.0)
    table = schedule(
        ready.inertia_kgm2,
        body.wheel,
        orbit.rate_radps,
        radians(orbit.inclination_deg),
        7.812e15 / orbit.radius_m**3,
        WEIGHTS,
    )
    return replace(ready, schedules={"lqr": table})


@pytest.fixture(scope="module")
def flight(bench, settings, turned):
    """A flight over some orbits from an angle about (1, 2, 3), by a law that may know the constant torque."""

    def fly(law, angle_deg=20.0, orbits=3.0, torque=(0.0, 0.0, 0.0), known=True):
        return bench.fly_from_rest(
            law,
            bench.setpoint(k_w=K_W, k_a=K_A),
            body=bench.Body(INERTIA, most_am2=MOST_AM2, torque=torque),
            c_body_from_orbit=turned((1, 2, 3), angle_deg),
            orbits=orbits,
            step_s=10.0,
            look=lambda inputs: inputs.replace(torque_body_nm=torque if known else (0.0, 0.0, 0.0)),
            settings=settings,
        )

    return fly


@pytest.fixture
def inputs(bench, turned):
    orbit, c = bench.Orbit(), turned((1, -2, 3), 15.0)
    c_body_from_eci = c @ orbit.c_orbit_from_eci(2000.0)
    before = bench.inputs_at(orbit, 199, 10.0, c_body_from_eci, np.zeros(3), None).sample
    return bench.inputs_at(orbit, 200, 10.0, c_body_from_eci, np.array([1e-4, 2e-4, 1.3e-3]), before)


def test_of_a_turned_body_the_gain_is_that_of_orbital_axes(bench, inputs, turned):
    """(Omega, theta, d) turned back to orbital axes, and the dipole turned to the body's."""
    oblique = np.array([[1.02, 0.13, -0.09], [0.13, 1.85, 0.21], [-0.09, 0.21, 1.95]])
    ready = bench.scheduled(bench.Body(oblique, most_am2=1e3), 10.0, "lqr")
    table, c, orbit = ready.schedules["lqr"], turned((1, -2, 3), 15.0), bench.Orbit()
    torque, rate = np.array([3e-6, -2e-6, 5e-6]), np.array([1e-4, 2e-4, 1.3e-3])
    relative = rate - orbit.rate_radps * c[:, 2]
    theta = 2.0 * np.sin(np.radians(7.5)) * np.array([1.0, -2.0, 3.0]) / np.sqrt(14.0)
    state = np.concatenate([c.T @ relative, theta, c.T @ (torque + table.problem.resting_nm)])
    step = int(orbit.rate_radps * 2000.0 * STEPS / (2.0 * np.pi))
    m = lqr(inputs.replace(torque_body_nm=tuple(torque)), (), bench.setpoint(), ready).m_body_am2
    assert m == pytest.approx(c @ table.gains[step] @ state, rel=1e-9)


def rms_deg(flown, orbits, last):
    """Root mean square of the angle over the last orbits of a flight."""
    rows = int(len(flown.t_s) * last / orbits)
    return float(np.sqrt(np.mean(flown.angle_deg[-rows:] ** 2)))


def cost(flown, effort):
    """The integral of |theta|^2 + effort |m|^2."""
    angles = np.radians(flown.angle_deg)
    return float(np.sum(angles**2 + effort * np.sum(flown.m_body**2, axis=1)))


@pytest.mark.long
def test_the_regulator_costs_less_than_the_best_pd(flight, settings):
    """Same start, same weights; PD has the gains with the best Floquet exponent."""
    effort = settings.schedules["lqr"].problem.effort
    by_lqr, by_pd = (cost(flight(law), effort) for law in (lqr, pd))
    assert by_lqr < 0.85 * by_pd


@pytest.mark.long
def test_the_regulator_points_from_thirty_degrees(flight):
    """The source: it works to errors of about 30 deg, though designed for small ones."""
    assert rms_deg(flight(lqr, angle_deg=30.0, orbits=5.0), orbits=5.0, last=1.0) < 0.1


@pytest.mark.long
def test_a_known_constant_torque_leaves_little_more_than_any_dipole_must(flight):
    """The least over all periodic dipoles: by least squares on the linearised motion, on the ground."""
    body = Body("50 kg", tuple(map(tuple, INERTIA.tolist())), 800.0, 98.6)
    least = np.degrees(least_error(body, TORQUE).rms_rad)
    known = rms_deg(flight(lqr, orbits=6.0, torque=TORQUE), orbits=6.0, last=1.0)
    assert 0.98 * least < known < 1.3 * least


@pytest.mark.long
def test_a_constant_torque_that_it_does_not_know_leaves_more(flight):
    unknown = rms_deg(flight(lqr, orbits=6.0, torque=TORQUE, known=False), orbits=6.0, last=1.0)
    by_pd = rms_deg(flight(pd, orbits=6.0, torque=TORQUE), orbits=6.0, last=1.0)
    assert unknown > 4.0
    assert by_pd > 4.0


def test_what_rests_on_an_oblique_body_is_reckoned_with(bench, settings, inputs):
    oblique = ((1.02, 0.05, 0.0), (0.05, 1.85, 0.0), (0.0, 0.0, 1.95))
    table = schedule(oblique, (0.0, 0.0, 0.0), 1.04e-3, radians(98.6), 2.1e-5, WEIGHTS)
    given = replace(settings, schedules={"lqr": table})
    rest = table.problem.resting_nm
    cancelled = inputs.replace(torque_body_nm=tuple(-part for part in rest))
    flat = replace(table, problem=replace(table.problem, resting_nm=(0.0, 0.0, 0.0)))
    without = replace(settings, schedules={"lqr": flat})
    point = bench.setpoint()
    assert np.linalg.norm(rest) > 1e-8
    assert lqr(cancelled, (), point, given) == lqr(inputs, (), point, without)
    assert lqr(inputs, (), point, given) != lqr(inputs, (), point, without)


def test_the_torque_of_a_driven_wheel_at_rest_is_what_turns_its_momentum_about_the_orbit_normal(
    bench, settings, inputs
):
    """d/dt of a vector at rest in axes that turn at w is w x h; the body bears the opposite."""
    axis, momentum_nms = (0.48, -0.6, 0.64), -0.03
    wheel = Wheel(axis, 2e-4, 2e-3, 0.12, 0.0, 0.0, tick_s=10.0, stale_ticks=10)
    driven, table = replace(settings, wheel=wheel), settings.schedules["lqr"]
    turned = inputs.replace(wheel_nms=momentum_nms, torque_body_nm=(3e-6, -2e-6, 5e-6))
    rate = np.array([0.0, 0.0, bench.Orbit().rate_radps])
    known = np.array(expected_torque(turned, table))
    seen = exact_torque(turned, turned.reference, table, driven)
    assert seen - known == pytest.approx(-np.cross(rate, momentum_nms * np.array(axis)), rel=1e-9, abs=1e-15)
    assert exact_torque(turned.replace(wheel_nms=None), turned.reference, table, driven) == tuple(known)


@pytest.mark.parametrize("t_s", [0.0, 700.0, 2500.0, 4000.0, 5900.0])
def test_the_argument_of_latitude_is_read_off_the_orbital_axes(bench, t_s):
    orbit = bench.Orbit()
    inputs = bench.inputs_at(orbit, 1, t_s, orbit.c_orbit_from_eci(t_s), np.zeros(3), None)
    u = orbit.rate_radps * t_s
    assert np.exp(1j * latitude_argument(inputs.reference)) == pytest.approx(np.exp(1j * u), abs=1e-9)


@pytest.mark.parametrize(
    ("part", "expected"),
    [(0.0, 0), (-1e-12, STEPS - 1), (1.01 / STEPS, 1), (0.5, STEPS // 2), (1.0 - 1e-5, STEPS - 1), (1.01, 0)],
)
def test_each_argument_of_latitude_has_its_step(part, expected):
    """The argument as a part of an orbit."""
    assert node(2.0 * np.pi * part) == expected


def test_a_dipole_beyond_the_bound_is_shortened_and_keeps_its_direction():
    assert within((3.0, -6.0, 1.5), 2.0) == pytest.approx((1.0, -2.0, 0.5))
    assert within((1.0, -1.9, 0.5), 2.0) == (1.0, -1.9, 0.5)


def test_the_bound_of_the_coils_holds(bench, settings, inputs):
    tight = replace(settings, mean_dipole_am2=1e-3)
    m = lqr(inputs, (), bench.setpoint(), tight).m_body_am2
    assert max(map(abs, m)) == pytest.approx(1e-3)


@pytest.mark.parametrize("missing", ["attitude", "reference", "schedule"])
def test_without_knowledge_nothing_is_asked_for(bench, settings, inputs, missing):
    given = settings if missing != "schedule" else replace(settings, schedules={})
    if missing == "attitude":
        inputs = inputs.replace(attitude=UNKNOWN)
    if missing == "reference":
        inputs = inputs.replace(reference=None)
    assert lqr(inputs, (), bench.setpoint(), given).m_body_am2 == (0.0, 0.0, 0.0)


def test_with_knowledge_something_finite_is(bench, settings, inputs):
    m = lqr(inputs, (), bench.setpoint(), settings).m_body_am2
    assert all(map(isfinite, m))
    assert any(m)


def test_far_from_the_goal_the_pd_law_flies_and_leaves_no_memory(bench, settings, inputs):
    point = bench.setpoint(k_w=K_W, k_a=K_A, k_i=0.08)
    foreign = tuple(float(k) for k in range(136))
    demand = balanced_pd(inputs, foreign, point, settings)
    assert demand.m_body_am2 == pd_far(inputs, (), point, settings).m_body_am2
    assert demand.memory == ()


def test_far_from_the_goal_the_estimated_torque_is_taken_off_as_far_as_it_can_be(bench, settings, inputs):
    """What is left of it lies along the field."""
    point, torque = bench.setpoint(k_w=K_W, k_a=K_A), np.array([3e-6, -2e-6, 5e-6])
    without = np.array(balanced_pd(inputs, (), point, settings).m_body_am2)
    balanced = inputs.replace(torque_body_nm=tuple(torque.tolist()))
    taken_off = np.array(balanced_pd(balanced, (), point, settings).m_body_am2) - without
    b = np.array(inputs.b_body_t)
    left = torque + np.cross(taken_off, b)
    np.testing.assert_allclose(np.cross(left, b), 0.0, atol=1e-18)
    assert abs(taken_off @ b) < 1e-12


def test_far_from_the_goal_nothing_is_asked_for_without_an_attitude(bench, settings, inputs):
    blind = inputs.replace(attitude=UNKNOWN, torque_body_nm=TORQUE)
    assert balanced_pd(blind, (), bench.setpoint(k_w=K_W, k_a=K_A), settings) == Demand()


def test_both_signs_of_a_quaternion_are_one_turn():
    q = (0.8, 0.1, -0.35, 0.477)
    assert rotation(q) == pytest.approx((0.2, -0.7, 0.954))
    assert rotation(tuple(-part for part in q)) == rotation(q)
