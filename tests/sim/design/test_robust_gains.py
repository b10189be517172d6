"""Gains for bounds on the inertia: the corners are bodies, and weaker gains hold at all of them."""

import numpy as np
import pytest

from sim.design.held_dipole import weaker
from sim.design.inertial_gains import best_of_all
from sim.design.robust_gains import corners, robust_share, worst_degree
from sim.design.theory.bodies import BODIES

FIFTY = BODIES[2]


def test_corners_are_bodies_with_each_moment_off():
    found = [np.diag(np.asarray(corner.inertia_kgm2)) for corner in corners(FIFTY, 0.3)]
    assert len(found) == 6
    for j in found:
        assert 2.0 * j.max() <= j.sum()
        assert set(np.round(j / np.array([1.02, 1.85, 1.95]), 9)) <= {0.7, 1.3}


@pytest.mark.long
def test_gains_that_the_bounds_break_hold_when_weaker():
    """The claim of the source: with bounds on the inertia, gains can be chosen."""
    gains, _ = best_of_all(FIFTY)
    assert worst_degree(FIFTY, gains, 0.5) > 0.0
    share = robust_share(FIFTY, gains, 0.5)
    assert 0.5 < share < 1.0
    assert worst_degree(FIFTY, weaker(gains, share), 0.5) < 0.0


@pytest.mark.long
def test_wider_bounds_ask_for_weaker_gains():
    gains, _ = best_of_all(FIFTY)
    shares = [robust_share(FIFTY, gains, error) for error in (0.1, 0.3, 0.5)]
    assert shares == sorted(shares, reverse=True)
    assert shares[0] > shares[-1]
