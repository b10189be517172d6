"""Which coil a solution isolates: by how much, how surely, and never one of two that look alike."""

import numpy as np
import pytest

from fsw.core.estimation import mekf
from fsw.core.estimation.mekf_config import mekf_config
from fsw.core.estimation.parameters import Prior
from fsw.core.fdir.explanations import (
    STRAY,
    Solution,
    against,
    conducting,
    of_oldest,
    of_pulses,
    weak_by_gain,
    weak_by_pulses,
)

WEAK_PART, THRESHOLD = 0.7, 14.0


def solution(causes, deviation, sigma, correlation=0.0):
    sigma = np.array(sigma)
    shape = np.eye(len(sigma)) + correlation * (1.0 - np.eye(len(sigma)))
    return Solution(tuple(causes), np.array(deviation), shape * np.outer(sigma, sigma))


def weak(*arguments, earlier=(0.0, 0.0, 0.0)):
    return weak_by_pulses(solution(*arguments), earlier, WEAK_PART, THRESHOLD)


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


def test_a_coil_that_failed_between_two_pulses_is_accused_by_the_later_ones():
    accused = weak((1, 1, 1, 0), (-1.0, -0.98, 0.03, 0.0), (0.04, 0.04, 0.05, 0.05))
    assert accused == (1, pytest.approx(0.0, abs=0.02))


class TestPulsesTracedNoLonger:
    """Pulses that show little by themselves add up, beyond those that are traced."""

    UNSURE = ((1, 2, 1, 1), (-0.8, 0.02, -0.75, -0.7), (0.2, 0.05, 0.2, 0.2))

    def test_what_each_weighs_is_negative_for_a_sound_one_and_bounded(self):
        found = solution((2, 0, 1), (-0.7, 0.1, -1.0), (0.12, 0.12, 0.01))
        assert against(found, WEAK_PART, THRESHOLD) == [
            pytest.approx(0.5 * 0.4**2 / (0.12**2 + 0.05**2)),
            pytest.approx(-0.5 * 0.4**2 / (0.12**2 + 0.05**2)),
            0.5 * THRESHOLD,
        ]
        surely_sound = solution((1,), (0.3,), (0.01,))
        assert against(surely_sound, WEAK_PART, THRESHOLD) == [-0.5 * THRESHOLD]

    def test_the_oldest_gives_its_place_once_so_many_are_traced(self):
        traced = solution(*self.UNSURE)
        assert of_oldest(traced, 1, WEAK_PART, THRESHOLD) == pytest.approx(0.5 * 0.4**2 / (0.2**2 + 0.05**2))
        assert of_oldest(traced, 2, WEAK_PART, THRESHOLD) == 0.0
        assert of_oldest(traced, 0, WEAK_PART, THRESHOLD) == 0.0

    def test_they_count_with_those_that_are(self):
        assert weak(*self.UNSURE) is None
        assert weak(*self.UNSURE, earlier=(0.0, 7.0, 0.0)) == (1, pytest.approx(0.25, abs=0.03))
        assert weak(*self.UNSURE, earlier=(7.0, 0.0, 7.0)) is None, "those of the coil alone"

    def test_not_against_a_coil_that_has_been_sound_since(self):
        """It failed within those that are traced, or not at all."""
        since = ((1, 1, 1), (-0.9, 0.02, 0.03), (0.1, 0.1, 0.1))
        assert weak(*since, earlier=(0.0, THRESHOLD, 0.0)) is None


def test_nobody_is_accused_while_two_coils_cannot_be_told_apart():
    alike = ((0, 0, 1, 1), (-0.5, -0.5, -0.5, -0.5), (0.7, 0.7, 0.7, 0.7), -0.33)
    assert weak(*alike) is None


def test_sound_pulses_are_best_explained_by_nothing_and_that_fits():
    likeliest = of_pulses(solution((0, 1, 2), (0.02, -0.03, 0.01), (0.05, 0.06, 0.04)))[-1]
    assert (likeliest.coil, likeliest.fits) == (-1, True)
    wild = of_pulses(solution((0, 1, 2), (0.9, -1.3, 1.4), (0.05, 0.06, 0.04)))
    assert not any(one.fits for one in wild)


def test_a_stray_current_without_effect_is_no_weak_coil():
    assert weak((STRAY, STRAY + 1, STRAY + 2), (-0.9, -0.9, -0.9), (0.03, 0.03, 0.03)) is None


class TestGain:
    """A coil that was always weak hides in what the filter estimates of the coils."""

    @pytest.fixture
    def estimated(self):
        sigmas = {"magnetometer_sigma_t": 2e-7, "sun_sigma_rad": 0.01}
        start = {"attitude_sigma_rad": 0.1, "rate_sigma_radps": 0.01, "torque_noise_nm_rts": 1e-9}
        inertia = ((1.0, 0.0, 0.0), (0.0, 1.5, 0.0), (0.0, 0.0, 2.0))

        def make(coil, gain, sigma):
            prior = {"coil_error": Prior((sigma,) * 9, (0.0,) * 9)}
            config = mekf_config(inertia, 1.0, prior, **sigmas, **start, gate_nis=16.0)
            errors = [0.01] * 9
            errors[4 * coil] = gain
            estimate = mekf.start((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), config)
            parameters = estimate.parameters._replace(coil_error=tuple(errors))
            return estimate._replace(parameters=parameters), config

        return make

    @pytest.mark.parametrize("coil", [0, 1, 2])
    def test_it_is_accused_once_its_gain_is_certain(self, estimated, coil):
        assert weak_by_gain(*estimated(coil, -0.5, 0.03), WEAK_PART, THRESHOLD) == (coil, 0.5)
        assert weak_by_gain(*estimated(coil, -0.5, 0.05), WEAK_PART, THRESHOLD) is None
        assert weak_by_gain(*estimated(coil, -0.25, 0.001), WEAK_PART, THRESHOLD) is None

    def test_without_such_a_parameter_there_is_no_evidence(self, estimated):
        estimate, config = estimated(1, -0.9, 0.03)
        plain = mekf_config(
            config.rotor.inertia_kgm2,
            1.0,
            {},
            magnetometer_sigma_t=2e-7,
            sun_sigma_rad=0.01,
            attitude_sigma_rad=0.1,
            rate_sigma_radps=0.01,
            torque_noise_nm_rts=1e-9,
            gate_nis=16.0,
        )
        assert weak_by_gain(estimate, plain, WEAK_PART, THRESHOLD) is None


def stray(deviation, sigma, correlation=0.0):
    return conducting(solution((STRAY, STRAY + 1, STRAY + 2), deviation, sigma, correlation))


@pytest.mark.parametrize("coil", [0, 1, 2])
def test_the_coil_whose_effect_is_there_conducts(coil):
    assert stray(np.eye(3)[coil] + 0.03, (0.05, 0.06, 0.07)) == coil


@pytest.mark.parametrize(
    ("deviation", "sigma", "correlation"),
    [
        ((0.0, 0.0, 0.0), (0.05, 0.06, 0.07), 0.0),
        ((0.5, 0.5, 0.0), (0.05, 0.06, 0.07), 0.0),
        ((0.0, -1.0, 0.0), (0.05, 0.06, 0.07), 0.0),
        ((0.02, 0.8, 0.0), (1.0, 0.3, 1.0), 0.0),
        ((0.5, 0.5, 0.01), (0.7, 0.7, 0.05), -0.99),
    ],
    ids=["none", "two", "the other way", "unsure", "one of two"],
)
def test_it_names_nobody(deviation, sigma, correlation):
    sure = stray((0.0, 1.0, 0.0), (0.05, 0.06, 0.07))
    assert sure == 1
    assert stray(deviation, sigma, correlation) is None


def test_one_is_named_though_its_own_effect_cannot_be_seen_if_it_is_no_other():
    """Along the field a coil turns nothing; its deviation stays at the prior, those of the others are 0."""
    assert stray((0.0, 1.0, 0.01), (0.04, 0.04, 1.0)) == 1
    assert stray((0.0, 0.0, 0.0), (0.04, 0.04, 1.0)) is None, "nor is it told from no current at all"


def test_pulses_before_it_do_not_name_a_coil():
    assert conducting(solution((0, 1), (1.0, 0.0), (0.03, 0.03))) is None
