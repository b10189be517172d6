"""The lean filter gives what filterpy's gives, from the rows of the transition that move alone."""

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.estimation.kalman import LeanKalmanFilter, inverse

SIZES = st.tuples(st.sampled_from([6, 9, 12, 41]), st.sampled_from([3, 6]))
MOVING = 6
SEEDS = st.integers(0, 2**32 - 1)


def covariance(random, size):
    """Full and positive definite, its deviations spread over eight decades as those of the filter are."""
    root = random.normal(size=(size, size))
    sigma = 10.0 ** random.uniform(-8.0, 0.0, size)
    return np.outer(sigma, sigma) * (root @ root.T / size + 0.1 * np.eye(size))


def pair(random, states, measurements):
    """filterpy's filter and the lean one with the same covariance, and an error state of zero."""
    p = covariance(random, states)
    parent = KalmanFilter(dim_x=states, dim_z=measurements)
    parent.x, parent.P, parent.inv = np.zeros(states), p, inverse
    return parent, LeanKalmanFilter(p)


def transition(random, states, change=1.0):
    """(n, n), of which all rows but the first are those of the identity."""
    full = np.eye(states)
    full[:MOVING] += change * random.normal(size=(MOVING, states))
    return full


def assert_equal(parent, lean, names):
    """To rounding, in units of each state's own deviation."""
    for name in names:
        theirs, ours = np.asarray(getattr(parent, name)), np.asarray(getattr(lean, name))
        unit = np.abs(theirs).max() if name != "P" else deviations(theirs)
        with np.errstate(invalid="ignore"):  # the likelihood may be infinite
            near = (ours == theirs) | (np.abs(ours - theirs) <= 1e-9 * unit)
        assert near.all(), name


def deviations(covariance):
    sigma = np.sqrt(covariance.diagonal())
    return np.outer(sigma, sigma)


@given(SIZES, SEEDS)
def test_a_prediction_is_that_of_filterpy(sizes, seed):
    random, (states, _) = np.random.default_rng(seed), sizes
    parent, lean = pair(random, *sizes)
    f, q = transition(random, states), covariance(random, states)
    parent.predict(F=f, Q=q)
    lean.predict(F=f[:MOVING], Q=q)
    assert_equal(parent, lean, ("P",))


@given(SIZES, SEEDS)
def test_all_rows_may_move(sizes, seed):
    random, (states, _) = np.random.default_rng(seed), sizes
    parent, lean = pair(random, *sizes)
    f = np.eye(states) + random.normal(size=(states, states))
    parent.predict(F=f, Q=np.zeros((states, states)))
    lean.predict(F=f, Q=np.zeros((states, states)))
    assert_equal(parent, lean, ("P",))


@given(SIZES, SEEDS)
def test_an_update_is_that_of_filterpy(sizes, seed):
    random, (states, measurements) = np.random.default_rng(seed), sizes
    parent, lean = pair(random, *sizes)
    z, noise = random.normal(size=measurements), covariance(random, measurements)
    sensitivity = random.normal(size=(measurements, states))
    parent.update(z, noise, sensitivity)
    lean.update(z, noise, sensitivity)
    assert_equal(parent, lean, ("x", "P", "y", "K", "S", "SI", "log_likelihood"))


@given(SIZES, SEEDS)
def test_so_is_what_follows_one_upon_the_other(sizes, seed):
    random, (states, measurements) = np.random.default_rng(seed), sizes
    parent, lean = pair(random, *sizes)
    for _ in range(5):
        f, q = transition(random, states, 0.1), np.eye(states)
        z, sensitivity = random.normal(size=measurements), random.normal(size=(measurements, states))
        parent.x = np.zeros(states)  # once it is folded into the estimate
        parent.predict(F=f, Q=q)
        lean.predict(F=f[:MOVING], Q=q)
        for one in (parent, lean):
            one.update(z, np.eye(measurements), sensitivity)
    assert_equal(parent, lean, ("x", "P", "y", "K", "S", "SI"))


def test_arrays_that_go_in_are_not_changed():
    random = np.random.default_rng(1)
    p, f, q = covariance(random, 6), np.eye(6), covariance(random, 6)
    z, noise, sensitivity = np.ones(3), np.eye(3), random.normal(size=(3, 6))
    given_arrays = (p, f, q, z, noise, sensitivity)
    before = [array.copy() for array in given_arrays]
    lean = LeanKalmanFilter(p)
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
