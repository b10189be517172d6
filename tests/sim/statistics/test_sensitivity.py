"""Rank correlation against scipy, with ties and missing results."""

import numpy as np
import pytest
from scipy import stats

from sim.statistics.sensitivity import ranks, spearman

INPUTS = np.random.default_rng(4).normal(size=60).round(1)  # rounded, so that some are equal
RESULTS = np.exp(INPUTS) + np.random.default_rng(5).normal(size=60)


def test_the_coefficient_is_that_of_scipy():
    found = spearman(INPUTS, RESULTS, 0.95)
    assert found.value == pytest.approx(stats.spearmanr(INPUTS, RESULTS).statistic)
    assert found.low < found.value < found.high
    assert found.significant


def test_equal_values_share_their_rank():
    assert ranks(np.array([3.0, 1.0, 3.0, 7.0])).tolist() == stats.rankdata([3.0, 1.0, 3.0, 7.0]).tolist()


def test_runs_without_the_figure_do_not_count():
    results = RESULTS.copy()
    results[::7] = np.nan
    known = np.isfinite(results)
    assert spearman(INPUTS, results, 0.9) == spearman(INPUTS[known], results[known], 0.9)


def test_runs_that_failed_are_the_worst_of_all():
    """An input that makes runs fail matters, though the others do not depend on it."""
    random = np.random.default_rng(7)
    inputs, results = random.uniform(size=200), random.normal(size=200)
    failed = inputs > 0.7
    assert not spearman(inputs[~failed], results[~failed], 0.9).significant
    results[failed] = np.inf
    found = spearman(inputs, results, 0.9)
    assert found.value == pytest.approx(stats.spearmanr(inputs, np.where(failed, 1e9, results)).statistic)
    assert found.low > 0.5
    assert spearman(inputs, -results, 0.9).value == pytest.approx(-found.value)


def test_four_runs_in_order_are_no_proof():
    """One order of 24 and its reverse have all ranks agree."""
    found = spearman(np.arange(4.0), np.arange(4.0), 0.95)
    assert (found.value, found.high) == (1.0, pytest.approx(1.0, abs=0.01))
    assert not found.significant


@pytest.mark.parametrize(("count", "true"), [(20, 0.5), (100, 0.8), (300, 0.9)])
def test_the_bounds_cover_the_truth_as_often_as_they_say(count, true):
    """Of Gaussian variables the rank correlation is 6 / pi asin(rho / 2)."""
    random, rho = np.random.default_rng(8), 2.0 * np.sin(np.pi * true / 6.0)
    covered = 0
    for _ in range(400):
        x, noise = random.normal(size=(2, count))
        found = spearman(x, rho * x + (1.0 - rho**2) ** 0.5 * noise, 0.9)
        covered += found.low <= true <= found.high
    assert 0.84 < covered / 400 < 0.96


def test_what_does_not_vary_has_no_correlation():
    assert spearman(np.ones(60), RESULTS, 0.9) is None
    assert spearman(INPUTS, np.ones(60), 0.9) is None
    assert spearman(INPUTS[:3], RESULTS[:3], 0.9) is None


def test_bounds_cover_zero_as_often_as_they_say():
    random = np.random.default_rng(6)
    drawn = [spearman(random.normal(size=40), random.normal(size=40), 0.9) for _ in range(400)]
    assert 0.86 < sum(not each.significant for each in drawn) / 400 < 0.94


def test_a_monotonic_dependence_has_all_of_it():
    assert spearman(INPUTS, INPUTS**3, 0.9).value == pytest.approx(1.0)
    assert spearman(INPUTS, -INPUTS, 0.9).value == pytest.approx(-1.0)
