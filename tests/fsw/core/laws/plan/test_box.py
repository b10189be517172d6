"""Quadratic programmes in a box, beside scipy's bounded least squares."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from fsw.core.laws.plan.box import _lower, box_minimum


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("most", [0.05, 0.5, 1e3])
def test_the_minimum_is_that_of_bounded_least_squares(seed, most):
    rng = np.random.default_rng(seed)
    rows, wanted = rng.standard_normal((20, 15)) * np.geomspace(1.0, 0.03, 15), rng.standard_normal(20)
    expected = lsq_linear(rows, wanted, (-most, most), method="bvls", tol=1e-14).x
    found = box_minimum(rows.T @ rows, -rows.T @ wanted, most)
    assert found == pytest.approx(expected, abs=1e-6 * most)


def test_without_a_limit_in_reach_it_is_newtons_step():
    h = np.array([[2.0, 0.3], [0.3, 1.0]])
    assert box_minimum(h, np.array([-1.0, 0.5]), 9.0) == pytest.approx(np.linalg.solve(h, [1.0, -0.5]))


def test_cutting_the_free_minimum_is_not_the_minimum():
    """Two components that do the same together: what one cannot give the other gives."""
    h, g = np.array([[1.0, 0.9], [0.9, 1.0]]), np.array([-2.0, -1.0])
    assert np.clip(np.linalg.solve(h, -g), -1.0, 1.0).tolist() == [1.0, -1.0]
    assert box_minimum(h, g, 1.0) == pytest.approx([1.0, 0.1])


def test_a_step_that_goes_too_far_is_halved_until_the_cost_falls():
    """m^2 / 2 - m from zero along 5: 5, 2.5 and their halves until 1.25 costs less."""
    h, slope, still = np.eye(1), np.array([-1.0]), np.zeros(1)
    assert _lower(h, slope, still, np.array([5.0]), 9.0) == pytest.approx([1.25])
    assert _lower(h, slope, still, np.array([-5.0]), 9.0) is None


def test_at_rest_it_stays():
    assert box_minimum(np.eye(3), np.zeros(3), 1.0).tolist() == [0.0, 0.0, 0.0]
