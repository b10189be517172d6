"""The PD dipole law: the equation, what its torque does, and where it is blind."""

from math import pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fsw.core.laws.pd import attitude_error, pd_dipole

K_W, K_A = 6.2694e6, 1614.9
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.map(lambda v: tuple(4e-5 * c for c in v))
rates = vectors.map(lambda v: tuple(0.02 * c for c in v))
directions = vectors.filter(lambda v: np.linalg.norm(v) > 0.1).map(lambda v: np.array(v) / np.linalg.norm(v))


def c_body_from_orbit(rotation_rad):
    """Ours turns axes: the transpose of scipy's."""
    return tuple(map(tuple, Rotation.from_rotvec(rotation_rad).as_matrix().T.tolist()))


@given(fields, rates, vectors)
def test_the_equation(b, omega, error):
    """m = -k_w b x Omega - k_a b x S."""
    expected = -K_W * np.cross(b, omega) - K_A * np.cross(b, error)
    np.testing.assert_allclose(pd_dipole(b, omega, error, K_W, K_A), expected, rtol=1e-9, atol=1e-12)


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
