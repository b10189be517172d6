"""Torques as functions at once and twice the orbital rate: what is put in comes out, what is not is left."""

import numpy as np
import pytest

from fsw.core.laws.mpc_simple_field import harmonics
from sim.design.torque_harmonics import fit, orbit

WANTED = np.array([[1, -2, 3], [4, 5, -6], [-7, 8, 9], [0.5, -1.5, 2.5], [3.5, 4.5, -5.5]]) * 1e-7


def test_the_coefficients_come_back_from_points_anywhere():
    u = np.sort(np.random.default_rng(5).uniform(0.0, 2.0 * np.pi, 40))
    found = fit(u, harmonics(u) @ WANTED)
    np.testing.assert_allclose(found.coefficients_nm, WANTED, rtol=1e-9)
    assert found.left < 1e-12


def test_the_functions_are_in_their_order():
    u = np.array([0.3])
    expected = [1.0, np.cos(0.3), np.sin(0.3), np.cos(0.6), np.sin(0.6)]
    np.testing.assert_allclose(harmonics(u)[0], expected)


@pytest.mark.parametrize(("count", "left"), [(1, np.sqrt(0.8)), (3, np.sqrt(0.4)), (5, 0.0)])
def test_fewer_functions_leave_what_they_have_not(count, left):
    """Of a constant and both rates with equal weight: each sine and cosine has half a mean square."""
    u = orbit()
    torque = harmonics(u) @ np.array([[1.0], [np.sqrt(2)], [np.sqrt(2)], [np.sqrt(2)], [np.sqrt(2)]])
    assert fit(u, torque, count).left == pytest.approx(left, abs=1e-12)


def test_a_third_harmonic_is_left():
    u = orbit()
    assert fit(u, np.cos(3.0 * u)[:, None]).left == pytest.approx(1.0)


def test_an_orbit_begins_at_the_node_and_goes_on_ahead():
    assert orbit(4) == pytest.approx([0.0, np.pi / 2.0, np.pi, 3.0 * np.pi / 2.0])
