"""PD gains by their worst torque: better than the start, than their neighbours, worse than the free law."""

from math import radians

import numpy as np
import pytest

from fsw.core.laws.lqr import LqrGains, orbit_problem
from sim.design.h_infinity_gains import best_pd, pd_tabulated
from sim.design.periodic_norms import norms

INERTIA = ((1.02, 0.0, 0.0), (0.0, 1.85, 0.0), (0.0, 0.0, 1.95))
W0, B0 = 1.038e-3, 2.112e-5
UNIT_NM = W0**2 * float(np.trace(INERTIA)) / 3.0
START = (6.2694e6, 1614.9)


@pytest.fixture(scope="module")
def case():
    return orbit_problem(INERTIA, (0.0, 0.0, 0.0), W0, radians(98.6), B0, LqrGains())


def test_the_table_is_the_pd_law():
    """For a small angle, at one field."""
    b, omega, theta = (
        np.array([2e-5, -1e-5, 3e-5]),
        np.array([1e-4, 2e-4, -3e-4]),
        np.array([1e-3, -2e-3, 3e-3]),
    )
    gain = pd_tabulated(b[None], 5e6, 1500.0)[0]
    expected = -np.cross(b, 5e6 * omega + 1500.0 * 2.0 * theta)
    assert gain @ np.concatenate([omega, theta]) == pytest.approx(expected)


@pytest.mark.long
def test_the_gains_found_bear_the_worst_torque_better(case):
    found = best_pd(*case, UNIT_NM, START)
    before = norms(*case, pd_tabulated(case[1], *START), UNIT_NM).h_infinity
    assert found.norms.h_infinity < 0.9 * before
    for factor in (0.6, 1.7):
        for k_w, k_a in ((factor * found.k_w, found.k_a), (found.k_w, factor * found.k_a)):
            near = norms(*case, pd_tabulated(case[1], k_w, k_a), UNIT_NM).h_infinity
            assert near > 0.999 * found.norms.h_infinity
