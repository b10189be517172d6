"""The largest attitude gain: stable below, not above, and what leaves the unit circle."""

import numpy as np
import pytest

from sim.design.gain_bifurcation import Leaving, bifurcation
from sim.design.theory.bodies import BODIES
from sim.design.theory.floquet import degree_of_stability, monodromy, multipliers
from sim.design.theory.linear import Gains, closed_loop

FIFTY, BEST = BODIES[2], Gains(6.2694e6, 1614.9)


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
