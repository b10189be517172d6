"""Margins and maps: each against the degree of stability of the body it speaks of."""

import numpy as np
import pytest

from sim.design.theory.bodies import BODIES, Body, diagonal
from sim.design.theory.floquet import ROUGH_STEPS, degree_of_stability, monodromy
from sim.design.theory.linear import Gains, closed_loop
from sim.design.theory.robustness import (
    ERRORS,
    PAIRS,
    SCAN,
    TILTS_DEG,
    degrees,
    inertia_maps,
    margins,
    tilted,
    wrong_moments,
    wrong_spreads,
)
from sim.design.theory.search import continuous

MICROSAT, BOOM = BODIES[2], BODIES[5]
GAINS = Gains(6.0e6, 1400.0)


def degree(body, gains):
    return float(continuous(body, ROUGH_STEPS)(gains))


def test_wrong_moments_are_the_right_ones_times_one_plus_the_error(skewed):
    wrong = wrong_moments(skewed, np.array([0.1, -0.2, 0.3]))
    right = np.asarray(skewed.inertia_kgm2)
    assert np.diag(wrong) == pytest.approx(np.diag(right) * [1.1, 0.8, 1.3], rel=1e-13)
    assert wrong == pytest.approx(wrong.T, rel=1e-13)
    assert wrong[0, 1] / right[0, 1] == pytest.approx((1.1 * 0.8) ** 0.5)


def test_a_wrong_spread_changes_the_two_moments_across_it():
    a, b, c = 1.02, 1.85, 1.95
    along_first = 0.5 * (b + c - a)
    wrong = wrong_spreads(MICROSAT, np.array([0.2, 0.0, 0.0]))
    assert np.diag(wrong) == pytest.approx([a, b + 0.2 * along_first, c + 0.2 * along_first], rel=1e-12)


@pytest.mark.long
def test_every_wrong_spread_is_a_body():
    errors = np.random.default_rng(5).uniform(-0.9, 0.9, size=(200, 3))
    assert np.isfinite(degrees(BOOM, GAINS, wrong_spreads(BOOM, errors))).all()


def test_moments_that_no_body_has_are_left_out():
    found = degrees(
        BOOM, Gains(3.2e8, 4.7e4), wrong_moments(BOOM, np.array([[0.0, 0.1, 0.0], [0.0, 0.0, 0.0]]))
    )
    assert np.isnan(found[0])
    assert found[1] == pytest.approx(degree(BOOM, Gains(3.2e8, 4.7e4)))


def test_a_turn_keeps_the_moments_and_quarter_turns_swap_them():
    turned = tilted(MICROSAT, 2, np.array([90.0, 30.0]))
    assert np.diag(turned[0]) == pytest.approx([1.85, 1.02, 1.95])
    assert np.linalg.eigvalsh(turned[1]) == pytest.approx([1.02, 1.85, 1.95])
    assert turned[1][0, 1] == pytest.approx((1.02 - 1.85) * np.sqrt(3.0) / 4.0)


@pytest.fixture(scope="module")
def maps():
    return inertia_maps(MICROSAT, GAINS)


@pytest.mark.long
def test_maps_show_the_gains_on_the_body_they_speak_of(maps):
    i, j = 4, 15
    for place, (one, other) in enumerate(PAIRS):
        errors = np.zeros(3)
        errors[one], errors[other] = ERRORS[j], ERRORS[i]
        loop = closed_loop(MICROSAT, GAINS, wrong_spreads(MICROSAT, errors))
        assert maps.degree[place, i, j] == pytest.approx(
            float(degree_of_stability(monodromy(loop))), abs=1e-5
        )
    middle = len(TILTS_DEG) // 2
    assert maps.tilted[:, middle] == pytest.approx([degree(MICROSAT, GAINS)] * 3, abs=1e-9)


def test_the_maps_reach_to_half_and_half_again_and_have_the_own_body_in_the_middle(maps):
    middle = len(ERRORS) // 2
    assert (maps.errors[0], maps.errors[middle], maps.errors[-1]) == pytest.approx((-0.5, 0.0, 0.5))
    assert maps.degree[:, middle, middle] == pytest.approx([degree(MICROSAT, GAINS)] * 3, abs=1e-9)


@pytest.mark.long
def test_margins_lie_where_the_degree_rises_to_its_level_on_both_sides_of_one():
    """Of a landscape of straight slopes over the logarithms, whose margins reach to the ends of the scan."""

    def slopes(gains):
        w, a = np.log(gains.k_w / GAINS.k_w), np.log(gains.k_a / GAINS.k_a)
        return np.max([np.log(0.0102) - w, w - np.log(99.0), np.log(0.3) - a, a - np.log(5.0)], axis=0)

    found = margins(MICROSAT, GAINS, slopes)
    assert found.k_w == pytest.approx((0.0102, 99.0))
    assert found.k_a == found.both == pytest.approx((0.3, 5.0))
    assert found.half == pytest.approx((0.3**0.5, 5.0 * 0.3**0.5))


@pytest.mark.long
def test_a_body_that_only_swings_has_no_margin():
    """Without gains the gravity torque alone holds it, and nothing brings it to rest."""
    found = margins(MICROSAT, Gains(0.0, 0.0), continuous(MICROSAT, ROUGH_STEPS))
    assert found.k_w == found.k_a == found.both == found.half == (1.0, 1.0)
    assert (found.moments, found.spreads, found.tilt_deg) == (SCAN[0], SCAN[0], 0.0)


@pytest.fixture(scope="module")
def microsat_margins():
    return margins(MICROSAT, GAINS, continuous(MICROSAT, ROUGH_STEPS))


@pytest.mark.long
def test_gains_stay_stable_up_to_their_margins_and_no_further(microsat_margins):
    (_, half), (_, high), (_, both) = microsat_margins.half, microsat_margins.k_a, microsat_margins.both
    assert degree(MICROSAT, Gains(GAINS.k_w, 0.98 * high * GAINS.k_a)) < 0.0
    assert degree(MICROSAT, Gains(GAINS.k_w, 1.03 * high * GAINS.k_a)) > 0.0
    assert degree(MICROSAT, GAINS.scaled(0.98 * both)) < 0.0 < degree(MICROSAT, GAINS.scaled(1.02 * both))
    now = degree(MICROSAT, GAINS)
    assert (
        degree(MICROSAT, GAINS.scaled(0.97 * half)) < 0.5 * now < degree(MICROSAT, GAINS.scaled(1.03 * half))
    )


def test_a_margin_beyond_what_was_sought_is_none(microsat_margins):
    assert microsat_margins.k_w[1] is None
    assert degree(MICROSAT, Gains(100.0 * GAINS.k_w, GAINS.k_a)) < 0.0


def test_moments_and_axes_are_safe_below_their_margins(microsat_margins):
    found = microsat_margins
    signs = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)], dtype=float)
    assert np.nanmax(degrees(MICROSAT, GAINS, wrong_moments(MICROSAT, 0.8 * found.moments * signs))) < 0.0
    assert np.nanmax(degrees(MICROSAT, GAINS, wrong_moments(MICROSAT, found.moments * signs))) >= 0.0
    angles = np.array([-0.9, 0.9]) * found.tilt_deg
    assert max(degrees(MICROSAT, GAINS, tilted(MICROSAT, axis, angles)).max() for axis in range(3)) < 0.0


@pytest.mark.long
def test_unstable_gains_have_no_margin():
    body = Body("turned", diagonal((1.95, 1.85, 1.02)), 800.0, 98.6)
    found = margins(body, Gains(6.3e6, 8000.0), continuous(body, ROUGH_STEPS))
    assert found.k_w == found.k_a == found.both == (1.0, 1.0)
    assert found.tilt_deg == 0.0
