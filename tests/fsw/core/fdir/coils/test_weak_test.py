"""Is a coil weak or sound: by a part of its effect, and by the part on which its pulses agree."""

from math import hypot

import pytest
from estimator_samples import tuned

from fsw.core.estimation.parameters import Prior
from fsw.core.fdir.coils.weak_test import (
    MOST,
    NO_PULSES,
    NOTHING_OLDER,
    Older,
    WeakTest,
    weak_test,
    weigh_pulse,
)

WEAK = WeakTest(0.7, 0.8, 14.0)


def pulses(*parts, sigma=0.1):
    found = NO_PULSES
    for part in parts:
        found = found.add(weigh_pulse(part, sigma**2, WEAK))
    return found


class TestWeakTest:
    """Weak is at most 0.7 of the effect, sound at least 0.8."""

    @pytest.mark.parametrize(
        ("part", "nats"),
        [(0.3, 12.5), (0.7, 0.5), (0.75, 0.0), (0.8, -0.5), (1.1, -8.0), (-1.0, 162.0)],
    )
    def test_a_part_weighs_the_likeliest_weak_one_against_the_likeliest_sound_one(self, part, nats):
        assert WEAK.nats(part, 0.1**2) == pytest.approx(nats)
        assert WEAK.nats(part, 0.2**2) == pytest.approx(0.25 * nats)

    def test_sound_is_what_is_credible_of_a_gain_and_never_less_than_weak(self):
        def least(*sigmas):
            prior = {"coil_error": Prior(sigmas, (0.0,) * 9)} if sigmas else {}
            return weak_test(0.7, 14.0, tuned(**prior)).sound_part

        assert least() == pytest.approx(0.8)
        widest = 1.0 - 4.0 * hypot(0.03, 0.05)
        assert least(0.01, 0.5, 0.5, 0.5, 0.03, 0.5, 0.5, 0.5, 0.02) == pytest.approx(widest)
        assert least(*(0.2,) * 9) == 0.7


class TestPulses:
    """They count by the part on which they agree."""

    def test_none_say_nothing(self):
        assert NO_PULSES.nats(WEAK) == NOTHING_OLDER.nats(WEAK) == 0.0

    @pytest.mark.parametrize("part", [0.3, 0.6, 0.9])
    def test_those_that_agree_weigh_the_sum_of_what_each_does(self, part):
        each = pulses(part, sigma=0.3).nats(WEAK)
        assert pulses(part, part, part, sigma=0.3).nats(WEAK) == pytest.approx(3.0 * each)

    def test_those_that_contradict_each_other_weigh_less(self):
        """Half of them sound and half without effect: no coil does that, though their mean is weak."""
        assert pulses(0.1, 1.0, 0.1, 1.0, sigma=0.2).nats(WEAK) == 0.0
        agreed = pulses(0.3, 0.3, 0.3, sigma=0.2).nats(WEAK)
        assert 0.0 < pulses(-0.1, 0.7, 0.3, sigma=0.2).nats(WEAK) < 0.9 * agreed
        assert pulses(0.2, 0.4, 0.3, sigma=0.2).nats(WEAK) == pytest.approx(agreed)

    def test_a_certain_one_counts_more_than_an_uncertain_one(self):
        assert pulses(0.95, sigma=0.05).add(pulses(0.1, sigma=0.3)).nats(WEAK) < 0.0

    @pytest.mark.parametrize("part", [-1.3, 0.0, 0.5, 1.1])
    def test_one_by_itself_isolates_no_coil_and_two_that_agree_do(self, part):
        alone = pulses(part, sigma=0.001)
        assert abs(alone.nats(WEAK)) == pytest.approx(MOST * WEAK.threshold)
        assert abs(alone.add(alone).nats(WEAK)) > WEAK.threshold
        about = pulses(part - 0.05, part + 0.05, sigma=0.03).nats(WEAK)
        assert about > WEAK.threshold or part == 1.1


class TestOlderOnes:
    """What is left of pulses that are traced no longer."""

    def test_they_are_forgotten_once_the_coil_seems_sound(self):
        assert Older(pulses(0.9, 0.7)).bound(WEAK) is NOTHING_OLDER
        assert Older(pulses(1.0), kept=1.0).bound(WEAK) is NOTHING_OLDER
        assert Older(pulses(0.1, 1.0, 0.1, 1.0, sigma=0.2)).bound(WEAK) is NOTHING_OLDER
        assert Older(pulses(0.5)).bound(WEAK) == Older(pulses(0.5))

    def test_they_weigh_no_more_than_the_threshold_so_that_good_ones_count(self):
        many = Older(pulses(*[0.3] * 50)).bound(WEAK)
        assert many.nats(WEAK) == pytest.approx(WEAK.threshold)
        assert many.parts.weighted / many.parts.weight == pytest.approx(0.3)
        assert many.add(pulses(1.0)).bound(WEAK) is NOTHING_OLDER

    def test_a_coil_that_is_tried_again_is_isolated_by_one_that_shows_nothing_else(self):
        tried = Older(kept=0.5 * WEAK.threshold)
        assert tried.add(pulses(0.0)).nats(WEAK) > WEAK.threshold
        assert tried.add(pulses(1.0, 1.0)).bound(WEAK) is NOTHING_OLDER
