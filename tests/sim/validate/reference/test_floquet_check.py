"""Multipliers are compared as sets, and of a double one the mean."""

import numpy as np
import pytest

from sim.validate.reference.floquet_check import apart


def test_multipliers_are_compared_as_sets():
    theirs = np.array([3.0, 0.5 + 0.2j, 0.5 - 0.2j, 0.1, 1e-9, 1e-14])
    assert apart(theirs[::-1], theirs) == 0.0
    assert apart(theirs + np.array([0.0, 0.0, 0.0, 1e-5, 0.0, 0.0]), theirs) == pytest.approx(1e-5)
    assert apart(theirs * np.array([1.0 + 1e-5, 1, 1, 1, 1, 1]), theirs) == pytest.approx(1e-5)


def test_of_a_double_multiplier_the_mean_counts():
    """The two of a double root part by 1e-5, up and down; an error moves them together or far apart."""
    double = np.array([0.5, 0.5, 0.1, 0.05, 0.01, 0.0], dtype=complex)
    first_two = np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    parted = double + np.array([1e-5, -1e-5, 0.0, 0.0, 0.0, 0.0])
    assert apart(parted, double) < 1e-15
    assert apart(double + 1e-5 * first_two, double) == pytest.approx(1e-5)
    assert apart(double + np.array([0.02, -0.02, 0.0, 0.0, 0.0, 0.0]), double) == pytest.approx(0.02)
