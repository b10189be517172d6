"""Quantiles of a histogram of times, against the ranks of all of them."""

import random

import pytest

from sim.bench.time_histogram import TimeHistogram

PARTS = (0.0, 0.5, 0.9, 0.99, 1.0)


def ranked(seconds, part):
    return sorted(seconds)[min(len(seconds) - 1, int(part * len(seconds)))]


@pytest.mark.parametrize("number", [1, 2, 3, 99, 1000])
def test_quantiles_are_true_to_a_hundredth_and_never_too_small(number):
    stream = random.Random(number)
    seconds = [stream.lognormvariate(-6.0, 2.0) for _ in range(number)]
    times = TimeHistogram(seconds)
    for part in PARTS:
        exact = ranked(seconds, part)
        assert exact * (1.0 - 1e-12) <= times.quantile(part) <= exact * 1.01


def test_the_longest_is_exact_however_long_and_nothing_is_too_short():
    assert TimeHistogram([1e-3, 7.654321e3]).quantile(1.0) == 7.654321e3
    assert TimeHistogram([0.0]).quantile(0.5) == 0.0
    assert TimeHistogram([2e-9, 1e-3]).quantile(0.0) <= 1e-6


def test_where_nothing_was_counted_no_budget_is_kept():
    assert [TimeHistogram().quantile(part) for part in PARTS] == [float("inf")] * len(PARTS)


def test_they_take_no_more_memory_the_more_there_are():
    stream, times = random.Random(1), TimeHistogram()
    for _ in range(20_000):
        times.add(stream.uniform(1e-4, 1e-1))
    assert len(times._counts) < 750
