"""Momentum to a direction in space: errors only shrink, and flights end at the target."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.interface import FieldSample
from fsw.core.laws.spin_axis import (
    SpinAxisGains,
    TargetGains,
    ThreeTermGains,
    relay_dipole,
    reorientation,
    reorientation_dipole,
    spin_relay,
    three_term,
    three_term_dipole,
)
from fsw.core.laws.table import LAWS

TARGET = (0.3, -0.5, 0.8)
INERTIA = np.diag([2.0, 1.0, 1.0])
AIM = {"axis": 1.0, "target_1": TARGET[0], "target_2": TARGET[1], "target_3": TARGET[2]}
GAINS = {
    "spin_relay": TargetGains(**AIM),
    "reorientation": SpinAxisGains(**AIM, k_h=3e6),
    "three_term": ThreeTermGains(**AIM),
}
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.map(lambda v: tuple(4e-5 * c for c in v))
axes = st.integers(0, 2)


@pytest.fixture(scope="module")
def spinning(bench):
    def fly(law, omega, orbits, most_am2, step_s=3.0, spin_radps=0.1):
        orbit = bench.Orbit()
        return bench.fly(
            law,
            bench.setpoint(k_w=3e6, spin_radps=spin_radps),
            gains=GAINS,
            orbit=orbit,
            body=bench.Body(inertia=INERTIA, gravity=False, most_am2=most_am2),
            omega_body=omega,
            seconds=orbits * orbit.period_s,
            step_s=step_s,
        )

    return fly


class TestTorques:
    @pytest.mark.long
    @given(fields, vectors)
    def test_each_coil_of_the_relay_takes_the_error_down_or_is_off(self, b, error):
        m = np.array(relay_dipole(b, error, 2.5))
        assert set(np.abs(m)) <= {0.0, 2.5}
        for j in range(3):
            torque = np.cross(m[j] * np.eye(3)[j], b)
            assert torque @ np.array(error) >= -1e-20

    def test_the_sign_of_the_relay_is_that_of_the_equation(self):
        """m_j = m0 where dh . (e_j x b) > 0."""
        b, error = (1.7e-5, -2.3e-5, 3.1e-5), (0.2, 0.1, -0.3)
        expected = [2.5 * np.sign(np.dot(error, np.cross(np.eye(3)[j], b))) for j in range(3)]
        assert relay_dipole(b, error, 2.5) == tuple(expected)

    @given(fields, vectors, axes)
    def test_reorientation_shortens_the_error_by_one_coil_and_leaves_the_spin(self, b, error, axis):
        m = np.array(reorientation_dipole(b, error, axis, 1e6))
        torque = np.cross(m, b)
        assert np.count_nonzero(m) <= 1
        assert torque @ np.array(error) >= -1e-18
        assert torque[axis] == 0.0

    @pytest.mark.long
    @given(fields, vectors, vectors, st.floats(-1.0, 1.0), axes)
    def test_the_three_terms_give_their_torque_normal_to_the_field(self, b, rate, error, spin, axis):
        e = np.eye(3)[axis]
        across = np.array(rate) - rate[axis] * e
        wanted = -3e6 * across + 2e6 * spin * e + 1e6 * np.array(error)
        torque = np.cross(three_term_dipole(b, rate, spin, error, axis, 3e6, 2e6, 1e6), b)
        normal = np.dot(b, b) * wanted - np.dot(b, wanted) * np.array(b)
        np.testing.assert_allclose(torque, normal, rtol=1e-9, atol=1e-14)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_of_any_body_the_three_terms_are_of_its_momentum_about_its_own_axis(bench, turned, axis):
    """Products of inertia, a wheel across the axis, and another spin than the one wanted."""
    inertia = np.array([[1.02, 0.13, -0.09], [0.13, 1.85, 0.21], [-0.09, 0.21, 1.95]])
    orbit, wheel, omega = bench.Orbit(), np.array([0.01, -0.02, 0.03]), np.array([0.02, -0.03, 0.05])
    c_body_from_eci = turned((1, -2, 3), 40.0) @ orbit.c_orbit_from_eci(700.0)
    inputs = bench.inputs_at(orbit, 700, 1.0, c_body_from_eci, omega, FieldSample())
    gains = ThreeTermGains(axis + 1.0, *TARGET, k_h=1e6, k_spin=2e6)
    settings = bench.config(bench.Body(inertia, tuple(wheel.tolist())), 1.0, {"three_term": gains})
    m = three_term(inputs, (), bench.setpoint(k_w=3e6, spin_radps=0.06), settings).m_body_am2
    e, h = np.eye(3)[axis], inertia @ omega + wheel
    size = e @ (0.06 * inertia @ e + wheel)
    target = c_body_from_eci @ TARGET / np.linalg.norm(TARGET)
    wanted = 2e6 * (size - h[axis]) * e + 1e6 * (size * target - h) - 3e6 * (omega - omega[axis] * e)
    assert m == pytest.approx(np.cross(inputs.b_body_t, wanted), rel=1e-9)


@pytest.mark.long
class TestFlights:
    def test_reorientation_turns_the_momentum_and_keeps_its_size(self, spinning):
        run = spinning(reorientation, (0.05, 0.0, 0.0), orbits=2, most_am2=5.0)
        angle_deg = run.angle_to_deg(TARGET)
        assert angle_deg[0] > 60.0
        assert angle_deg[-1] < 10.0
        assert np.all(np.diff(angle_deg) < 0.02)
        np.testing.assert_allclose(run.omega_body[:, 0], 0.05, rtol=1e-6)

    def test_three_terms_damp_spin_up_and_turn_at_once(self, spinning):
        run = spinning(three_term, (0.02, 0.04, -0.05), orbits=2, most_am2=5.0)
        assert run.angle_to_deg(TARGET)[-1] < 0.3
        assert run.axis_to_deg(0, TARGET)[-1] < 0.3
        assert run.omega_body[-1, 0] == pytest.approx(0.1, rel=3e-3)
        assert np.linalg.norm(run.omega_body[-1, 1:]) < 5e-4

    def test_three_terms_about_the_third_axis_of_a_body_that_is_not_symmetric(self, bench):
        """With a wheel along that axis and gravity gradient."""
        orbit, body = bench.Orbit(), bench.Body(np.diag([1.02, 1.85, 1.95]), (0.0, 0.0, 0.03), 5.0)
        run = bench.fly(
            three_term,
            bench.setpoint(k_w=3e6, spin_radps=0.06),
            gains={"three_term": ThreeTermGains(3.0, *TARGET)},
            orbit=orbit,
            body=body,
            omega_body=(0.02, 0.01, -0.01),
            seconds=1.5 * orbit.period_s,
        )
        assert run.angle_to_deg(TARGET)[-1] < 1.0
        assert run.axis_to_deg(2, TARGET)[-1] < 1.0
        assert run.omega_body[-1] == pytest.approx((0.0, 0.0, 0.06), abs=6e-4)

    def test_the_relay_does_the_same_with_coils_fully_on(self, spinning):
        run = spinning(spin_relay, (0.02, 0.04, -0.05), orbits=2.5, most_am2=1.0)
        assert set(np.abs(run.m_body).ravel()) == {1.0}
        assert run.angle_to_deg(TARGET)[-1] < 3.0
        assert run.axis_to_deg(0, TARGET)[-1] < 3.0
        assert run.omega_body[-1, 0] == pytest.approx(0.1, rel=0.03)
        assert np.linalg.norm(run.omega_body[-1, 1:]) < 2e-3

    @pytest.mark.parametrize("law", [three_term, spin_relay])
    def test_a_negative_spin_brings_the_momentum_to_the_same_target(self, spinning, law):
        """The axis ends against it."""
        run = spinning(law, (-0.02, 0.04, -0.05), orbits=2.5, most_am2=1.0, spin_radps=-0.1)
        assert run.angle_to_deg(TARGET)[-1] < 3.0
        assert run.axis_to_deg(0, TARGET)[-1] > 177.0
        assert run.omega_body[-1, 0] == pytest.approx(-0.1, rel=0.03)

    def test_the_two_errors_of_the_relay_only_shrink(self, spinning):
        """(|L1|^2 + |L2|^2) / 2 for a body symmetric about its spin axis, before the relay chatters."""
        run = spinning(spin_relay, (0.02, 0.04, -0.05), orbits=0.5, most_am2=1.0)
        target, size = np.array(TARGET) / np.linalg.norm(TARGET), 0.1 * INERTIA[0, 0]
        in_space = size * target - run.momentum_eci
        in_body = size * np.eye(3)[0] - run.omega_body @ INERTIA
        value = np.sum(in_space**2, axis=1) + np.sum(in_body**2, axis=1)
        assert np.all(np.diff(value) < 1e-4 * value[0])
        assert value[-1] < 0.5 * value[0]


@pytest.mark.parametrize("name", ["reorientation", "three_term"])
@pytest.mark.parametrize("axis", [1, 2, 3])
def test_at_the_goal_nothing_is_left_to_do(bench, turned, name, axis):
    """Spin and momentum about the axis, wheel included, along the target."""
    e = np.eye(3)[axis - 1]
    target = turned((1, -2, 3), 70.0).T @ e
    gains = (
        ThreeTermGains(float(axis), *target) if name == "three_term" else SpinAxisGains(float(axis), *target)
    )
    body = bench.Body(inertia=np.diag([1.02, 1.85, 1.95]), wheel=tuple(0.3 * e))
    inputs = bench.inputs_at(bench.Orbit(), 700, 1.0, turned((1, -2, 3), 70.0), 0.04 * e, FieldSample())
    point, settings = bench.setpoint(spin_radps=0.04), bench.config(body, 1.0, {name: gains})
    reached = LAWS[name].point(inputs, (), point, settings).m_body_am2
    assert reached == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


class TestGains:
    def test_a_target_without_direction_is_no_target(self):
        with pytest.raises(ValueError, match="zero vector"):
            ThreeTermGains(target_3=0.0)

    def test_the_axis_is_checked_here_too(self):
        with pytest.raises(ValueError, match="body axis 1, 2 or 3"):
            ThreeTermGains(axis=7.0)

    def test_the_target_is_a_unit_vector(self):
        np.testing.assert_allclose(SpinAxisGains(target_1=3.0, target_3=-4.0).target_eci, (0.6, 0.0, -0.8))
