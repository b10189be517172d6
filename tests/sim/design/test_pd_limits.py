"""The largest attitude gain: stable below, not above, and what leaves the unit circle."""

import numpy as np
import pytest

from sim.design.pd_limits import LEAST_HOLDS, Leaving, bifurcation, held_degree, longest_hold_s, weaker
from sim.design.theory.bodies import BODIES
from sim.design.theory.floquet import degree_of_stability, monodromy, multipliers
from sim.design.theory.linear import Gains, closed_loop

FIFTY = BODIES[2]
BEST = Gains(6.2694e6, 1614.9)


@pytest.mark.long
def test_below_it_the_loop_is_stable_and_above_it_not():
    found = bifurcation(FIFTY, BEST)
    degrees = [
        float(degree_of_stability(monodromy(closed_loop(FIFTY, Gains(BEST.k_w, part * found.k_a)))))
        for part in (0.999, 1.001)
    ]
    assert degrees[0] < 0.0 < degrees[1]


@pytest.mark.long
def test_the_multiplier_that_leaves_is_the_one_named():
    found = bifurcation(FIFTY, BEST)
    first = multipliers(monodromy(closed_loop(FIFTY, Gains(BEST.k_w, found.k_a))))[0]
    assert found.leaving is Leaving.FOLD
    assert first == pytest.approx(1.0, abs=1e-6)


def test_damping_alone_has_no_limit():
    """A hundred times the rate's gain, with the same k_a, is still stable."""
    stiff = Gains(100.0 * BEST.k_w, BEST.k_a)
    assert float(degree_of_stability(monodromy(closed_loop(FIFTY, stiff)))) < 0.0


@pytest.mark.parametrize("factor", [0.0, 10.0])
def test_gains_that_are_not_stable_or_only_just_are_refused(factor):
    """Without gains the gravity torque alone holds the body, which then swings for ever."""
    k_w = BEST.k_w if factor else 0.0
    with pytest.raises(ValueError, match="stable"):
        bifurcation(FIFTY, Gains(k_w, factor * np.asarray(BEST.k_a)))


# --- The sampled loop: with many holds an orbit that of the continuous law, with few unstable

GAINS = Gains(4e6, 1000.0)


def test_with_ever_shorter_holds_it_comes_to_the_continuous_loop():
    exact = float(degree_of_stability(monodromy(closed_loop(FIFTY, GAINS))))
    missing = [abs(held_degree(FIFTY, GAINS, holds) - exact) for holds in (200, 400, 800)]
    assert missing[1] == pytest.approx(0.5 * missing[0], rel=0.2)
    assert missing[2] == pytest.approx(0.5 * missing[1], rel=0.2)


@pytest.mark.long
def test_weaker_gains_withstand_a_longer_hold():
    """The claim of the source."""
    best = Gains(6.2694e6, 1614.9)
    longest = [longest_hold_s(FIFTY, weaker(best, e)) for e in (1.0, 0.3)]
    assert longest[0] == pytest.approx(465.6, abs=0.1)
    assert longest[1] > 1.8 * longest[0]


@pytest.mark.long
def test_very_weak_gains_withstand_the_longest_hold_that_is_tried():
    weak = weaker(Gains(6.2694e6, 1614.9), 0.02)
    assert longest_hold_s(FIFTY, weak) == pytest.approx(2.0 * np.pi / FIFTY.rate_radps / LEAST_HOLDS)


def test_a_body_without_gains_comes_to_rest_with_no_hold():
    assert longest_hold_s(FIFTY, Gains(0.0, 0.0)) == 0.0


def test_no_hold_saves_gains_that_drive_away():
    assert longest_hold_s(FIFTY, Gains(6.2694e6, 3.0 * 1614.9)) == 0.0


def test_what_is_weaker_is_so_by_e_and_its_square():
    assert weaker(Gains(10.0, 8.0), 0.5) == Gains(5.0, 2.0)
    assert np.isfinite(held_degree(FIFTY, GAINS, 7))
