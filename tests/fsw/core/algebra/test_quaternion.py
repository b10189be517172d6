"""Quaternion algebra against scipy, and the conventions of the project held one by one.

scipy's matrix of a rotation turns vectors; ours, C, turns axes, and is its transpose.
"""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fsw.core.algebra.quaternion import (
    IDENTITY,
    canonical,
    conjugate,
    dcm,
    from_dcm,
    from_small_rotation,
    multiply,
    normalise,
    rotate,
)

component = st.floats(-1.0, 1.0, allow_subnormal=False)
quaternions = (
    st.tuples(component, component, component, component)
    .filter(lambda q: sum(c * c for c in q) > 1e-2)
    .map(normalise)
)
vectors = st.tuples(component, component, component)


def scipy_rotation(q):
    return Rotation.from_quat(q, scalar_first=True)


def about(axis, angle_rad):
    length = sqrt(sum(c * c for c in axis))
    return (cos(angle_rad / 2), *(sin(angle_rad / 2) * c / length for c in axis))


def same_attitude(p, q, tolerance=1e-12):
    return min(max(abs(a - s * b) for a, b in zip(p, q, strict=True)) for s in (1, -1)) < tolerance


@pytest.mark.long
@given(quaternions, quaternions)
def test_the_product_is_hamilton_s(p, q):
    assert same_attitude(multiply(p, q), (scipy_rotation(p) * scipy_rotation(q)).as_quat(scalar_first=True))


def test_the_product_of_units_i_j_is_k():
    i, j, k = (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)
    assert multiply(i, j) == k
    assert multiply(j, i) == (-0.0, 0.0, 0.0, -1.0)
    assert multiply(i, i) == (-1.0, 0.0, 0.0, 0.0)


@pytest.mark.long
@given(quaternions)
def test_the_matrix_turns_axes(q):
    np.testing.assert_allclose(dcm(q), scipy_rotation(q).as_matrix().T, atol=1e-13)


@pytest.mark.long
@given(quaternions)
def test_the_matrix_is_the_formula_of_the_convention(q):
    q0, v = q[0], np.array(q[1:])
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    expected = (q0**2 - v @ v) * np.eye(3) + 2 * np.outer(v, v) - 2 * q0 * cross
    np.testing.assert_allclose(dcm(q), expected, atol=1e-14)


def test_a_body_turned_by_90_deg_about_its_third_axis_sees_axis_1_on_minus_axis_2():
    q = about((0, 0, 1), pi / 2)
    assert rotate(q, (1.0, 0.0, 0.0)) == pytest.approx((0.0, -1.0, 0.0), abs=1e-15)
    assert rotate(q, (0.0, 1.0, 0.0)) == pytest.approx((1.0, 0.0, 0.0), abs=1e-15)


@pytest.mark.long
@given(quaternions, vectors)
def test_rotate_is_the_matrix_applied(q, v):
    np.testing.assert_allclose(rotate(q, v), np.array(dcm(q)) @ v, atol=1e-14)


@given(quaternions, vectors)
def test_conjugate_turns_back(q, v):
    np.testing.assert_allclose(rotate(conjugate(q), rotate(q, v)), v, atol=1e-14)
    assert multiply(q, conjugate(q)) == pytest.approx(IDENTITY, abs=1e-14)


@pytest.mark.long
@given(quaternions, quaternions, vectors)
def test_chains_multiply_from_the_reference_outward(q_b_from_a, q_c_from_b, v_a):
    q_c_from_a = multiply(q_b_from_a, q_c_from_b)
    np.testing.assert_allclose(
        rotate(q_c_from_a, v_a), rotate(q_c_from_b, rotate(q_b_from_a, v_a)), atol=1e-13
    )


@given(quaternions, vectors, vectors)
def test_the_rate_in_body_axes_multiplies_from_the_right(q, omega, v_ref):
    """dq/dt = 1/2 q (x) (0, omega) moves what the body sees of a fixed vector by -omega x v_body."""
    h = 1e-6
    rate = multiply(q, (0.0, *omega))
    later = normalise(tuple(c + 0.5 * h * r for c, r in zip(q, rate, strict=True)))
    moved = (np.array(rotate(later, v_ref)) - rotate(q, v_ref)) / h
    np.testing.assert_allclose(moved, -np.cross(omega, rotate(q, v_ref)), atol=1e-5)


@given(st.tuples(component, component, component, component).filter(lambda q: max(map(abs, q)) > 1e-6))
def test_normalise(q):
    unit = normalise(q)
    assert sum(c * c for c in unit) == pytest.approx(1.0, abs=1e-14)
    assert sum(c * u for c, u in zip(q, unit, strict=True)) > 0.0


@given(quaternions)
def test_canonical_is_the_same_attitude_with_a_scalar_part_not_negative(q):
    assert canonical(q)[0] >= 0.0
    assert canonical(q) in (q, tuple(-c for c in q))
    assert canonical(canonical(q)) == canonical(q)


@given(quaternions)
def test_from_dcm_undoes_dcm(q):
    back = from_dcm(dcm(q))
    assert same_attitude(back, q)
    assert back[0] >= 0.0


@pytest.mark.parametrize(
    "axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 2, 3), (-3, 1, 2), (2, -3, -1), (1, 1, 1)]
)
@pytest.mark.parametrize("angle_rad", [0.0, 1e-9, 0.1, pi / 2, 2.1, pi - 1e-9, pi, pi + 1e-9])
def test_from_dcm_near_every_pivot(axis, angle_rad):
    q = about(axis, angle_rad)
    assert same_attitude(from_dcm(dcm(q)), q, 1e-13)


@given(st.tuples(*[st.floats(-0.05, 0.05, allow_subnormal=False)] * 3))
def test_a_small_rotation_is_unit_and_right_to_second_order(rotation):
    """atan(x/2) for x/2: the angle is short by x^3 / 12."""
    angle = sqrt(sum(c * c for c in rotation))
    q = from_small_rotation(rotation)
    exact = Rotation.from_rotvec(rotation).as_quat(scalar_first=True)
    assert sum(c * c for c in q) == pytest.approx(1.0, abs=1e-15)
    assert same_attitude(q, exact, 1e-15 + angle**3 / 24)
