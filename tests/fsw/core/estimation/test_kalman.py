"""Kernel and filterpy compute the same, and so do kernel and numpy beside prediction and update."""

import pickle
from math import inf

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.estimation import filterpy_algebra, kalman
from fsw.core.estimation.kalman import (
    Algebra,
    Trace,
    available,
    inverse,
    predict,
    product,
    unexplained,
    update,
)

SIZES = st.tuples(st.sampled_from([6, 9, 12, 41, 54]), st.sampled_from([1, 3, 6]))
MOVING = 6
SEEDS = st.integers(0, 2**32 - 1)
BOTH = [available(Algebra.KERNEL), Algebra.FILTERPY]
ROUNDING = 1e-12


def covariance(random, size):
    """Full and positive definite, its deviations spread over eight decades as those of the filter are."""
    root = random.normal(size=(size, size))
    sigma = 10.0 ** random.uniform(-8.0, 0.0, size)
    return np.outer(sigma, sigma) * symmetric(root @ root.T / size + 0.1 * np.eye(size))


def symmetric(matrix):
    return 0.5 * (matrix + matrix.T)


def transition(random, states, change=1.0):
    """(n, n), of which all rows but the first are those of the identity."""
    full = np.eye(states)
    full[:MOVING] += change * random.normal(size=(MOVING, states))
    return full


def measurement(random, p, measured):
    """Innovation, noise and sensitivity that suit the deviations of a covariance."""
    sensitivity = random.normal(size=(measured, len(p))) / np.sqrt(p.diagonal())
    noise = symmetric(np.diag(random.uniform(0.1, 2.0, measured)) + 0.01)
    return tuple(random.normal(size=measured).tolist()), noise, sensitivity


def assert_near(ours, theirs, unit=None, allowed=ROUNDING):
    """To rounding; of a covariance in units of each state's own deviation."""
    unit = np.abs(theirs).max() if unit is None else unit
    assert (np.abs(ours - theirs) <= allowed * unit).all()


def deviations(p):
    sigma = np.sqrt(p.diagonal())
    return np.outer(sigma, sigma)


@pytest.mark.long
@pytest.mark.parametrize("algebra", BOTH)
@given(sizes=SIZES, seed=SEEDS)
def test_a_prediction_is_that_of_filterpy(algebra, sizes, seed):
    random, (states, _) = np.random.default_rng(seed), sizes
    p, q, f = covariance(random, states), covariance(random, states), transition(random, states)
    kalman = KalmanFilter(dim_x=states, dim_z=1)
    kalman.P = p
    kalman.predict(F=f, Q=q)
    after = predict(p, f[:MOVING], q, (), algebra)
    size = np.abs(f) @ deviations(p) @ np.abs(f).T  # of the terms that are added
    assert_near(after, kalman.P, size + np.abs(q))
    assert (after == after.T).all()


@pytest.mark.parametrize("algebra", BOTH)
@given(seed=SEEDS)
def test_all_rows_may_move(algebra, seed):
    random = np.random.default_rng(seed)
    p, f = covariance(random, 9), random.normal(size=(9, 9))
    after = predict(p, f, np.zeros((9, 9)), (), algebra)
    assert_near(after, f @ p @ f.T, np.abs(f) @ deviations(p) @ np.abs(f).T)


@pytest.mark.long
@pytest.mark.parametrize("algebra", BOTH)
@given(sizes=SIZES, seed=SEEDS)
def test_an_update_is_that_of_filterpy(algebra, sizes, seed):
    random, (states, measured) = np.random.default_rng(seed), sizes
    p = covariance(random, states)
    y, noise, sensitivity = measurement(random, p, measured)
    kalman = KalmanFilter(dim_x=states, dim_z=measured)
    kalman.x, kalman.P = np.zeros(states), p
    kalman.update(np.array(y), noise, sensitivity)
    found = update(p, y, noise, sensitivity, None, algebra)
    sigma = np.sqrt(p.diagonal())
    assert_near(np.array(found.error), kalman.x, 10.0 * sigma)
    assert_near(found.covariance, kalman.P, 10.0 * deviations(p))
    assert_near(np.array(found.variances), kalman.S.diagonal())
    assert found.nis == pytest.approx(np.array(y) @ kalman.SI @ np.array(y), rel=ROUNDING)
    assert found.effect is found.sums is None
    assert (found.covariance == found.covariance.T).all()


@pytest.mark.parametrize("algebra", BOTH)
@given(sizes=SIZES, seed=SEEDS)
def test_a_trace_goes_along_by_the_gain_and_the_weight_of_the_update(algebra, sizes, seed):
    random, (states, measured) = np.random.default_rng(seed), sizes
    p = covariance(random, states)
    y, noise, sensitivity = measurement(random, p, measured)
    sigma = np.sqrt(p.diagonal())
    effect, sums = sigma[:, None] * random.normal(size=(states, 5)), symmetric(random.normal(size=(5, 5)))
    kept = effect.copy(), sums.copy()
    trace = Trace((), effect, sums, 0)
    kalman = KalmanFilter(dim_x=states, dim_z=measured)
    kalman.x, kalman.P = np.zeros(states), p
    kalman.update(np.array(y), noise, sensitivity)
    traced = sensitivity @ effect
    traced[:, -1] = y
    found = update(p, y, noise, sensitivity, None, algebra, trace)
    size = np.abs(traced).max() + 1.0
    assert_near(found.effect, effect - kalman.K @ traced, 10.0 * sigma[:, None] * size)
    assert_near(found.sums, sums + traced.T @ kalman.SI @ traced, 100.0 * size**2)
    assert np.array_equal(trace.effect, kept[0])
    assert np.array_equal(trace.sums, kept[1])


@pytest.mark.long
@given(sizes=SIZES, seed=SEEDS)
def test_both_give_the_same_over_many_steps(sizes, seed):
    random, (states, measured) = np.random.default_rng(seed), sizes
    p = {algebra: covariance(np.random.default_rng(seed), states) for algebra in BOTH}
    for _ in range(10):
        sigma = np.sqrt(p[BOTH[0]].diagonal())
        f = (transition(random, states, 0.01) * sigma[:, None] / sigma)[:MOVING]
        y, noise, sensitivity = measurement(random, p[BOTH[0]], measured)
        for algebra in BOTH:
            before = predict(p[algebra], f, 0.01 * np.diag(p[algebra].diagonal()), (), algebra)
            p[algebra] = update(before, y, noise, sensitivity, None, algebra).covariance
    first, second = (p[algebra] for algebra in BOTH)
    assert_near(first, second, deviations(second), 1e-9)


@pytest.mark.long
@pytest.mark.parametrize("algebra", BOTH)
@given(sizes=SIZES, seed=SEEDS)
def test_considered_states_keep_their_values_and_the_covariance_is_that_of_the_errors(algebra, sizes, seed):
    """Schmidt's filter: whatever the gain K, the error after an update is (1 - K H) e - K v."""
    random, (states, measured) = np.random.default_rng(seed), sizes
    p = covariance(random, states)
    y, noise, sensitivity = measurement(random, p, measured)
    best = p @ sensitivity.T @ np.linalg.inv(sensitivity @ p @ sensitivity.T + noise)
    gain = np.where(np.arange(states)[:, None] < 4, best, 0.0)
    remains = np.eye(states) - gain @ sensitivity
    found = update(p, y, noise, sensitivity, slice(4, states), algebra)
    assert not any(found.error[4:])
    np.testing.assert_allclose(found.covariance[4:, 4:], p[4:, 4:], rtol=1e-12)
    assert_near(np.array(found.error), gain @ np.array(y), 10.0 * np.sqrt(p.diagonal()))
    assert_near(
        found.covariance, remains @ p @ remains.T + gain @ noise @ gain.T, 100.0 * states * deviations(p)
    )


@pytest.mark.parametrize("algebra", BOTH)
def test_an_innovation_without_spread_is_no_update(algebra):
    assert update(np.eye(6), (1.0, 0.0, 0.0), np.zeros((3, 3)), np.zeros((3, 6)), None, algebra) is None


@pytest.mark.parametrize("algebra", BOTH)
@pytest.mark.parametrize("damage", [np.nan, np.inf])
def test_a_bad_number_reaches_the_diagonal(algebra, damage):
    """So that an estimate with one is known to be unsound after the next prediction."""
    p = np.eye(12)
    p[2, 9] = p[9, 2] = damage
    with np.errstate(invalid="ignore"):
        after = predict(p, np.full((MOVING, 12), 0.5), np.eye(12), (), algebra)
        found = update(p, (0.1, 0.2, 0.3), np.eye(3), np.ones((3, 12)), None, algebra)
    assert not np.isfinite(after.diagonal()).all()
    assert found is None or not np.isfinite(found.covariance.diagonal()).all()


@pytest.mark.parametrize("algebra", BOTH)
def test_arrays_that_go_in_are_not_changed(algebra):
    random = np.random.default_rng(1)
    p, f, q = covariance(random, 9), np.eye(6, 9), covariance(random, 9)
    y, noise, sensitivity = measurement(random, p, 3)
    given_arrays = (p, f, q, noise, sensitivity)
    before = [array.copy() for array in given_arrays]
    predict(p, f, q, (1.0, 2.0, 3.0), algebra)
    update(p, y, noise, sensitivity, slice(6, 9), algebra)
    assert all(map(np.array_equal, given_arrays, before))


def test_views_are_taken_as_what_they_show():
    random = np.random.default_rng(3)
    wide = random.normal(size=(12, 20))
    assert_near(product(wide[:, ::2], wide.T[::2]), wide[:, ::2] @ wide.T[::2])
    p = covariance(random, 12)
    assert_near(
        predict(p.T, wide[:6, 4:16], np.zeros((12, 12)), (), BOTH[0]),
        predict(p, wide[:6, 4:16].copy(), np.zeros((12, 12)), (), BOTH[0]),
    )


@given(seed=SEEDS)
def test_products_are_those_of_numpy(seed):
    random = np.random.default_rng(seed)
    k, m, n = random.integers(1, 30, 3)
    left, right = random.normal(size=(k, m)), random.normal(size=(m, n))
    assert_near(product(left, right), left @ right, np.abs(left) @ np.abs(right))


@given(seed=SEEDS)
def test_a_kick_adds_its_square_to_the_noise_of_the_rate(seed):
    random = np.random.default_rng(seed)
    p, f, kicks = covariance(random, 9), random.normal(size=(MOVING, 9)), random.normal(size=(2, 3))
    noise = np.zeros((9, 9))
    noise[3:6, 3:6] = kicks.T @ kicks
    for algebra in BOTH:
        after = predict(p, f, np.zeros((9, 9)), tuple(map(tuple, kicks.tolist())), algebra)
        assert_near(after, predict(p, f, noise, (), algebra))


def numbers(random, *sizes):
    """Tuples of as many numbers, some of them zero."""
    given_numbers = random.normal(size=sum(sizes)) * random.integers(0, 2, sum(sizes))
    parts = np.split(given_numbers, np.cumsum(sizes)[:-1])
    return tuple(tuple(part.tolist()) for part in parts)


def of_linear(random, states):
    return random.normal(size=(3, states)), numbers(random, 3, 9), random.normal(size=(12, 3 * states))


def of_two_maps(random, states):
    constant, first, second = random.normal(size=(6, states)), numbers(random, 3, 9), numbers(random, 9)
    return constant, first, random.normal(size=(12, 36)), second, random.normal(size=(9, 36))


def of_system_rows(random, states):
    torque = random.normal(size=(3, max(6, states - 5)))
    return random.normal(size=(6, states)), *numbers(random, 3, 9), torque


def of_series(order):
    def arguments(random, states):
        return np.eye(6, states) + 0.1 * random.normal(size=(6, states)), order

    return arguments


def of_sensitivity(random, states):
    constant, places = random.normal(size=(6, states)), (-1, 3, states - 3, states - 1, -1, -1)
    return constant, numbers(random, 3, 3), numbers(random, 3)[0], (0.3, 0.7), places


def of_diagonal(random, states):
    return (random.normal(size=(states, states)),)


def of_total_variance(random, states):
    return covariance(random, states), 6


def of_largest_variance(random, states):
    return covariance(random, states), states % 3, states - 2


def of_carry_trace(random, states):
    return random.normal(size=(states, 5)), transition(random, states)[:MOVING]


def of_move_bodies(random, states):
    x, dipoles, torques = (random.normal(size=(size, states)) for size in (7, 3, 3))
    x[:4] /= np.linalg.norm(x[:4], axis=0)
    acting = (*numbers(random, 3, 3, 3), 0.7)
    return x, 0.3, acting, dipoles, torques, *random.normal(size=(2, 9, states))


def of_unexplained(random, states):
    traced = random.normal(size=(20, states % 7 + 1))
    return (traced.T @ traced,)


def of_turn_along(random, states):
    directions, moved = random.integers(1, 5), states - 4
    coordinates = random.normal(size=(directions, states))
    moving = random.normal(size=(moved, moved * directions))
    return covariance(random, states), *numbers(random, states), 3, 0.7, coordinates, moving


def of_move_along(random, states):
    return covariance(random, max(states, 9)), *numbers(random, 6), 7


def of_fade(random, states):
    return covariance(random, states), covariance(random, states), 2, 5, 0.9


def of_shear(random, states):
    return covariance(random, states), random.normal(size=(3, states)), (1, 4, 5)


@pytest.mark.long
@pytest.mark.skipif(BOTH[0] is not Algebra.KERNEL, reason="the kernel is not built")
@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("linear", of_linear),
        ("linear", of_two_maps),
        ("system_rows", of_system_rows),
        ("series", of_series(2)),
        ("series", of_series(4)),
        ("sensitivity", of_sensitivity),
        ("diagonal", of_diagonal),
        ("total_variance", of_total_variance),
        ("largest_variance", of_largest_variance),
        ("carry_trace", of_carry_trace),
        ("move_bodies", of_move_bodies),
        ("unexplained", of_unexplained),
        ("turn_along", of_turn_along),
        ("move_along", of_move_along),
        ("fade", of_fade),
        ("shear", of_shear),
    ],
    ids=lambda one: one if isinstance(one, str) else one.__name__,
)
@given(sizes=SIZES, seed=SEEDS)
def test_the_kernel_computes_what_numpy_does_and_changes_nothing_that_goes_in(name, arguments, sizes, seed):
    given_arguments, again = (arguments(np.random.default_rng(seed), sizes[0]) for _ in range(2))
    ours = getattr(kalman._kernel, name)(*given_arguments)
    theirs = getattr(filterpy_algebra, name)(*again)
    assert_near(np.array(ours), np.array(theirs), np.abs(theirs).max() + 1.0, 100.0 * ROUNDING)
    assert pickle.dumps(given_arguments) == pickle.dumps(again)


@pytest.mark.skipif(BOTH[0] is not Algebra.KERNEL, reason="the kernel is not built")
class TestWhatTheKernelRefuses:
    @pytest.mark.parametrize(
        ("left", "right"), [((2, 3), (2, 3)), ((2,), (2, 3)), ((2, 3), (3,))], ids=["sizes", "left", "right"]
    )
    def test_products_that_are_none(self, left, right):
        with pytest.raises(ValueError, match="matrix of this size"):
            product(np.ones(left), np.ones(right))

    @pytest.mark.parametrize("shape", [(12, 11), (65, 65)])
    def test_covariances_that_are_none(self, shape):
        with pytest.raises(ValueError, match=r"square|size"):
            predict(np.ones(shape), np.ones((6, shape[1])), np.ones(shape), (), Algebra.KERNEL)

    @pytest.mark.parametrize("states", [slice(-1, 3), slice(4, 3), slice(0, 13)])
    def test_states_that_there_are_not(self, states):
        with pytest.raises(ValueError, match="considered"):
            update(np.eye(12), (1.0,), np.eye(1), np.ones((1, 12)), states, Algebra.KERNEL)

    @pytest.mark.parametrize("count", [0, 7])
    def test_more_or_fewer_numbers_than_an_update_takes(self, count):
        with pytest.raises(ValueError, match="1 to 6"):
            update(np.eye(9), (1.0,) * count, np.eye(count), np.ones((count, 9)), None, Algebra.KERNEL)

    @pytest.mark.parametrize(
        ("call", "arguments"),
        [
            ("linear", (np.ones((3, 9)), (1.0, 2.0), np.ones((3, 9)))),
            ("linear", (np.ones((3, 9)), (1.0, 2.0), np.ones((2, 30)))),
            ("linear", (np.ones((3, 9)), (1.0,), np.ones((1, 10)))),
            ("system_rows", (np.ones((6, 9)), (1.0,) * 3, (1.0,) * 9, np.ones((3, 10)))),
            ("system_rows", (np.ones((6, 9)), (1.0,) * 2, (1.0,) * 9, np.ones((3, 9)))),
            ("series", (np.ones((6, 65)), 2)),
            ("series", (np.ones((6, 9)), 3)),
            ("sensitivity", (np.ones((3, 9)), (1.0,) * 3, (1.0,) * 3, (1.0,), (9, -1, -1))),
            ("sensitivity", (np.ones((3, 9)), (1.0,) * 3, (1.0,) * 3, (1.0,), (-1, 7, -1))),
            ("sensitivity", (np.ones((3, 9)), (1.0,) * 3, (1.0,) * 3, (1.0,), (-1, -1, -2))),
            ("sensitivity", (np.ones((3, 9)), (1.0,) * 6, (1.0,) * 3, (1.0,) * 2, (-1,) * 6)),
            ("sensitivity", (np.ones((4, 9)), (1.0,) * 4, (1.0,) * 3, (1.0,), (-1,) * 4)),
            ("diagonal", (np.ones((3, 2)),)),
            ("total_variance", (np.ones((3, 2)), 1)),
            ("largest_variance", (np.eye(9), 4, 10)),
            ("largest_variance", (np.eye(9), 4, 4)),
            ("carry_trace", (np.ones((9, 2)), np.ones((6, 8)))),
            ("update", (np.eye(9), (1.0,), np.eye(1), np.ones((1, 9)), 0, 0, np.ones((8, 2)), np.eye(2))),
            ("update", (np.eye(9), (1.0,), np.eye(1), np.ones((1, 9)), 0, 0, np.ones((9, 2)), np.eye(3))),
            (
                "move_bodies",
                (np.ones((7, 4)), 0.1, (1.0,) * 9, *[np.ones((3, 4))] * 2, *[np.ones((9, 4))] * 2),
            ),
            ("move_bodies", (np.ones((7, 4)), 0.1, (1.0,) * 10, *[np.ones((3, 4))] * 3, np.ones((9, 4)))),
            ("unexplained", (np.ones((0, 0)),)),
            ("move_along", (np.eye(9), (1.0,) * 6, 5)),
            ("move_along", (np.eye(9), (1.0,) * 6, 8)),
            ("move_along", (np.eye(9), (1.0,) * 5, 7)),
            ("fade", (np.eye(9), np.eye(9), 4, 10, 0.9)),
            ("fade", (np.eye(9), np.eye(8), 4, 5, 0.9)),
            ("shear", (np.eye(9), np.ones((2, 9)), (1, 9))),
            ("shear", (np.eye(9), np.ones((2, 9)), (1, 2, 3))),
            ("turn_along", (np.eye(9), (1.0,) * 9, 4, 1.0, np.ones((1, 9)), np.ones((6, 6)))),
            ("turn_along", (np.eye(9), (1.0,) * 9, 0, 1.0, np.ones((5, 9)), np.ones((6, 30)))),
        ],
    )
    def test_what_does_not_fit_together(self, call, arguments):
        with pytest.raises(ValueError, match=r"size|square|numbers|first|map|rows|states|sums"):
            getattr(kalman._kernel, call)(*arguments)

    @pytest.mark.parametrize("bad", [[1.0], ("a",), ((1.0,), None)])
    def test_numbers_that_are_none(self, bad):
        with pytest.raises(TypeError):
            kalman.linear(np.ones((1, 1)), bad, np.ones((1, 1)))


@pytest.mark.parametrize("algebra", [kalman._kernel, filterpy_algebra], ids=["kernel", "filterpy"])
@pytest.mark.parametrize(
    ("variances", "total"),
    [((1.0, 2.0, 4.0), 7.0), ((1.0, 2.0, 0.0), 3.0), ((1.0, 0.0, 4.0), inf), ((1.0, 2.0, -1e-9), inf)],
    ids=["sound", "exact", "exact too early", "negative"],
)
def test_variances_that_cannot_be_have_no_finite_sum(algebra, variances, total):
    assert algebra.total_variance(np.diag(variances), 2) == total


@pytest.mark.skipif(BOTH[0] is not Algebra.KERNEL, reason="the kernel is not built")
def test_a_measurement_leaves_out_states_that_it_does_not_show():
    """As if their columns were not there: to the same bits."""
    random = np.random.default_rng(3)
    p = covariance(random, 12)
    y, noise, sensitivity = measurement(random, p, 3)
    sensitivity[:, 5:9] = 0.0
    whole = update(p, y, noise, sensitivity, None, BOTH[0])
    shown = [*range(5), *range(9, 12)]
    part = update(p[np.ix_(shown, shown)], y, noise, sensitivity[:, shown], None, BOTH[0])
    assert np.array_equal(whole.covariance[np.ix_(shown, shown)], part.covariance)
    assert [whole.error[place] for place in shown] == list(part.error)


class TestInverse:
    @pytest.mark.parametrize("size", [1, 3, 6, 12])
    def test_it_is_the_one_of_numpy(self, size):
        m = np.random.default_rng(size).normal(size=(size, size)) + 3.0 * np.eye(size)
        np.testing.assert_allclose(inverse(m), np.linalg.inv(m), rtol=1e-12, atol=1e-14)

    @pytest.mark.parametrize("m", [np.zeros((3, 3)), np.ones((6, 6)), np.full((6, 6), np.inf)])
    def test_what_has_none_gives_no_numbers_and_does_not_raise(self, m):
        with np.errstate(invalid="ignore"):
            assert not np.isfinite(inverse(m)).any()


def test_what_no_deviation_explains_is_the_rest_of_least_squares():
    random = np.random.default_rng(5)
    t, y = random.normal(size=(20, 4)), random.normal(size=20)
    all_of_it = np.column_stack((t, y))
    ridge = np.linalg.solve(t.T @ t + np.eye(4), t.T @ y)
    assert unexplained(all_of_it.T @ all_of_it) == pytest.approx(y @ y - (t.T @ y) @ ridge, rel=1e-12)
    assert unexplained(np.array([[7.5]])) == 7.5
