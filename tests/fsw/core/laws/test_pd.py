"""The PD dipole law: the equation, what its torque does, and where it is blind."""

from dataclasses import replace
from math import pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fsw.core.algebra.quaternion import IDENTITY, dcm
from fsw.core.algebra.vector import ZERO
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.laws.interface import ControlConfig, Demand, FieldSample, LawInput, Setpoint
from fsw.core.laws.pd import (
    acquisition_error,
    attitude_error,
    far_error,
    integrate_error,
    pd,
    pd_dipole,
    pd_far,
)
from fsw.core.orbit.ephemeris import Reference

K_W, K_A = 6.2694e6, 1614.9
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.map(lambda v: tuple(4e-5 * c for c in v))
rates = vectors.map(lambda v: tuple(0.02 * c for c in v))
directions = vectors.filter(lambda v: np.linalg.norm(v) > 0.1).map(lambda v: np.array(v) / np.linalg.norm(v))


def c_body_from_orbit(rotation_rad):
    """Ours turns axes: the transpose of scipy's."""
    return tuple(map(tuple, Rotation.from_rotvec(rotation_rad).as_matrix().T.tolist()))


@pytest.mark.long
@given(fields, rates, vectors)
def test_the_equation(b, omega, error):
    """m = -k_w b x Omega - k_a b x S."""
    expected = -K_W * np.cross(b, omega) - K_A * np.cross(b, error)
    np.testing.assert_allclose(pd_dipole(b, omega, error, K_W, K_A), expected, rtol=1e-9, atol=1e-12)


@pytest.mark.long
@given(directions, st.floats(0.0, pi))
def test_the_error_is_2_sin_theta_about_the_axis_of_the_turn(axis, angle_rad):
    error = attitude_error(c_body_from_orbit(angle_rad * axis))
    np.testing.assert_allclose(error, 2.0 * sin(angle_rad) * axis, atol=1e-14)


def test_near_zero_the_error_is_twice_the_turn():
    turn = np.array([1e-5, -2e-5, 3e-5])
    np.testing.assert_allclose(attitude_error(c_body_from_orbit(turn)), 2.0 * turn, rtol=1e-8)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, -0.48, 0.64)])
def test_at_180_deg_the_law_is_blind(axis):
    error = attitude_error(c_body_from_orbit(pi * np.array(axis)))
    np.testing.assert_allclose(error, 0.0, atol=1e-15)


@given(fields, vectors)
def test_the_torque_opposes_the_part_of_the_error_normal_to_the_field(b, error):
    """m x b = -k_a (b^2 S - (b.S) b)."""
    torque = np.cross(pd_dipole(b, (0.0, 0.0, 0.0), error, K_W, K_A), b)
    normal = np.dot(b, b) * np.array(error) - np.dot(b, error) * np.array(b)
    np.testing.assert_allclose(torque, -K_A * normal, rtol=1e-9, atol=1e-18)
    assert np.dot(torque, error) <= 1e-18


@pytest.mark.long
@given(fields, rates, vectors)
def test_no_dipole_is_asked_for_along_the_field_where_it_makes_no_torque(b, omega, error):
    assert abs(np.dot(pd_dipole(b, omega, error, K_W, K_A), b)) < 1e-12


def test_a_turn_about_the_vertical_is_corrected_about_the_vertical():
    """Body 10 deg ahead about axis 1, field along axis 3: the torque must turn it back about axis 1."""
    error = attitude_error(c_body_from_orbit((radians(10.0), 0.0, 0.0)))
    b = (0.0, 0.0, 3e-5)
    torque = np.cross(pd_dipole(b, (0.0, 0.0, 0.0), error, K_W, K_A), b)
    assert torque[0] < 0.0
    assert torque[1] == torque[2] == 0.0


def quaternion(rotation_rad):
    """Scalar first; the rotation of the axes is that of scipy's vectors, the other way round in C."""
    q1, q2, q3, q0 = Rotation.from_rotvec(rotation_rad).as_quat().tolist()
    return (q0, q1, q2, q3)


class TestFarError:
    """E = 4 qv, of the shorter way round."""

    @pytest.mark.long
    @given(directions, st.floats(0.0, pi))
    def test_is_4_sin_of_half_the_turn_about_its_axis(self, axis, angle_rad):
        error = far_error(quaternion(angle_rad * axis))
        np.testing.assert_allclose(error, 4.0 * sin(0.5 * angle_rad) * axis, atol=1e-14)

    @given(directions, st.floats(0.0, 0.1))
    def test_to_first_order_it_is_the_error_near_the_goal(self, axis, angle_rad):
        """They part with the cube of the angle: 2 sin a against 4 sin a/2."""
        q = quaternion(angle_rad * axis)
        apart = np.linalg.norm(np.subtract(far_error(q), attitude_error(dcm(q))))
        assert apart <= 0.26 * angle_rad**3 + 1e-15

    def test_it_grows_all_the_way_to_180_deg_where_the_other_vanishes(self):
        axis = np.array([0.6, -0.48, 0.64])
        sizes = [np.linalg.norm(far_error(quaternion(angle * axis))) for angle in np.linspace(0.0, pi, 50)]
        assert np.all(np.diff(sizes) > 0.0)
        assert sizes[-1] == pytest.approx(4.0)
        assert np.linalg.norm(attitude_error(dcm(quaternion(pi * axis)))) < 1e-15

    @pytest.mark.long
    @given(directions, st.floats(0.01, pi - 0.01))
    def test_both_signs_of_the_quaternion_are_one_attitude(self, axis, angle_rad):
        q = quaternion(angle_rad * axis)
        assert far_error(q) == far_error(tuple(-c for c in q))


MEAN_AM2 = 0.2
B_BODY_T = (1.7e-5, -2.3e-5, 3.1e-5)
SETPOINT = Setpoint("pd", K_W, K_A, k_i=0.08, spin_radps=0.0)
CONFIG = ControlConfig(
    setpoint=SETPOINT,
    gains={},
    inertia_kgm2=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    inertia_inverse=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    wheel_body_nms=ZERO,
    pulsed=True,
    tick_s=0.5,
    horizon_s=3.0,
    mean_dipole_am2=MEAN_AM2,
)
KNOWN = Attitude(quaternion((0.1, -0.2, 0.15)), (0.001, -0.002, 0.003), 0.01, 1e-4, True)
S = attitude_error(dcm(KNOWN.q_body_from_orbit))


def inputs(attitude=KNOWN, b_body_t=B_BODY_T, reference=None):
    return LawInput(attitude, b_body_t, FieldSample(), FieldSample(), reference=reference)


def turned(q, omega=ZERO, **known):
    return inputs(Attitude(q, omega, 0.01, 1e-4, True), **known)


class TestIntegral:
    def test_the_error_is_summed_over_time(self):
        demand = pd(inputs(), (), SETPOINT, CONFIG)
        assert demand.memory == pytest.approx(tuple(0.5 * c for c in S))
        demand = pd(inputs(), demand.memory, SETPOINT, CONFIG)
        assert demand.memory == pytest.approx(S)

    @given(vectors, vectors)
    def test_its_dipole_never_exceeds_what_the_coils_can_hold(self, integral, error):
        integral = tuple(1e5 * c for c in integral)
        grown = integrate_error(integral, error, B_BODY_T, 0.08, 0.5, MEAN_AM2)
        free = np.array(integral) + 0.5 * np.array(error)
        limit = MEAN_AM2 / (0.08 * np.linalg.norm(B_BODY_T))
        assert np.linalg.norm(grown) <= limit * (1.0 + 1e-12)
        if np.linalg.norm(free) <= limit:
            assert grown == pytest.approx(tuple(free))
        else:
            np.testing.assert_allclose(np.array(grown), limit * free / np.linalg.norm(free), rtol=1e-9)

    def test_a_lasting_error_winds_it_up_no_further(self):
        limit = MEAN_AM2 / (0.08 * np.linalg.norm(B_BODY_T))
        memory = tuple((0.9999 * limit * np.array(S) / np.linalg.norm(S)).tolist())
        for _ in range(100):
            memory = pd(inputs(), memory, SETPOINT, CONFIG).memory
        assert np.linalg.norm(memory) == pytest.approx(limit, rel=1e-12)
        back = Attitude(
            (KNOWN.q_body_from_orbit[0], *(-c for c in KNOWN.q_body_from_orbit[1:])), ZERO, 0, 0, True
        )
        assert np.linalg.norm(pd(inputs(back), memory, SETPOINT, CONFIG).memory) < np.linalg.norm(memory)

    def test_it_acts(self):
        """- k_i b x I beside the other two terms."""
        demand = pd(inputs(), (30.0, -20.0, 10.0), SETPOINT, CONFIG)
        expected = np.array(pd_dipole(B_BODY_T, KNOWN.omega_body_orbit_radps, S, K_W, K_A))
        expected -= 0.08 * np.cross(B_BODY_T, np.array([30.0, -20.0, 10.0]) + 0.5 * np.array(S))
        np.testing.assert_allclose(demand.m_body_am2, expected, rtol=1e-12)
        assert demand.impulse_body_nms is None

    def test_at_the_goal_it_goes_on_against_a_constant_torque(self):
        at_goal = Attitude(IDENTITY, ZERO, 0.01, 1e-4, True)
        memory = (30.0, -20.0, 10.0)
        demand = pd(inputs(at_goal), memory, SETPOINT, CONFIG)
        assert demand.memory == memory
        np.testing.assert_allclose(demand.m_body_am2, -0.08 * np.cross(B_BODY_T, memory), rtol=1e-12)

    def test_without_its_gain_it_neither_grows_nor_acts(self):
        demand = pd(inputs(), (), replace(SETPOINT, k_i=0.0), CONFIG)
        assert demand == Demand(pd_dipole(B_BODY_T, KNOWN.omega_body_orbit_radps, S, K_W, K_A), memory=ZERO)

    @pytest.mark.parametrize("law", [pd, pd_far])
    def test_with_a_gain_raised_since_it_is_limited_to_what_the_coils_give(self, law):
        at_goal = Attitude(IDENTITY, ZERO, 0.01, 1e-4, True)
        memory = (3000.0, -2000.0, 1000.0)
        demand = law(inputs(at_goal), memory, replace(SETPOINT, k_i=800.0), CONFIG)
        limit = MEAN_AM2 / (800.0 * np.linalg.norm(B_BODY_T))
        assert np.linalg.norm(demand.m_body_am2) <= MEAN_AM2 * (1.0 + 1e-12)
        np.testing.assert_allclose(demand.memory, limit * np.array(memory) / np.linalg.norm(memory))

    @pytest.mark.parametrize("law", [pd, pd_far])
    @pytest.mark.parametrize("attitude", [UNKNOWN, KNOWN.invalid()])
    def test_without_an_attitude_it_is_kept_and_nothing_asked_for(self, law, attitude):
        memory = (30.0, -20.0, 10.0)
        assert law(inputs(attitude), memory, SETPOINT, CONFIG) == Demand(memory=memory)

    def test_far_from_the_goal_it_is_held_and_acts(self):
        memory = (30.0, -20.0, 10.0)
        demand = pd_far(inputs(), memory, SETPOINT, CONFIG)
        error = far_error(KNOWN.q_body_from_orbit)
        expected = np.array(pd_dipole(B_BODY_T, KNOWN.omega_body_orbit_radps, error, K_W, K_A))
        expected -= 0.08 * np.cross(B_BODY_T, memory)
        assert demand.memory == memory
        np.testing.assert_allclose(demand.m_body_am2, expected, rtol=1e-12)


def test_in_acquire_the_attitude_asks_for_no_more_than_the_coils_give_in_the_mean():
    far, slight = quaternion((0.0, 2.0, 1.0)), quaternion((0.0, 0.002, 0.001))
    error = acquisition_error(turned(far), SETPOINT, CONFIG)
    assert K_A * np.linalg.norm(B_BODY_T) * np.linalg.norm(error) == pytest.approx(MEAN_AM2)
    np.testing.assert_allclose(np.cross(error, far_error(far)), 0.0, atol=1e-12)
    assert np.dot(error, far_error(far)) > 0.0
    assert acquisition_error(turned(slight), SETPOINT, CONFIG) == far_error(slight)


def test_in_acquire_the_attitude_asks_for_no_faster_turn_than_the_orbits():
    """With coils that would give anything."""
    orbit = Reference(
        (7e6, 0.0, 0.0), 7e6, (1e-5, 2e-5, 3e-5), (1.0, 0.0, 0.0), True, (1.0, 0.0, 0.0, 0.0), 1.1e-3
    )
    strong, far = replace(CONFIG, mean_dipole_am2=1e6), quaternion((0.0, 2.0, 1.0))
    quick = replace(SETPOINT, k_a=3.0 * K_A)
    limited = acquisition_error(turned(far, reference=orbit), quick, strong)
    assert 3.0 * K_A * np.linalg.norm(limited) == pytest.approx(K_W * 1.1e-3)
    np.testing.assert_allclose(np.cross(limited, far_error(far)), 0.0, atol=1e-12)
    for at, setpoint in (
        (turned(far, reference=orbit), SETPOINT),
        (turned(far, reference=orbit), replace(quick, k_w=0.0)),
        (turned(far), quick),
    ):
        assert acquisition_error(at, setpoint, strong) == far_error(far)


def test_in_acquire_the_rate_has_what_it_asks_for_whatever_the_attitude():
    rate = (0.02, -0.03, 0.01)
    far = quaternion((0.0, 2.0, 1.0))
    still, braked = (pd_far(turned(far, omega), (), SETPOINT, CONFIG).m_body_am2 for omega in (ZERO, rate))
    assert np.linalg.norm(still) <= MEAN_AM2 * (1.0 + 1e-12)
    np.testing.assert_allclose(np.subtract(braked, still), pd_dipole(B_BODY_T, rate, ZERO, K_W, K_A))


def test_upside_down_the_far_law_turns_back_and_the_near_one_does_not():
    upside_down = Attitude(quaternion((0.0, pi, 0.0)), ZERO, 0.01, 1e-4, True)
    near = pd(inputs(upside_down), (), SETPOINT, CONFIG).m_body_am2
    far = pd_far(inputs(upside_down), (), SETPOINT, CONFIG).m_body_am2
    np.testing.assert_allclose(near, 0.0, atol=1e-12)
    assert np.linalg.norm(far) > 0.05
    assert np.cross(far, B_BODY_T)[1] < 0.0
