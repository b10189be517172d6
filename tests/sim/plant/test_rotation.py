"""The plant's rotations against scipy's, which are the inverse: C(q) there is C(q)^T here."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.plant import rotation

RANDOM = np.random.default_rng(3)
QUATERNIONS = [tuple(q / np.linalg.norm(q)) for q in RANDOM.standard_normal((50, 4))]


@pytest.mark.parametrize("q", QUATERNIONS[:10])
def test_matrix_takes_components_from_the_reference_to_the_body(q):
    assert rotation.matrix(q) == pytest.approx(Rotation.from_quat(q, scalar_first=True).inv().as_matrix())


@pytest.mark.parametrize("q", QUATERNIONS)
def test_quaternion_comes_back_from_its_matrix_with_scalar_part_not_negative(q):
    back = rotation.from_matrix(rotation.matrix(q))
    assert back[0] >= 0.0
    assert back == pytest.approx(rotation.canonical(q), abs=1e-15)


@pytest.mark.parametrize("axis", [0, 1, 2, 3])
@pytest.mark.parametrize("tilt", [0.0, 1e-9, -1e-9, 1e-3])
def test_quaternion_from_matrix_is_exact_at_half_turns_too(axis, tilt):
    q = [tilt, -tilt, 0.5 * tilt, 2.0 * tilt]
    q[axis] = 1.0
    q = rotation.normalise(tuple(q))
    c = rotation.matrix(q)
    assert np.array(rotation.matrix(rotation.from_matrix(c))) == pytest.approx(np.array(c), abs=1e-15)


def test_product_chains_from_the_reference_outward():
    p, q = QUATERNIONS[:2]
    chained = np.array(rotation.matrix(q)) @ np.array(rotation.matrix(p))
    assert np.array(rotation.matrix(rotation.multiply(p, q))) == pytest.approx(chained)


def test_conjugate_undoes():
    q = QUATERNIONS[0]
    assert rotation.multiply(q, rotation.conjugate(q)) == pytest.approx((1.0, 0.0, 0.0, 0.0), abs=1e-15)


@pytest.mark.parametrize("vector", [(0.3, -0.2, 0.5), (0.0, 0.0, 0.0), (0.0, 3.0, -1e-9)])
def test_rotation_vector_turns_the_frame(vector):
    expected = Rotation.from_rotvec(vector).inv().as_matrix()
    assert np.array(rotation.matrix(rotation.from_vector(vector))) == pytest.approx(expected)


def test_vector_algebra():
    m, v, w = RANDOM.standard_normal((3, 3)), RANDOM.standard_normal(3), RANDOM.standard_normal(3)
    assert rotation.transform(tuple(map(tuple, m)), tuple(v)) == pytest.approx(m @ v)
    assert rotation.cross(tuple(v), tuple(w)) == pytest.approx(np.cross(v, w))
