"""Clopper-Pearson against scipy's own, and against the binomial sums that define it."""

import pytest
from scipy import stats

from sim.statistics.proportion import clopper_pearson


@pytest.mark.parametrize(("count", "total"), [(0, 20), (1, 20), (17, 20), (20, 20), (990, 1000)])
def test_bounds_are_those_of_scipy(count, total):
    found = clopper_pearson(count, total, 0.95)
    exact = stats.binomtest(count, total).proportion_ci(0.95, method="exact")
    assert (found.low, found.high) == pytest.approx((exact.low, exact.high), abs=1e-9)
    assert found.value == count / total


def test_a_bound_leaves_half_of_the_rest_on_its_side():
    found = clopper_pearson(7, 31, 0.9)
    assert stats.binom.sf(6, 31, found.low) == pytest.approx(0.05)
    assert stats.binom.cdf(7, 31, found.high) == pytest.approx(0.05)
