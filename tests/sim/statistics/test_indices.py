"""Pointing indices of histories whose figures are known, under the three interpretations."""

import numpy as np
import pytest
from scipy.special import ndtri, stdtrit

from sim.statistics.indices import (
    POINTS,
    Interpretation,
    Windows,
    index_histories,
    mean_and_relative,
    percentile,
    profile,
    table,
)

TEMPORAL, ENSEMBLE, MIXED = Interpretation.TEMPORAL, Interpretation.ENSEMBLE, Interpretation.MIXED


def test_an_offset_is_all_mean_and_a_jitter_all_relative():
    jitter = np.where(np.arange(1200) % 2 == 0, 0.3, -0.3)[:, None] * [0.0, 0.6, 0.8]
    error = np.array([1.0, 2.0, 2.0]) + jitter
    knowledge = np.tile([0.0, 0.3, -0.4], (1200, 1))
    found = index_histories(error, knowledge, window=100)
    assert found["mpe"] == pytest.approx(np.full(12, 3.0))
    assert found["rpe"] == pytest.approx(np.full(1200, 0.3))
    assert found["ake"] == pytest.approx(np.full(1200, 0.5))
    assert found["ape"] == pytest.approx(np.linalg.norm(error, axis=1))


def test_the_last_window_ends_with_the_run_and_overlaps_the_one_before():
    """0 but in the last 30 of 250 rows: of the last 100, the mean is 0.3 of it."""
    error = np.zeros((250, 3))
    error[220:, 1] = 10.0
    found = index_histories(error, np.zeros((250, 3)), window=100)
    assert found["mpe"] == pytest.approx([0.0, 0.0, 3.0])
    assert found["rpe"] == pytest.approx([0.0] * 200 + [3.0] * 20 + [7.0] * 30)
    short = index_histories(error[-40:], np.zeros((40, 3)), window=100)
    assert short["mpe"] == pytest.approx([7.5])
    assert short["rpe"] == pytest.approx([7.5] * 10 + [2.5] * 30)


@pytest.mark.parametrize("window", [1, 7, 100, 250, 400])
def test_windows_are_the_same_however_the_errors_come(window):
    error = np.random.default_rng(11).normal(size=(250, 3))
    whole = mean_and_relative(error, window)
    for cuts in ((), (1,), (99, 100, 101), (0, 249), range(0, 250, 13)):
        windows = Windows(window)
        found = [windows.take(part) for part in np.split(error, cuts)] + [windows.rest()]
        for expected, parts in zip(whole, zip(*found, strict=True), strict=True):
            assert np.concatenate(parts) == pytest.approx(expected, rel=1e-12)
    assert len(whole[1]) == 250


def test_a_profile_has_the_quantiles_and_the_largest():
    values = np.random.default_rng(8).rayleigh(size=5000)
    found = profile(values)
    assert len(found) == POINTS
    assert found[-1] == values.max()
    assert np.quantile(found[:-1], 0.8) == pytest.approx(np.quantile(values, 0.8), rel=0.01)


def profiles_of(scales, size=4000):
    """Runs whose index is uniform over time from 0 to a scale."""
    return np.array([profile(scale * (np.arange(size) + 1.0) / size) for scale in scales])


def test_temporal_is_the_worst_run():
    found = percentile(profiles_of([1.0, 4.0, 2.0]), TEMPORAL, 0.75, 0.9)
    assert found.value == found.bound == pytest.approx(3.0, rel=0.01)
    assert found.held == pytest.approx(0.1 ** (1.0 / 3.0))


def test_ensemble_is_the_percentile_of_the_largest_values():
    scales = np.random.default_rng(9).permutation(np.arange(1.0, 101.0))
    found = percentile(profiles_of(scales), ENSEMBLE, 0.9, 0.9)
    assert found.value == pytest.approx(np.quantile(scales, 0.9))
    assert found.bound == 95.0  # P(B(100, 0.9) <= 94) = 0.942, P(B <= 93) = 0.883
    assert percentile(profiles_of(scales[:20]), ENSEMBLE, 0.9, 0.9).bound is None


def test_mixed_pools_all_times_of_all_runs():
    found = percentile(profiles_of([1.0, 3.0]), MIXED, 0.75, 0.9)
    assert found.value == pytest.approx(1.5, rel=0.01)  # half of the first run's times and half of 3's


@pytest.mark.long
def test_the_bound_of_mixed_is_wider_the_more_runs_differ():
    alike = percentile(profiles_of(np.full(300, 2.0)), MIXED, 0.9, 0.9)
    differing = percentile(profiles_of(np.linspace(1.0, 3.0, 300)), MIXED, 0.9, 0.9)
    assert alike.bound == pytest.approx(alike.value / 0.1 ** (1.0 / 300.0), rel=2e-3)
    assert differing.bound > 1.02 * differing.value


@pytest.mark.long
@pytest.mark.parametrize(("runs", "least", "most"), [(50, 0.88, 1.0), (400, 0.84, 0.96)])
def test_the_bound_of_mixed_covers_the_truth_as_often_as_it_says(runs, least, most):
    """Runs are Gaussian about a mean of their own: the pool is Gaussian with both variances."""
    random, truth = np.random.default_rng(10), 2.0**0.5 * ndtri(0.9)
    quantiles = ndtri((np.arange(POINTS - 1) + 0.5) / (POINTS - 1))
    covered = 0
    for _ in range(300):
        pool = random.normal(size=(runs, 1)) + quantiles
        covered += percentile(np.hstack((pool, pool[:, -1:])), MIXED, 0.9, 0.9).bound >= truth
    assert least < covered / 300 <= most


@pytest.mark.parametrize(("runs", "part"), [(45, 0.02), (45, 0.03), (100, 0.02), (60, 0.045)])
def test_it_does_so_where_a_few_runs_are_of_another_kind(runs, part):
    """Ten times worse at all times; the error of the others is uniform from 0 to 1 over time."""
    random, truth = np.random.default_rng(11), 0.95 / (1.0 - part)
    alike, covered = profiles_of([1.0], size=2000), 0
    for _ in range(300):
        scales = np.where(random.random((runs, 1)) < part, 1000.0, 1.0)
        bound = percentile(scales * alike, MIXED, 0.95, 0.9).bound
        covered += bound is None or bound >= truth * (1.0 - 1e-3)
    assert covered / 300 > 0.88


@pytest.mark.parametrize(
    ("limit", "verdict"), [(89.0, False), (90.5, None), (94.9, None), (95.0, True), (200.0, True)]
)
def test_a_limit_is_met_by_the_bound_and_missed_by_the_value(limit, verdict):
    found = percentile(profiles_of(np.arange(1.0, 101.0)), ENSEMBLE, 0.9, 0.9)
    assert found.within(limit) is verdict


def test_without_a_bound_more_runs_must_tell():
    found = percentile(profiles_of([1.0, 2.0]), ENSEMBLE, 0.9, 0.9)
    assert (found.within(1.0), found.within(5.0)) == (False, None)


def test_one_run_has_no_bound_and_a_table_has_every_index():
    profiles = {"ape": profiles_of([1.0]), "mpe": profiles_of([2.0])}
    found = table(profiles, 0.9, 0.9)
    assert found["ape"][MIXED].bound is None
    assert found["mpe"][TEMPORAL].value == pytest.approx(1.8, rel=0.01)


@pytest.mark.parametrize("probability", [0.5, 0.9, 0.95, 0.99, 0.998])
@pytest.mark.parametrize("how", [TEMPORAL, MIXED])
def test_a_probability_over_time_is_taken_where_it_is_stated(how, probability):
    """The index is uniform from 0 to 1: its percentile is the probability."""
    found = percentile(profiles_of([1.0], size=400_000), how, probability, 0.9)
    assert found.value == pytest.approx(probability, abs=1e-5)


@pytest.mark.parametrize("how", [TEMPORAL, MIXED])
def test_above_the_last_quantile_the_largest_value_counts(how):
    values = np.append(np.linspace(0.0, 1.0, 99_999), 50.0)
    assert percentile(profile(values)[None], how, 0.9999, 0.9).value == 50.0


def test_few_values_over_time_are_no_less_than_what_holds():
    """Of nine windows, only the largest value holds for 95 % of them."""
    assert percentile(profile(np.arange(9.0))[None], TEMPORAL, 0.95, 0.9).value == 8.0


@pytest.mark.parametrize("runs", [1, 2, 5, 44])
@pytest.mark.parametrize("spread", [0.0, 1.0])
def test_few_runs_have_no_bound_of_mixed(runs, spread):
    """ln(1 - 0.9) / ln 0.95 is 45 runs, alike or not."""
    found = percentile(profiles_of(1.0 + spread * np.arange(runs)), MIXED, 0.95, 0.9)
    assert found.bound is None
    assert found.within(1e3) is None


QUANTILES = ndtri((np.arange(POINTS - 1) + 0.5) / (POINTS - 1))


@pytest.mark.parametrize("runs", [45, 100])
@pytest.mark.parametrize(("between", "within"), [(1.0, 0.001), (1.0, 0.3), (1.0, 1.0), (0.3, 1.0)])
def test_the_bound_of_mixed_covers_the_truth_however_much_runs_differ(runs, between, within):
    """The pool is Gaussian with the variance between runs and that within."""
    random, truth = np.random.default_rng(12), np.hypot(between, within) * ndtri(0.95)
    covered, trials = 0, 150
    for _ in range(trials):
        pool = between * random.normal(size=(runs, 1)) + within * QUANTILES
        bound = percentile(np.hstack((pool, pool[:, -1:])), MIXED, 0.95, 0.9).bound
        covered += bound is None or bound >= truth
    assert covered / trials > 0.85  # 0.9 as stated, less two standard deviations of the trials


def test_the_bound_of_mixed_uses_students_quantile():
    """Half of the runs up to the value, half above it: the deviation is 0.5 sqrt(n / (n - 1))."""
    levels = np.repeat([1.0, 2.0], 4)
    pool = levels[:, None] * np.ones(POINTS) + np.linspace(0.0, 0.5, POINTS)
    found = percentile(pool, MIXED, 0.5, 0.9)
    shift = stdtrit(7, 0.9) * 0.5 * (8.0 / 7.0) ** 0.5 / 8.0**0.5
    assert found.bound == pytest.approx(np.quantile(pool[:, :-1], 0.5 + shift, method="hazen"))


@pytest.mark.parametrize("how", list(Interpretation))
def test_a_limit_is_missed_where_more_runs_failed_than_it_leaves(how):
    found = percentile(profiles_of(np.full(90, 1.0)), how, 0.9, 0.9, failed=11)
    assert found.value == np.inf
    assert found.within(5.0) is False


@pytest.mark.parametrize("how", list(Interpretation))
def test_with_some_runs_failed_a_limit_is_not_met(how):
    found = percentile(profiles_of(np.full(90, 1.0)), how, 0.9, 0.9, failed=10)
    assert found.value <= 1.0
    assert found.within(5.0) is None


def test_with_few_runs_failed_most_of_the_ensemble_still_meets_a_limit():
    found = percentile(profiles_of(np.full(98, 1.0)), ENSEMBLE, 0.9, 0.9, failed=2)
    assert found.within(5.0) is True


@pytest.mark.parametrize("how", list(Interpretation))
def test_where_no_run_was_flown_nothing_is_met(how):
    assert percentile(np.empty((0, POINTS)), how, 0.95, 0.9, failed=3).within(5.0) is False
