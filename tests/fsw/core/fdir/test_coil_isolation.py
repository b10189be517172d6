"""Which coil a solution isolates: by how much, how surely, and never one of two that look alike."""

import numpy as np
import pytest

from fsw.core.fdir.coil_isolation import WeakCoil, conducting, too_little
from fsw.core.fdir.coil_rate import STRAY, Solution

WEAK_PART, SIGMAS = 0.7, 4.0


def solution(causes, deviation, sigma, correlation=0.0):
    sigma = np.array(sigma)
    shape = np.eye(len(sigma)) + correlation * (1.0 - np.eye(len(sigma)))
    return Solution(tuple(causes), np.array(deviation), shape * np.outer(sigma, sigma))


def weak(*arguments):
    return too_little(solution(*arguments), WEAK_PART, SIGMAS)


def test_a_pulse_that_certainly_did_too_little_accuses_its_coil():
    assert weak((2, 0), (0.01, -0.9), (0.04, 0.03)) == WeakCoil(0, pytest.approx(0.1))


@pytest.mark.parametrize(
    ("deviation", "sigma"), [(-0.9, 0.2), (-0.35, 0.03), (0.9, 0.03)], ids=["unsure", "hardly weak", "strong"]
)
def test_it_accuses_nobody(deviation, sigma):
    assert weak((2, 0), (0.01, deviation), (0.04, sigma)) is None


def test_pulses_none_of_which_is_sure_do_so_together():
    assert weak((1, 1, 1), (-0.8, -0.9, -1.0), (0.22, 0.22, 0.22)) == WeakCoil(
        1, pytest.approx(0.1, abs=0.01)
    )
    assert weak((1, 0, 2), (-0.8, -0.9, -1.0), (0.22, 0.22, 0.22)) is None


def test_a_stray_current_without_effect_is_no_weak_coil():
    assert weak((STRAY, STRAY + 1, STRAY + 2), (-0.9, -0.9, -0.9), (0.03, 0.03, 0.03)) is None


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
