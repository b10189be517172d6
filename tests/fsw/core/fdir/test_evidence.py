"""The sequential test: its threshold by the budget, what a sample may weigh, and how rarely it errs."""

from math import exp, log, sqrt

import numpy as np
import pytest

from fsw.core.estimation.mekf import LAG_S
from fsw.core.fdir.evidence import (
    BLIND_S,
    CHANCE,
    CORRELATION_S,
    DAY_S,
    INFLATION,
    MISS,
    mean_misfit,
    misfit,
    weigh,
    weights,
)

DAYS = 40.0


@pytest.fixture(params=[1.0, 0.1], ids=["1 Hz", "10 Hz"])
def tick_s(request):
    return request.param


def time_to(threshold, by, tick_s):
    """Seconds of samples that all weigh ``by`` until they reach the threshold."""
    nats, ticks = 0.0, 0
    while nats < threshold:
        nats, ticks = weigh(nats, by, threshold), ticks + 1
    return ticks * tick_s


def test_the_threshold_is_the_budget_in_independent_samples(tick_s):
    threshold = weights(DAYS, tick_s).threshold
    assert CORRELATION_S * exp(threshold) == pytest.approx(DAYS * DAY_S)
    assert weights(10.0 * DAYS, tick_s).threshold - threshold == pytest.approx(log(10.0))


def test_the_times_do_not_depend_on_the_tick(tick_s):
    known = weights(DAYS, tick_s)
    assert time_to(known.threshold, known.against, tick_s) == pytest.approx(29.0, abs=1.0)
    assert time_to(known.threshold, known.fits, tick_s) == pytest.approx(129.0, abs=1.0)
    assert time_to(known.threshold, known.agrees, tick_s) == pytest.approx(515.0, abs=2.0)
    assert known.blind_ticks * tick_s == pytest.approx(BLIND_S)


def test_a_good_sample_takes_back_what_a_bad_one_has_brought():
    assert weigh(weigh(3.0, 0.5, 14.0), -0.5, 14.0) == 3.0
    assert weigh(0.2, -0.5, 14.0) == 0.0, "no credit is saved up"
    assert weigh(13.9, 0.5, 14.0) == 14.0, "nor blame beyond the threshold"


def test_one_sample_that_does_not_fit_undoes_many_that_do():
    known = weights(DAYS, 1.0)
    assert -known.misfits > 40 * known.fits
    assert -known.misfits < known.threshold, "but not all"


RATES_HZ = [1, 10, 20, 50]


def highest(known, fits):
    """The most evidence that an isolated sensor gathers, sample by sample."""
    nats = most = 0.0
    for fit in fits:
        nats = weigh(nats, known.fits if fit else known.misfits, known.threshold)
        most = max(most, nats)
    return most


def test_at_1_hz_one_that_does_not_fit_counts_in_full_and_at_other_rates_its_share():
    assert weights(DAYS, 1.0).misfits == log(MISS / (1.0 - CHANCE))
    assert weights(DAYS, 0.05).misfits == pytest.approx(0.05 * log(MISS / (1.0 - CHANCE)))


@pytest.mark.parametrize("hz", RATES_HZ)
def test_what_the_gate_refuses_of_a_sound_sensor_keeps_it_out_at_no_rate(hz):
    """Three of 1000 samples, as flown."""
    for seed in range(5):
        fits = np.random.default_rng(seed).random(600 * hz) >= 3.0 * MISS
        known = weights(DAYS, 1.0 / hz)
        assert highest(known, fits) == known.threshold


@pytest.mark.parametrize("hz", RATES_HZ)
@pytest.mark.parametrize("part", [0.2, 1.0])
def test_a_faulty_sensor_comes_back_at_no_rate(hz, part):
    """Of which this part of the samples does not fit."""
    known = weights(DAYS, 1.0 / hz)
    for seed in range(3):
        fits = np.random.default_rng(seed).random(1800 * hz) >= part
        assert highest(known, fits) < 0.6 * known.threshold


@pytest.mark.parametrize("hz", RATES_HZ)
def test_one_that_is_wrong_for_seconds_gains_at_no_rate_more_than_at_1_hz(hz):
    seconds = np.random.default_rng(4).random(1800) >= 0.05
    slow, known = weights(DAYS, 1.0), weights(DAYS, 1.0 / hz)
    assert 0.2 * slow.threshold < highest(slow, seconds) < slow.threshold
    assert highest(known, np.repeat(seconds, hz)) == pytest.approx(highest(slow, seconds))


def test_innovations_of_a_sound_filter_weigh_for_it_and_larger_ones_against():
    assert misfit(6.0, 6) == -1.0
    assert misfit(10.0, 6) == pytest.approx(3.75 - 6.0 * log(2.0))
    assert misfit(11.0, 6) < 0.0 < misfit(11.2, 6)
    assert 0.0 < misfit(11.5, 6) < 1.0
    assert misfit(40.0, 6) == 1.0, "no sample weighs more than a nat in the time of correlation"
    assert misfit(0.0, 0) == 0.0


@pytest.mark.long
@pytest.mark.parametrize(("inflation", "raises"), [(1.0, False), (1.5, False), (4.0, True)])
def test_noise_raises_no_alarm_in_a_month_and_innovations_that_are_too_large_do(inflation, raises):
    random, known = np.random.default_rng(7), weights(DAYS, 1.0)
    nats = 0.0
    for nis in inflation * random.chisquare(6, size=30 * 86400 if not raises else 600):
        nats = weigh(nats, known.against * misfit(float(nis), 6), known.threshold)
        if nats == known.threshold:
            break
    assert (nats == known.threshold) is raises


@pytest.mark.long
def test_what_the_gate_refuses_of_a_sound_sensor_isolates_it_less_often_than_the_budget():
    random, known = np.random.default_rng(8), weights(DAYS, 1.0)
    highest = nats = 0.0
    for refused in random.random(30 * 86400) < 20.0 * MISS:  # twenty times as often as it should
        nats = weigh(nats, known.against if refused else -known.against, known.threshold)
        highest = max(highest, nats)
    assert highest < 0.5 * known.threshold


class TestMean:
    """The mean of innovations that are white is small; a filter that lags behind its sensors has one."""

    def test_is_weighed_as_a_chi_square_of_the_sensor_that_is_further_off(self):
        known = weights(DAYS, 1.0)
        assert known.averaged == pytest.approx(119.0), "of a mean with a time constant of 60 samples"
        means = (0.3, -0.4, 0.2, 0.1, 0.0, 0.5)
        assert mean_misfit(means, known) == pytest.approx(0.5 * 119.0 * 0.29 / INFLATION)
        assert mean_misfit((*means[3:], *means[:3]), known) == mean_misfit(means, known)

    def test_of_readings_that_stand_still_it_is_as_much_less_as_they_vary_more(self):
        plain, coarse = weights(DAYS, 1.0), weights(DAYS, 1.0, of_steps=(0.5, 0.0))
        field, sun = (0.3, -0.4, 0.2, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.1, 0.0, 0.5)
        assert plain.lasting == (1.0, 1.0)
        assert mean_misfit(field, coarse) == pytest.approx(mean_misfit(field, plain) / (1.0 + 0.5 * 119.0))
        assert mean_misfit(sun, coarse) == mean_misfit(sun, plain)

    def test_of_an_error_within_a_step_that_lasts_is_no_contradiction(self):
        """Three axes at the edge of their steps, with next to no noise."""
        edge = (0.95 * sqrt(3.0),) * 3 + (0.0,) * 3
        assert mean_misfit(edge, weights(DAYS, 1.0)) > weights(DAYS, 1.0).threshold
        known = weights(DAYS, 1.0, of_steps=(0.9, 0.0))
        assert mean_misfit(edge, known) < 0.1 * known.threshold

    @pytest.mark.parametrize("tick_s", [1.0, 0.1])
    def test_of_noise_twice_as_large_as_the_filter_says_is_no_contradiction(self, tick_s):
        random, known = np.random.default_rng(11), weights(DAYS, tick_s)
        assert self.most(random.normal(0.0, 2.0, (20_000, 6)), known, tick_s) < known.threshold

    @pytest.mark.parametrize("tick_s", [1.0, 0.1])
    def test_of_a_lag_of_as_much_as_the_noise_is(self, tick_s):
        random, known = np.random.default_rng(12), weights(DAYS, tick_s)
        numbers = random.normal(0.0, 1.0, (round(300 / tick_s), 6))
        assert self.most(numbers, known, tick_s) < known.threshold
        numbers[:, 1] += 1.2
        assert self.most(numbers, known, tick_s) > known.threshold

    @staticmethod
    def most(numbers, known, tick_s):
        means, most = np.zeros(6), 0.0
        for number in numbers:
            means += tick_s / LAG_S * (number - means)
            most = max(most, mean_misfit(tuple(means), known))
        return most
