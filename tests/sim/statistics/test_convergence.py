"""A percentile by number of runs ends with that of all."""

import numpy as np
import pytest

from sim.statistics.convergence import convergence
from sim.statistics.order_statistics import percentile


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
