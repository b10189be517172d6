"""The Riccati equation by an invariant subspace, beside the doubling that flies."""

from math import radians

import numpy as np
import pytest

from fsw.core.laws.lqr import LqrGains, orbit_problem
from fsw.core.laws.plan.riccati import NotHeldError, periodic
from sim.design.riccati_by_subspace import periodic_cost

INERTIA = ((1.02, 0.02, 0.01), (0.02, 1.85, -0.03), (0.01, -0.03, 1.95))
W0, B0 = 1.038e-3, 2.112e-5


@pytest.mark.parametrize("wheel", [(0.0, 0.0, 0.0), (0.001, -0.002, 0.05)])
@pytest.mark.parametrize("effort", [0.1, 10.0])
def test_both_ways_lead_to_the_same_cost(wheel, effort):
    case = orbit_problem(INERTIA, wheel, W0, radians(98.6), B0, LqrGains(rate=0.3, effort=effort))
    expected = periodic(*case)[1][0, :, :6]
    found = periodic_cost(*case)
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert found / scale == pytest.approx(expected / scale, abs=1e-6)


def test_a_body_that_no_dipole_holds_is_refused():
    """Over the equator with a steady field, top-heavy."""
    case = orbit_problem(
        ((1.95, 0.0, 0.0), (0.0, 1.85, 0.0), (0.0, 0.0, 1.02)), (0.0, 0.0, 0.0), W0, 0.0, B0, LqrGains()
    )
    with pytest.raises(NotHeldError, match="this body"):
        periodic_cost(*case)
