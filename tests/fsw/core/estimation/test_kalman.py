"""The lean filter gives bit for bit what filterpy's gives."""

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.estimation.kalman import LeanKalmanFilter, inverse

SIZES = st.tuples(st.sampled_from([6, 9, 12]), st.sampled_from([3, 6]))
SEEDS = st.integers(0, 2**32 - 1)


def covariance(random, size):
    """Full and positive definite, its deviations spread over eight decades as those of the filter are."""
    root = random.normal(size=(size, size))
    sigma = 10.0 ** random.uniform(-8.0, 0.0, size)
    return np.outer(sigma, sigma) * (root @ root.T / size + 0.1 * np.eye(size))


def pair(random, states, measurements):
    """filterpy's filter and the lean one in the same state."""
    x, p = random.normal(size=states), covariance(random, states)
    parent = KalmanFilter(dim_x=states, dim_z=measurements)
    parent.x, parent.P, parent.inv = x, p, inverse
    return parent, LeanKalmanFilter(x, p, np.eye(states))


def equal(parent, lean, names):
    return all(np.array_equal(getattr(parent, name), getattr(lean, name)) for name in names)


@given(SIZES, SEEDS)
def test_a_prediction_is_that_of_filterpy(sizes, seed):
    random, (states, _) = np.random.default_rng(seed), sizes
    parent, lean = pair(random, *sizes)
    step = {"F": np.eye(states) + random.normal(size=(states, states)), "Q": covariance(random, states)}
    parent.predict(**step)
    lean.predict(**step)
    assert equal(parent, lean, ("x", "P"))


@given(SIZES, SEEDS)
def test_an_update_is_that_of_filterpy(sizes, seed):
    random, (states, measurements) = np.random.default_rng(seed), sizes
    parent, lean = pair(random, *sizes)
    z, noise = random.normal(size=measurements), covariance(random, measurements)
    sensitivity = random.normal(size=(measurements, states))
    parent.update(z, noise, sensitivity)
    lean.update(z, noise, sensitivity)
    assert equal(parent, lean, ("x", "P", "y", "K", "S", "SI", "log_likelihood"))


@given(SIZES, SEEDS)
def test_so_is_what_follows_one_upon_the_other(sizes, seed):
    random, (states, measurements) = np.random.default_rng(seed), sizes
    filters = pair(random, *sizes)
    for _ in range(5):
        step = {"F": np.eye(states) + 0.1 * random.normal(size=(states, states)), "Q": np.eye(states)}
        z, sensitivity = random.normal(size=measurements), random.normal(size=(measurements, states))
        for one in filters:
            one.predict(**step)
            one.update(z, np.eye(measurements), sensitivity)
    assert equal(*filters, ("x", "P", "y", "K", "S", "SI"))


def test_arrays_that_go_in_are_not_changed():
    random = np.random.default_rng(1)
    x, p, f, q = random.normal(size=6), covariance(random, 6), np.eye(6), covariance(random, 6)
    z, noise, sensitivity, identity = np.ones(3), np.eye(3), random.normal(size=(3, 6)), np.eye(6)
    given_arrays = (x, p, f, q, z, noise, sensitivity, identity)
    before = [array.copy() for array in given_arrays]
    lean = LeanKalmanFilter(x, p, identity)
    lean.predict(F=f, Q=q)
    lean.update(z, noise, sensitivity)
    assert all(map(np.array_equal, given_arrays, before))


class TestInverse:
    @pytest.mark.parametrize("size", [3, 6])
    def test_it_is_the_one_of_numpy(self, size):
        m = np.random.default_rng(size).normal(size=(size, size)) + 3.0 * np.eye(size)
        np.testing.assert_allclose(inverse(m), np.linalg.inv(m), rtol=1e-12, atol=1e-14)

    @pytest.mark.parametrize("m", [np.zeros((3, 3)), np.ones((6, 6)), np.full((6, 6), np.inf)])
    def test_what_has_none_gives_no_numbers_and_does_not_raise(self, m):
        assert not np.isfinite(inverse(m)).any()
