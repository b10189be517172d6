"""Bounds of percentiles against binomial sums written out, and against the coverage that they promise."""

from math import comb

import numpy as np
import pytest
from scipy import stats

from sim.statistics.order_statistics import (
    convergence,
    least_part_bounded,
    lower_bound,
    percentile,
    quantile,
    runs_needed,
    upper_bound,
)


def confidence_of(rank, count, probability):
    """P(B <= rank - 1) with B ~ (count, probability): that of the rank-th value as an upper bound."""
    return sum(comb(count, k) * probability**k * (1 - probability) ** (count - k) for k in range(rank))


@pytest.mark.parametrize("count", [5, 59, 60, 200])
@pytest.mark.parametrize("probability", [0.1, 0.5, 0.95])
def test_the_upper_bound_is_the_first_value_with_the_confidence(count, probability):
    values = np.random.default_rng(1).permutation(np.arange(1.0, count + 1.0))
    bound = upper_bound(values, probability, 0.95)
    ranks = [rank for rank in range(1, count + 1) if confidence_of(rank, count, probability) >= 0.95]
    assert bound == (float(ranks[0]) if ranks else None)


def test_fifty_nine_runs_bound_95_percent_with_95_percent_confidence():
    values = np.arange(59.0)
    assert upper_bound(values, 0.95, 0.95) == 58.0
    assert upper_bound(values[:58], 0.95, 0.95) is None
    assert runs_needed(0.95, 0.95) == 59
    assert least_part_bounded(59, 0.95) == pytest.approx(0.95, abs=1e-3)
    assert least_part_bounded(59, 0.95) > 0.95


def test_the_lower_bound_mirrors_the_upper():
    values = np.random.default_rng(2).exponential(size=77)
    assert lower_bound(values, 0.2, 0.9) == -upper_bound(-values, 0.8, 0.9)


def test_two_sides_share_what_is_left_of_the_confidence():
    values = np.random.default_rng(4).gamma(2.0, size=130)
    found = percentile(values, 0.7, 0.9)
    assert (found.low, found.high) == (lower_bound(values, 0.7, 0.95), upper_bound(values, 0.7, 0.95))
    assert found.high > upper_bound(values, 0.7, 0.9)


def test_bounds_cover_the_percentile_as_often_as_they_say():
    random, truth = np.random.default_rng(3), stats.lognorm(0.7).ppf(0.9)
    covered = 0
    for _ in range(400):
        found = percentile(random.lognormal(0.0, 0.7, 150), 0.9, 0.9)
        covered += found.low <= truth <= found.high
    assert covered / 400 > 0.87


def test_a_percentile_without_enough_runs_has_no_bound_on_that_side():
    found = percentile(np.arange(10.0), 0.95, 0.9)
    assert found.high is None
    assert found.low is not None
    assert found.value == pytest.approx(8.55)


@pytest.mark.parametrize("probability", [0.0, 0.05, 0.5, 0.77, 0.95, 1.0])
@pytest.mark.parametrize(("middles", "method"), [(False, "linear"), (True, "hazen")])
def test_a_quantile_of_finite_values_is_linear_between_them(probability, middles, method):
    values = np.random.default_rng(4).normal(size=41)
    expected = np.quantile(values, probability, method=method)
    assert quantile(values, probability, middles) == pytest.approx(expected, rel=1e-12)


def test_a_quantile_between_a_value_and_an_infinite_one_is_what_the_part_does_not_exceed():
    values = np.append(np.arange(38.0), [np.inf, np.inf])
    assert quantile(values, 0.95) == 37.0, "38 of 40"
    assert quantile(values, 0.951) == np.inf
    assert quantile(-values, 0.05) == -np.inf
    assert quantile(np.full(3, np.inf), 0.5) == np.inf


@pytest.mark.parametrize(("count", "above"), [(10, 1), (40, 2), (40, 39)])
def test_what_all_but_some_values_bound_is_a_binomial_sum(count, above):
    part = least_part_bounded(count, 0.9, above)
    assert confidence_of(count - above, count, part) == pytest.approx(0.9)
    assert least_part_bounded(count, 0.9, count) == 0.0


# --- A percentile by number of runs ends with that of all


def test_it_ends_with_all_runs_and_its_bounds_close():
    values = np.random.default_rng(7).gamma(2.0, size=500)
    found, whole = convergence(values, 0.5, 0.9), percentile(values, 0.5, 0.9)
    assert found.runs[-1] == 500.0
    assert (found.value[-1], found.low[-1], found.high[-1]) == (whole.value, whole.low, whole.high)
    widths = found.high - found.low
    assert widths[-1] < 0.5 * np.nanmax(widths)
    assert np.isnan(found.high[0])


@pytest.mark.parametrize("count", [1, 2, 3])
def test_few_runs_are_no_error(count):
    assert convergence(np.arange(float(count)), 0.95, 0.9).runs[-1] == count
