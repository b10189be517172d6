"""What changes in orbit widens the estimate where the table says that it may, and nowhere else."""

from math import cos, pi, sin

import numpy as np
import pytest
from changed import changed
from estimator_samples import MEKF, Q_BODY_FROM_ECI, REFERENCE

from fsw.core.algebra.vector import ZERO, add, cross, scale, unit
from fsw.core.estimation import mekf
from fsw.core.estimation.changes import EDGE_M, EDGE_S, NO_CHANGES, Changes, widen
from fsw.core.orbit.earth import RADIUS_M

EDGE_RATE = np.array([[4.0, 1.0, 0.0], [1.0, 3.0, 0.5], [0.0, 0.5, 2.0]]) * 1e-12
CHANGES = Changes(7e-19, 4e-16, 9e-6, 1e-14, 3e-6, EDGE_RATE)
SUN = unit((0.3, -0.8, -0.5))
ACROSS = unit((0.8, 0.3, 0.0))
"""Normal to the Sun."""
LEVEL, STEEP = 0.0, 1.0
RADIUS = RADIUS_M + 800e3


def at(above_edge_m, dip_sine=LEVEL):
    """Behind the Earth, so far above the edge of its shadow; in a field of this dip."""
    height_m = RADIUS_M + above_edge_m
    r_eci_m = add(scale(height_m, ACROSS), scale(-((RADIUS**2 - height_m**2) ** 0.5), SUN))
    up = unit(r_eci_m)
    level = unit(cross(up, SUN))
    b = add(scale(3e-5 * dip_sine, up), scale(3e-5 * (1.0 - dip_sine**2) ** 0.5, level))
    return REFERENCE.replace(r_eci_m=r_eci_m, radius_m=RADIUS, sun_eci=SUN, b_eci_t=b)


def grown(reference, m_body_am2=ZERO, changes=CHANGES):
    """What is added to the covariance."""
    estimate = mekf.start(Q_BODY_FROM_ECI, (0.01, -0.02, 0.03), MEKF)
    after = changed(estimate, widen, reference, m_body_am2, MEKF, changes)
    assert after.q_body_from_eci == estimate.q_body_from_eci
    assert after.parameters == estimate.parameters
    return after.covariance - estimate.covariance


def expected(**blocks):
    matrix = np.zeros((MEKF.layout.size,) * 2)
    for name, block in blocks.items():
        place = slice(3, 6) if name == "rate" else getattr(MEKF.layout, name)
        matrix[place, place] = block
    return matrix


@pytest.mark.parametrize("above_m", [-0.9 * EDGE_M, 0.0, 0.9 * EDGE_M])
def test_at_the_shadows_edge_bias_dipole_and_rate_may_step(above_m):
    matrix = expected(mag_bias=4e-16 * np.eye(3), dipole=9e-6 * np.eye(3), rate=EDGE_RATE)
    np.testing.assert_allclose(grown(at(above_m)), matrix, rtol=1e-6, atol=1e-25)


@pytest.mark.parametrize("above_m", [-1.1 * EDGE_M, -2e6, 1.1 * EDGE_M, 7e5])
def test_elsewhere_nothing_does(above_m):
    assert not grown(at(above_m)).any()


def test_crossing_the_edge_lets_the_bias_step_by_its_whole_bound():
    """In an orbit whose plane holds the Sun: the variances of all ticks sum to that of the bound, or more."""
    rate_radps = 2.0 * pi / 6052.0
    steps = 0
    for tick in range(3026):
        angle = rate_radps * tick
        r = add(scale(RADIUS * sin(angle), ACROSS), scale(RADIUS * cos(angle), SUN))
        steps += bool(grown(REFERENCE.replace(r_eci_m=r, sun_eci=SUN, b_eci_t=(0.0, 0.0, 3e-5))).any())
    assert 1.0 <= steps / EDGE_S < 2.0


@pytest.mark.parametrize(
    ("latitude_deg", "stormy"), [(0.0, False), (44.0, False), (46.0, True), (90.0, True)]
)
def test_storms_disturb_the_field_at_high_geomagnetic_latitude(latitude_deg, stormy):
    """tan(dip) = 2 tan(latitude)."""
    dip_sine = np.sin(np.arctan(2.0 * np.tan(np.radians(latitude_deg))))
    for sign in (1.0, -1.0):
        matrix = expected(mag_bias=1e-14 * np.eye(3)) if stormy else expected()
        np.testing.assert_allclose(grown(at(-2e6, sign * dip_sine)), matrix, rtol=1e-6, atol=1e-25)


def test_a_coil_that_is_driven_keeps_a_part_along_its_own_axis():
    found = grown(at(-2e6), (2.0, -8.0, 0.5))
    matrix = expected(dipole=3e-6 * np.diag([4.0, 64.0, 0.25]))
    np.testing.assert_allclose(found, matrix, rtol=1e-6, atol=1e-25)


def test_once_eased_all_of_it_is_twice_as_large_and_the_bias_walks_by_twice_its_bound():
    """A variance of four times: the filter's own walk is one of them."""
    eased = 4.0
    estimate = mekf.start(Q_BODY_FROM_ECI, (0.01, -0.02, 0.03), MEKF)
    for place, bias in ((at(0.0), 4.0 * 4e-16 + 3.0 * 7e-19), (at(-2e6), 3.0 * 7e-19)):
        after = changed(estimate, widen, place, ZERO, MEKF, CHANGES, eased)
        added = after.covariance - estimate.covariance
        edge = 4.0 if bias > 1e-17 else 0.0
        matrix = expected(mag_bias=bias * np.eye(3), dipole=edge * 9e-6 * np.eye(3), rate=edge * EDGE_RATE)
        np.testing.assert_allclose(added, matrix, rtol=1e-3, atol=1e-25)


def test_of_a_table_that_is_exact_nothing_is_widened():
    for reference in (at(0.0), at(-2e6, STEEP)):
        assert not grown(reference, (2.0, -8.0, 0.5), NO_CHANGES).any()
