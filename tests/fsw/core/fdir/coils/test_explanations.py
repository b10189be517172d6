"""Which coil a solution isolates: by how much, how surely, and never one of two that look alike."""

from dataclasses import astuple, replace
from math import sqrt

import numpy as np
import pytest
from estimator_samples import tuned
from scipy.stats import chi2, norm

from fsw.core.estimation import mekf
from fsw.core.estimation.parameters import Prior
from fsw.core.fdir.coils.explanations import (
    ALL,
    NONE,
    STRAY,
    Solution,
    explain_pulses,
    most_by_chance,
    oldest_pulse,
    sum_pulses,
    weak_by_gain,
    weak_by_pulses,
    weigh_gains,
)
from fsw.core.fdir.coils.health import NONE_OLDER
from fsw.core.fdir.coils.weak_test import (
    MODEL_ERROR,
    NO_PULSES,
    NOTHING_OLDER,
    Older,
    PartSum,
    WeakTest,
)
from fsw.core.fdir.evidence import SIGMAS

WEAK = WeakTest(0.7, 0.8, 14.0)


def solution(causes, deviation, sigma, correlation=0.0, uncertain=MODEL_ERROR):
    sigma = np.array(sigma)
    shape = np.eye(len(sigma)) + correlation * (1.0 - np.eye(len(sigma)))
    deviation = np.array(deviation)
    covariance, uncertain = shape * np.outer(sigma, sigma), np.broadcast_to(uncertain, sigma.shape)
    return Solution(tuple(causes), 1.0 + deviation, deviation, covariance, uncertain)


def weak(*arguments, earlier=NONE_OLDER, believed=WEAK.weak_part):
    return weak_by_pulses(solution(*arguments), earlier, WEAK, believed)


@pytest.mark.parametrize("coil", [0, 1, 2])
@pytest.mark.parametrize("part", [0.3, 0.0, -1.0])
def test_two_pulses_that_did_too_little_accuse_their_coil(coil, part):
    other, lack = (coil + 1) % 3, part - 1.0
    accused = weak((coil, other, coil), (lack, 0.02, lack + 0.01), (0.04, 0.03, 0.05))
    assert accused == (coil, pytest.approx(part, abs=0.01))


@pytest.mark.parametrize(
    ("causes", "deviation", "sigma"),
    [
        ((0, 2), (-0.9, 0.01), (0.03, 0.04)),
        ((0, 0), (-0.9, -0.2), (0.03, 0.9)),
        ((0, 0), (-0.9, -0.9), (0.2, 0.2)),
        ((0, 0), (-0.35, -0.35), (0.03, 0.03)),
        ((0, 0), (0.9, 0.9), (0.03, 0.03)),
        ((0, 0, 1, 1), (-0.9, -0.9, -0.9, -0.9), (0.03, 0.03, 0.03, 0.03)),
        ((2, 1, 2), (-0.7, -0.6, -3.0), (0.05, 0.05, 0.05)),
    ],
    ids=[
        "one pulse",
        "and one that says nothing",
        "unsure",
        "hardly weak",
        "strong",
        "two coils at once",
        "what no coil can do",
    ],
)
def test_they_accuse_nobody(causes, deviation, sigma):
    assert weak(causes, deviation, sigma) is None


def test_no_coil_is_looked_at_where_one_fraction_of_all_pulses_fits():
    found = solution((0, 1, 0), (-0.5, -0.51, -0.49), (0.04, 0.03, 0.05)).explanations
    assert [one.coil for one in found] == [ALL, NONE]
    assert [one.fits for one in found] == [True, False]


def test_a_coil_that_failed_between_two_pulses_is_accused_by_the_later_ones():
    accused = weak((1, 1, 1, 0), (-1.0, -0.98, 0.03, 0.0), (0.04, 0.04, 0.05, 0.05))
    assert accused == (1, pytest.approx(0.0, abs=0.02))


class TestPulsesTracedNoLonger:
    """Pulses that show little by themselves add up, beyond those that are traced."""

    UNSURE = ((1, 2, 1, 1), (-0.8, 0.02, -0.75, -0.7), (0.2, 0.05, 0.2, 0.2))
    WEIGHT = 1.0 / (0.2**2 / (1.0 - 0.2**2) + MODEL_ERROR**2)

    def sums(self, part):
        return self.WEIGHT, self.WEIGHT * part, self.WEIGHT * part**2

    @staticmethod
    def solved(coil, errors, variances):
        """The solution of pulses that lack ``errors``, each measured by itself with its own variance."""
        solved = [variance / (1.0 + variance) for variance in variances]
        deviation = [error / (1.0 + variance) for error, variance in zip(errors, variances, strict=True)]
        return solution((coil,) * len(errors), deviation, np.sqrt(solved))

    def older(self, coil, part, pulses=2):
        parts = PartSum(*(pulses * each for each in (1, *self.sums(part))))
        return tuple(Older(parts) if coil == other else NOTHING_OLDER for other in range(3))

    def test_what_pulses_show_is_their_part_by_its_variance_and_what_is_uncertain(self):
        found = sum_pulses(self.solved(2, (-0.6, -0.5), (0.12**2, 0.9)), [0, 1], WEAK)
        first, second = 1.0 / (0.12**2 + MODEL_ERROR**2), 1.0 / (0.9 + MODEL_ERROR**2)
        squares = 0.4**2 * first + 0.5**2 * second
        assert astuple(found) == pytest.approx((2, first + second, 0.4 * first + 0.5 * second, squares))

    def test_many_that_show_little_agree_with_the_coil_and_not_with_what_was_assumed(self):
        rng = np.random.default_rng(11)
        variance, weak = 9.0, 0.3
        errors = weak - 1.0 + sqrt(variance) * rng.standard_normal(4000)
        summed = NO_PULSES
        for error in errors:
            summed = summed.add(sum_pulses(self.solved(1, (error,), (variance,)), [0], WEAK))
        mean, sigma = summed.weighted / summed.weight, 1.0 / sqrt(summed.weight)
        assert sigma == pytest.approx(sqrt(variance / 4000), rel=0.01)
        assert abs(mean - weak) < 4.0 * sigma

    def test_one_that_was_not_measured_shows_nothing(self):
        assert sum_pulses(solution((0, 0), (-0.9, -0.01), (1.0, 0.9999)), [0, 1], WEAK) == NO_PULSES

    def test_the_oldest_gives_its_place_once_so_many_are_traced(self):
        traced = solution(*self.UNSURE)
        part = 1.0 - 0.7 / (1.0 - 0.2**2)
        assert astuple(oldest_pulse(traced, 1, WEAK)) == pytest.approx((1, *self.sums(part)))
        assert oldest_pulse(traced, 2, WEAK) == oldest_pulse(traced, 0, WEAK) == NO_PULSES

    def test_they_count_with_those_that_are(self):
        assert weak(*self.UNSURE) is None
        assert weak(*self.UNSURE, earlier=self.older(1, 0.25)) == (1, pytest.approx(0.25, abs=0.03))
        assert weak(*self.UNSURE, earlier=self.older(0, 0.25)) is None, "those of the coil alone"

    def test_not_where_they_did_another_part(self):
        """A coil that does a part of its effect does it at every pulse."""
        assert weak(*self.UNSURE, earlier=self.older(1, 0.95)) is None
        assert weak(*self.UNSURE, earlier=self.older(1, 0.95, 20)) is None

    @pytest.mark.parametrize(("before", "accused"), [(0.66, False), (0.1, True)])
    def test_not_where_an_open_coil_alone_is_believed_and_they_show_a_weak_one(self, before, accused):
        """On a satellite heavier than its table every pulse does less: one odd pulse opens no coil."""
        odd, weight = ((2, 1), (-0.2, -0.94), (0.07, 0.06)), 1500.0
        parts = PartSum(12, weight, weight * before, weight * (before**2 + 0.006))
        earlier = (NOTHING_OLDER, Older(parts), NOTHING_OLDER)
        assert (weak(*odd, earlier=earlier, believed=0.2) is not None) is accused
        assert weak(*odd, earlier=earlier) is not None, "where a weak coil is believed, they agree with it"

    def test_an_open_coil_is_accused_by_two_pulses_whatever_it_was_before(self):
        opened = ((1, 1, 2), (-0.95, -0.94, -0.3), (0.08, 0.06, 0.07))
        assert weak(*opened, earlier=self.older(1, 0.66, 12), believed=0.2) == (
            1,
            pytest.approx(0.05, abs=0.05),
        )

    def test_not_against_a_coil_that_has_been_sound_since(self):
        """It failed within those that are traced, or not at all."""
        since = ((1, 1, 1), (-0.9, 0.02, 0.03), (0.1, 0.1, 0.1))
        assert weak(*since, earlier=self.older(1, 0.1, 20)) is None


def test_nobody_is_accused_while_two_coils_cannot_be_told_apart():
    alike = ((0, 0, 1, 1), (-0.5, -0.5, -0.5, -0.5), (0.7, 0.7, 0.7, 0.7), -0.33)
    assert weak(*alike) is None


def test_a_coil_that_failed_within_a_pulse_is_accused_by_the_later_ones():
    """The pulse in which it failed has any part of its effect."""
    within = weak((1, 1, 1, 0), (-2.0, -1.95, -0.66, 0.0), (0.04, 0.04, 0.05, 0.05))
    assert within == (1, pytest.approx(-1.0, abs=0.05))
    assert weak((1, 1, 1, 0), (-2.0, -0.66, -0.1, 0.0), (0.04, 0.04, 0.05, 0.05)) is None, "not within two"


def test_what_all_coils_lack_alike_is_no_coil():
    """Another inertia than that of the table turns less by any coil."""
    alike = ((0, 0, 0, 1, 2), (-0.45, -0.42, -0.44, -0.4, -0.43), (0.03, 0.03, 0.03, 0.05, 0.05))
    assert weak(*alike) is None
    assert weak(alike[0], (-0.45, -0.42, -0.44, 0.02, -0.01), alike[2]) == (0, pytest.approx(0.56, abs=0.02))
    assert weak((0, 0, 0), (-0.45, -0.42, -0.44), (0.03, 0.03, 0.03)) is None, "before another has shown it"


def test_what_the_filter_knew_of_a_gain_counts_with_what_it_did_not():
    """Two thirds of what the coil lacks are in the estimated gain already, the rest is deviation."""
    deviation, covariance = np.array((-0.2, -0.25, 0.01)), np.diag((0.04, 0.05, 0.03)) ** 2
    knowing = Solution(
        (1, 1, 0), np.array((0.6, 0.6, 1.0)) + deviation, deviation, covariance, np.full(3, MODEL_ERROR)
    )
    assert weak_by_pulses(knowing, NONE_OLDER, WEAK, WEAK.weak_part) == (1, pytest.approx(0.375, abs=0.03))
    assert weak((1, 1, 0), deviation, (0.04, 0.05, 0.03)) is None


def test_pulses_whose_effect_is_uncertain_prove_little():
    pulses = ((0, 0, 0, 1), (-0.77, -0.87, -0.8, 0.02), (0.05, 0.06, 0.05, 0.04))
    assert weak(*pulses) == (0, pytest.approx(0.2, abs=0.05))
    assert weak(*pulses, 0.0, (0.4, 0.45, 0.4, 0.05)) is None
    assert weak(*pulses, 0.0, (0.4, 0.05, 0.05, 0.05)) == (0, pytest.approx(0.17, abs=0.03)), "two suffice"


def test_no_coil_does_more_the_other_way_than_a_reversed_one():
    reversed_coil = ((0, 0, 1), (-2.03, -1.98, 0.01), (0.05, 0.05, 0.05))
    assert weak(*reversed_coil) == (0, pytest.approx(-1.0, abs=0.03))
    assert weak(reversed_coil[0], (-2.6, -2.5, 0.01), reversed_coil[2]) is None
    assert weak(reversed_coil[0], (-2.6, -2.5, 0.01), (0.4, 0.4, 0.05)) == (0, -1.0), "if it may be noise"


@pytest.mark.parametrize("lack", [-0.7, -2.6], ids=["weak", "beyond a reversed one"])
def test_the_distance_is_that_of_what_is_left(lack):
    """By numpy, from the part that the coil is taken to have."""
    pulses = solution((1, 1, 0), (lack, lack + 0.1, 0.05), (0.1, 0.15, 0.05), 0.3)
    one = next(found for found in explain_pulses(pulses) if (found.coil, found.pulses) == (1, 2))
    off = np.array([*(pulses.part[:2] - one.part), pulses.deviation[2]])
    assert one.distance == pytest.approx(off @ np.linalg.solve(pulses.noise([0, 1, 2]), off))
    assert (one.part == -1.0) is (lack < -2.0)


def test_sound_pulses_are_best_explained_by_nothing_and_that_fits():
    likeliest = explain_pulses(solution((0, 1, 2), (0.02, -0.03, 0.01), (0.05, 0.06, 0.04)))[-1]
    assert (likeliest.coil, likeliest.fits) == (-1, True)
    wild = explain_pulses(solution((0, 1, 2), (0.9, -1.3, 1.4), (0.05, 0.06, 0.04)))
    assert not any(one.fits for one in wild)


def test_a_stray_current_without_effect_is_no_weak_coil():
    assert weak((STRAY, STRAY + 1, STRAY + 2), (-0.9, -0.9, -0.9), (0.03, 0.03, 0.03)) is None


def accused(estimate, config):
    return weak_by_gain(estimate, weigh_gains(estimate, config, WEAK), WEAK)


class TestGain:
    """A coil that was always weak hides in what the filter estimates of the coils."""

    def test_a_gain_that_is_exact_says_nothing(self):
        config = tuned(coil_error=Prior((0.0, 0.1, 0.1, 0.1, 0.05, 0.1, 0.1, 0.1, 0.0), (0.0,) * 9))
        estimate = mekf.start((1.0, 0.0, 0.0, 0.0), (0.0,) * 3, config)
        first, second, third = weigh_gains(estimate, config, WEAK)
        assert first == third == 0.0
        assert second < 0.0

    @pytest.fixture
    def estimated(self):
        def make(coil, gain, sigma):
            prior = {"coil_error": Prior((sigma,) * 9, (0.0,) * 9)}
            config = tuned(**prior)
            errors = [0.01] * 9
            errors[4 * coil] = gain
            estimate = mekf.start((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), config)
            parameters = replace(estimate.parameters, coil_error=tuple(errors))
            return replace(estimate, parameters=parameters), config

        return make

    @pytest.mark.parametrize("coil", [0, 1, 2])
    def test_it_is_accused_once_its_gain_is_certain(self, estimated, coil):
        assert accused(*estimated(coil, -0.5, 0.03)) == (coil, 0.5)
        assert accused(*estimated(coil, -0.5, 0.06)) is None
        assert accused(*estimated(coil, -0.25, 0.001)) is None

    def test_without_such_a_parameter_there_is_no_evidence(self, estimated):
        estimate, _ = estimated(1, -0.9, 0.03)
        assert accused(estimate, tuned()) is None


@pytest.mark.parametrize("numbers", range(1, 10))
def test_what_noise_may_leave_is_the_quantile_of_chi_square(numbers):
    exact = chi2.isf(norm.sf(SIGMAS), numbers)
    assert exact <= most_by_chance(numbers) < 1.1 * exact
