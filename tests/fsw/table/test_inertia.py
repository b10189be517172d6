"""Which tensors can belong to a body: exactly those of a mass distribution."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fsw.table.inertia import check_inertia, three_numbers, without_rounding

component = st.floats(-1.0, 1.0, allow_subnormal=False)
turns = st.tuples(component, component, component).map(lambda v: 3.0 * np.array(v))


def tensor(principal, turn=(0.0, 0.0, 0.0), size=1.0):
    """Principal moments seen in turned axes; exactly symmetric."""
    c = Rotation.from_rotvec(turn).as_matrix()
    j = size * c @ np.diag(principal) @ c.T
    return tuple(map(tuple, (0.5 * (j + j.T)).tolist()))


@pytest.mark.long
@given(
    st.lists(st.tuples(component, component, component), min_size=4, max_size=9),
    st.floats(1e-6, 1e6),
)
def test_every_cloud_of_masses_that_is_no_line_has_one(points, size):
    r = np.array(points)
    second = r.T @ r
    j = np.trace(second) * np.eye(3) - second
    assume(np.trace(j) > 1e-3)
    assume(np.linalg.eigvalsh(j)[0] > 1e-3 * np.trace(j))
    check_inertia(tuple(map(tuple, (size * 0.5 * (j + j.T)).tolist())))


POSSIBLE = [(1.02, 1.85, 1.95), (1.0, 139.0, 139.0), (1.0, 113.0, 113.5), (5.0, 5.0, 5.0), (1.0, 2.0, 3.0)]
IMPOSSIBLE = [
    (1.0, 2.0, 3.01),
    (1.0, 1.0, 5.0),
    (0.0, 5.0, 5.0),
    (-1.0, 2.0, 2.0),
    (-1.0, -2.0, -2.0),
    (0.0, 0.0, 0.0),
    (2.0, -0.1, 2.05),
]


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e8])
@given(turn=turns)
def test_possible_in_any_axes_and_of_any_size(size, turn):
    for principal in POSSIBLE:
        check_inertia(tensor(principal, turn, size))


@pytest.mark.long
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e8])
@given(turn=turns)
def test_impossible_in_any_axes_and_of_any_size(size, turn):
    for principal in IMPOSSIBLE:
        with pytest.raises(ValueError, match="must be positive"):
            check_inertia(tensor(principal, turn, size))


@pytest.mark.parametrize(("row", "column"), [(0, 1), (0, 2), (1, 2)])
def test_a_tensor_is_symmetric(row, column):
    j = np.array(tensor((1.02, 1.85, 1.95), (0.1, -0.2, 0.3)))
    j[row, column] += 1e-12
    with pytest.raises(ValueError, match="symmetric"):
        check_inertia(tuple(map(tuple, j.tolist())))


@pytest.mark.long
@given(turn=turns, size=st.floats(1e-6, 1e6))
def test_a_tensor_that_was_turned_in_floating_point_is_symmetric_up_to_rounding(turn, size):
    c = Rotation.from_rotvec(turn).as_matrix()
    given = tuple(map(tuple, (size * c @ np.diag((1.02, 1.85, 1.95)) @ c.T).tolist()))
    made = without_rounding(given)
    check_inertia(made)
    assert np.allclose(made, given, rtol=0.0, atol=1e-14 * size)


def test_an_asymmetry_that_rounding_does_not_make_stays():
    given = ((1.02, 1e-12, 0.0), (0.0, 1.85, 0.0), (0.0, 0.0, 1.95))
    assert without_rounding(given) == given


@pytest.mark.parametrize(
    ("value", "are"),
    [
        ([1, 2.5, -3], True),
        ((1.0, 2.0, 3.0), True),
        ([1, 2], False),
        ([1, 2, 3, 4], False),
        ([1, 2, "3"], False),
        ([1, 2, True], False),
        ([1, 2, None], False),
        ([1, 2, float("nan")], False),
        ([1, 2, float("inf")], False),
        ("123", False),
        (3, False),
        (None, False),
        ([[1], [2], [3]], False),
    ],
)
def test_three_numbers(value, are):
    assert three_numbers(value) is are
