"""3-vectors and 3x3 matrices on plain floats, against numpy."""

from math import inf, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.algebra import vector

floats = st.floats(-1e3, 1e3, allow_subnormal=False)
vectors = st.tuples(floats, floats, floats)
matrices = st.tuples(vectors, vectors, vectors)


def close(ours, theirs):
    np.testing.assert_allclose(np.array(ours), theirs, rtol=1e-12, atol=1e-6)


@pytest.mark.long
@given(vectors, vectors, floats)
def test_vector_algebra(a, b, factor):
    u, v = np.array(a), np.array(b)
    close(vector.add(a, b), u + v)
    close(vector.sub(a, b), u - v)
    close(vector.scale(factor, a), factor * u)
    close(vector.dot(a, b), u @ v)
    close(vector.cross(a, b), np.cross(u, v))
    close(vector.norm(a), np.linalg.norm(u))


@pytest.mark.parametrize(
    ("a", "zero"), [((0.0, -0.0, 0.0), True), ((0.0, 1e-300, 0.0), False), ((float("nan"), 0.0, 0.0), False)]
)
def test_zero_is_every_component(a, zero):
    assert vector.is_zero(a) is zero


@pytest.mark.parametrize(
    ("number", "finite"), [(0.0, True), (-1.7e308, True), (inf, False), (-inf, False), (nan, False)]
)
def test_what_is_infinite_or_no_number_is_not_finite(number, finite):
    assert vector.is_finite(number) is finite


@given(matrices, vectors, st.integers(0, 2))
def test_rows_and_components_are_found_by_their_index(m, a, index):
    assert vector.row(m, index) == m[index]
    assert vector.item(a, index) == a[index]


@pytest.mark.long
@given(matrices, matrices, vectors)
def test_matrix_algebra(m, n, a):
    close(vector.transform(m, a), np.array(m) @ np.array(a))
    close(vector.transpose(m), np.array(m).T)
    close(vector.product(m, n), np.array(m) @ np.array(n))


@given(vectors, vectors)
def test_skew_is_the_cross_product_as_a_matrix(a, b):
    assert vector.transform(vector.skew(a), b) == pytest.approx(vector.cross(a, b), rel=1e-12, abs=1e-6)
    assert vector.transpose(vector.skew(a)) == tuple(vector.scale(-1.0, row) for row in vector.skew(a))


def test_the_cross_product_is_right_handed():
    assert vector.cross((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)) == (0.0, 0.0, 1.0)
    assert vector.cross((1.0, 2.0, 3.0), (-5.0, 7.0, 11.0)) == (1.0, -26.0, 17.0)


@given(vectors.filter(lambda a: vector.norm(a) > 1e-6))
def test_a_unit_vector_has_length_one_and_keeps_the_direction(a):
    e = vector.unit(a)
    assert vector.norm(e) == pytest.approx(1.0, rel=1e-12)
    close(vector.scale(vector.norm(a), e), a)


def test_the_unit_vector_of_nothing_is_nothing():
    assert vector.unit(vector.ZERO) == vector.ZERO


@given(matrices)
def test_inverse_of_any_inertia_like_tensor(m):
    """M M^T + I is symmetric, positive and never singular."""
    tensor = np.array(m) @ np.array(m).T / 1e3 + np.eye(3)
    rows = tuple(tuple(row) for row in tensor.tolist())
    for inverse in (vector.inverse(rows), vector.symmetric_inverse(rows)):
        np.testing.assert_allclose(np.array(inverse) @ tensor, np.eye(3), atol=1e-6)


@pytest.mark.parametrize(
    "moments", [(1.02, 1.85, 1.45), (-1.02, 1.85, 1.45), (1.02, -0.2, -0.3), (0.0, 1.0, 2.0)]
)
def test_a_symmetric_matrix_is_positive_definite_exactly_if_its_eigenvalues_are_positive(moments):
    axes, _ = np.linalg.qr(np.array([[0.6, -0.2, 0.5], [0.3, 0.9, -0.4], [-0.7, 0.1, 0.8]]))
    turned = tuple(map(tuple, (axes @ np.diag(moments) @ axes.T - 1e-12 * np.eye(3)).tolist()))
    assert vector.positive_definite(turned) == (min(moments) > 0.0)


def test_inverse_of_a_matrix_without_symmetry():
    m = ((2.0, -1.0, 0.5), (0.25, 3.0, 1.0), (-2.0, 0.75, 1.5))
    np.testing.assert_allclose(vector.inverse(m), np.linalg.inv(np.array(m)), rtol=1e-13)


def test_a_singular_matrix_has_no_inverse():
    with pytest.raises(ZeroDivisionError):
        vector.inverse(((1.0, 2.0, 3.0), (2.0, 4.0, 6.0), (1.0, 0.0, 1.0)))
    with pytest.raises(ZeroDivisionError):
        vector.symmetric_inverse(((1.0, 2.0, 3.0), (2.0, 4.0, 6.0), (3.0, 6.0, 1.0)))


@given(matrices, vectors)
def test_what_is_not_a_number_is_passed_on(m, a):
    bad = (a[0], float("nan"), a[2])
    assert np.isnan(vector.transform(m, bad)).all()
    assert np.isnan(vector.norm(bad))
