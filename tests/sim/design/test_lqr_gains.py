"""PD gains drawn from the regulator: nearest to it over the orbit, and stable."""

import numpy as np
import pytest

from sim.design.lqr_gains import lqr_gains
from sim.design.theory.bodies import BODIES
from sim.design.theory.floquet import degree_of_stability, monodromy
from sim.design.theory.linear import closed_loop, dipole_field, skew
from sim.design.theory.periodic_lqr import Weights, design

FIFTY = BODIES[2]


def test_no_other_gains_are_nearer():
    """Beside the least-squares solution of m = -b x (k_w Omega + 2 k_a theta), element by element."""
    law, found = design(FIFTY, Weights(effort=0.1)), lqr_gains(FIFTY, 0.1)
    cross = (FIFTY.field_t * skew(dipole_field(law.u_rad, FIFTY))).reshape(-1, 1)
    for part, gain in ((0, found.k_w), (3, 2.0 * found.k_a)):
        wanted = law.gain[..., part : part + 3].reshape(-1)
        assert np.linalg.lstsq(-cross, wanted, rcond=None)[0][0] == pytest.approx(gain, rel=1e-9)


@pytest.mark.parametrize("effort", [0.1, 1.0])
def test_they_stabilise_the_satellite(effort):
    degree = degree_of_stability(monodromy(closed_loop(FIFTY, lqr_gains(FIFTY, effort))))
    assert float(degree) < -0.15


def test_the_less_effort_counts_the_stronger_they_are():
    strong, weak = lqr_gains(FIFTY, 0.1), lqr_gains(FIFTY, 1.0)
    assert strong.k_w > weak.k_w
    assert strong.k_a > weak.k_a
