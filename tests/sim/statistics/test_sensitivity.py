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
