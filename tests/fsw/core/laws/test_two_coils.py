"""Two coils and a wheel: any torque, by the matrix of the three; and what becomes of it over the poles."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest

from fsw.core.algebra.quaternion import normalise
from fsw.core.estimation.attitude import Attitude
from fsw.core.laws.interface import FieldSample, Wheel
from fsw.core.laws.two_coils import TwoCoilsGains, two_coils, two_coils_and_wheel, two_coils_far
from fsw.core.laws.wheel_effort import Effort, compensated_torque, shortened, wanted_torque

B = (2.1e-5, -1.4e-5, 0.9e-5)
T = (2e-5, 5e-5, -3e-5)
WHEEL = Wheel((0.0, 0.0, 1.0), 2e-4, 2e-3, 0.12, 0.0, 0.0, tick_s=4.0, stale_ticks=10)
J = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))


def test_it_is_the_inverse_of_the_matrix_of_two_coils_and_a_wheel():
    b1, b2, b3 = B
    matrix = np.array([[0.0, b3, 0.0], [-b3, 0.0, 0.0], [b2, -b1, 1.0]])
    m1, m2, by_wheel = np.linalg.solve(matrix, T)
    effort = two_coils_and_wheel(T, B, (0.0, 0.0, 1.0))
    assert effort.m_body_am2 == pytest.approx((m1, m2, 0.0), rel=1e-12)
    assert effort.wheel_torque_nm == pytest.approx(-by_wheel, rel=1e-12)


def test_with_the_wheel_along_the_second_axis_it_is_the_reviews_matrix():
    """T = ((0, 0, -b2), (-b3, 1, b1), (b2, 0, 0)) (m1, wheel, m3)."""
    b1, b2, b3 = B
    m1, by_wheel, m3 = np.linalg.solve([[0.0, 0.0, -b2], [-b3, 1.0, b1], [b2, 0.0, 0.0]], T)
    effort = two_coils_and_wheel(T, B, (0.0, 1.0, 0.0))
    assert effort.m_body_am2 == pytest.approx((m1, 0.0, m3), rel=1e-12)
    assert effort.wheel_torque_nm == pytest.approx(-by_wheel, rel=1e-12)


@pytest.mark.parametrize("axis", [(0.48, -0.6, 0.64), (0.0, 0.0, -1.0)])
def test_the_whole_torque_is_given_whatever_the_wheels_axis(axis):
    m, wheel_nm = two_coils_and_wheel(T, B, axis)
    assert np.cross(m, B) - wheel_nm * np.array(axis) == pytest.approx(T, rel=1e-12)
    assert np.dot(m, axis) == pytest.approx(0.0, abs=1e-15)


def test_with_the_field_normal_to_the_wheel_there_is_no_solution():
    assert two_coils_and_wheel(T, (2e-5, -1e-5, 0.0), (0.0, 0.0, 1.0)) is None


@pytest.mark.parametrize(
    ("m_am2", "wheel_nm", "part"), [(4.0, 1e-3, 1.0), (16.0, 1e-3, 2.0), (4.0, -8e-3, 4.0)]
)
def test_an_effort_beyond_the_limits_is_shortened_and_not_turned(m_am2, wheel_nm, part):
    effort = shortened(Effort((0.0, m_am2, 0.0), wheel_nm), 8.0, 2e-3)
    assert effort.m_body_am2 == pytest.approx((0.0, m_am2 / part, 0.0))
    assert effort.wheel_torque_nm == pytest.approx(wheel_nm / part)


def test_the_torque_wanted_is_that_of_a_damped_spring():
    """By hand, of 10 deg about axis 2 and a rate about axis 1."""
    half = radians(5.0)
    attitude = Attitude((np.cos(half), 0.0, np.sin(half), 0.0), (1e-3, 0.0, 0.0), 0.0, 0.0, True)
    turning, damped = 0.02**2 * 2.0 * np.sin(half), 2.0 * 0.7 * 0.02 * 1e-3
    expected = -np.array(J) @ (damped, turning, 0.0)
    assert wanted_torque(attitude, J, 0.02, 0.7) == pytest.approx(expected, rel=1e-12)


def test_the_shorter_way_is_taken():
    q = normalise((0.9, 0.1, -0.2, 0.3))
    other = tuple(-part for part in q)
    there, back = (
        wanted_torque(Attitude(one, (0.0,) * 3, 0.0, 0.0, True), J, 0.02, 1.0) for one in (q, other)
    )
    assert there == pytest.approx(back, rel=1e-12)


def test_what_acts_at_the_goal_is_answered_at_once(bench, turned):
    """At rest in a turned attitude: omega x h of the wheel is added, and the estimated torque taken off."""
    orbit, tick, disturbance = bench.Orbit(500.0, 51.6), 100, (2e-7, -3e-7, 5e-7)
    c = turned((1, -2, 3), 20.0) @ orbit.c_orbit_from_eci(tick)
    omega = orbit.rate_radps * (c @ orbit.c_orbit_from_eci(tick).T)[:, 2]
    settings = bench.config(bench.Body(driven=WHEEL), 1.0)
    inputs = bench.inputs_at(orbit, tick, 1.0, c, omega, FieldSample())
    inputs = inputs.replace(wheel_nms=0.07, torque_body_nm=disturbance)
    spring = wanted_torque(inputs.attitude, settings.inertia_kgm2, 0.02, 0.7)
    added = np.cross(omega, (0.0, 0.0, 0.07)) - disturbance
    assert np.abs(added).min() > 1e-7
    assert compensated_torque(inputs, settings, 0.02, 0.7) == pytest.approx(
        np.array(spring) + added, rel=1e-9
    )
    assert compensated_torque(inputs.replace(reference=None), settings, 0.02, 0.7) == pytest.approx(
        np.array(spring) - disturbance, rel=1e-9
    )


def flown(bench, turned, law=two_coils, inclination_deg=51.6, first_deg=15.0, seconds=2000.0, **body):
    orbit = bench.Orbit(500.0, inclination_deg)
    return bench.fly(
        law,
        bench.setpoint("two_coils"),
        gains={"two_coils": TwoCoilsGains()},
        orbit=orbit,
        body=bench.Body(most_am2=8.0, driven=WHEEL, **body),
        c_body_from_orbit=turned((1, -2, 3), first_deg),
        omega_body=(0.0, 0.0, orbit.rate_radps),
        seconds=seconds,
    )


def test_in_an_inclined_orbit_it_turns_as_the_spring_says(bench, turned):
    """With nothing else acting: (1 + w_n t) exp(-w_n t) of a critically damped spring, all three axes."""
    flight = flown(bench, turned, gravity=False, first_deg=4.0, seconds=600.0)
    expected = 4.0 * (1.0 + 0.01 * flight.t_s) * np.exp(-0.01 * flight.t_s)
    assert flight.angle_deg == pytest.approx(expected, abs=0.15)
    assert np.abs(flight.m_body[:, 2]).max() == 0.0


@pytest.mark.long
def test_over_the_poles_it_fails(bench, turned):
    """The field's component along the orbit normal goes as the cosine of the inclination, the dipole as one
    over it; in a polar orbit there is none, and the axes are lost under a torque that is held elsewhere."""
    torque, efforts = (1e-6, -1e-6, 1e-6), {}
    for inclination_deg in (0.0, 60.0, 90.0):
        flight = flown(
            bench, turned, inclination_deg=inclination_deg, first_deg=1.0, seconds=5000.0, torque=torque
        )
        half = len(flight.t_s) // 2
        efforts[inclination_deg] = np.sqrt(np.mean(np.sum(flight.m_body[half:] ** 2, axis=1)))
        left_deg = flight.angle_deg[half:]
        if inclination_deg < 90.0:  # what the spring leaves of the torque, T / (J w_n^2)
            assert left_deg == pytest.approx(0.70, abs=0.01)
        else:
            assert left_deg.max() > 3.0
    assert efforts[60.0] == pytest.approx(2.0 * efforts[0.0], rel=0.1)
    assert efforts[90.0] > 0.9 * 8.0


@pytest.mark.parametrize(("most_am2", "most_nm"), [(8.0, 2e-5), (0.5, 2e-3)])
def test_beyond_what_motor_or_coils_give_the_torque_keeps_its_direction(bench, turned, most_am2, most_nm):
    orbit, wheel = bench.Orbit(500.0, 51.6), replace(WHEEL, max_torque_nm=most_nm)
    c = turned((1, -2, 3), 50.0) @ orbit.c_orbit_from_eci(100.0)
    settings = bench.config(
        bench.Body(np.array(J), most_am2=most_am2, driven=wheel), 1.0, {"two_coils": TwoCoilsGains()}
    )
    inputs = bench.inputs_at(orbit, 100, 1.0, c, np.zeros(3), FieldSample()).replace(wheel_nms=0.05)
    wanted = compensated_torque(inputs, settings, 0.01, 1.0)
    demand = two_coils(inputs, (), bench.setpoint(), settings)
    m, wheel_nm = np.array(demand.m_body_am2), demand.wheel_torque_nm
    given = np.cross(m, inputs.b_body_t) - wheel_nm * np.array(wheel.axis_body)
    part = np.dot(given, wanted) / np.dot(wanted, wanted)
    assert given == pytest.approx(part * np.array(wanted), rel=1e-9)
    assert 0.0 < part < 0.5
    assert max(np.linalg.norm(m) / most_am2, abs(wheel_nm) / most_nm) == pytest.approx(1.0)


def test_far_away_all_coils_help(bench, turned):
    """From 60 deg the wheel comes to be nearly normal to the field."""
    far = flown(bench, turned, law=two_coils_far, first_deg=60.0)
    assert far.angle_deg[-100:].max() < 0.5
    assert np.abs(far.m_body[:, 2]).max() > 0.1


@pytest.mark.parametrize("wrong", [{"frequency_radps": 0.0}, {"frequency_radps": 0.6}, {"damping": 0.0}])
def test_gains_out_of_range_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        TwoCoilsGains(**wrong)
