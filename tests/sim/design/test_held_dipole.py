"""The sampled loop: with many holds an orbit that of the continuous law, with few unstable."""

import numpy as np
import pytest

from sim.design.held_dipole import LEAST_HOLDS, held_degree, longest_hold_s, weaker
from sim.design.theory.bodies import BODIES
from sim.design.theory.floquet import degree_of_stability, monodromy
from sim.design.theory.linear import Gains, closed_loop

FIFTY, GAINS = BODIES[2], Gains(4e6, 1000.0)


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
