"""Minimax gains: the flights of many starts at once are those of one, and the search shortens the longest."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fsw.core.algebra.quaternion import multiply
from fsw.core.laws.pd import far_error, pd_dipole
from sim.design import minimax_gains as module
from sim.design.inertial_gains import best_on_line
from sim.design.minimax_gains import minimax, settling_orbits, spread_starts
from sim.design.theory.bodies import BODIES
from sim.design.theory.linear import Gains

FIFTY = BODIES[2]
STARTS = spread_starts(6, 120.0, 2e-3)


def test_starts_are_of_one_angle_and_one_rate():
    assert 2.0 * np.degrees(np.arccos(STARTS.q[:, 0])) == pytest.approx(120.0)
    assert np.linalg.norm(STARTS.omega_radps, axis=1) == pytest.approx(2e-3)
    assert np.linalg.norm(STARTS.q, axis=1) == pytest.approx(1.0)
    assert np.linalg.matrix_rank(STARTS.q[:, 1:]) == 3


def test_the_field_in_the_body_is_turned_as_the_attitude_is():
    """At rest, k_a = 0 and k_w = 1: m = -b x omega shows b; against scipy's rotation."""
    loop = module._Loop(np.eye(3), np.eye(3), Gains(1e6, 0.0), 1e9)
    b_t, omega = np.array([2e-5, -1e-5, 3e-5]), np.array([[1e-3, 2e-3, -1e-3]] * 6)
    x = np.concatenate([STARTS.q, omega], axis=1)
    q = STARTS.q
    b = Rotation.from_quat(q[:, [1, 2, 3, 0]]).inv().apply(b_t)
    expected = np.cross(np.cross(omega, b) * 1e6, b)
    assert loop.rates(x, b_t)[:, 4:] == pytest.approx(expected, rel=1e-9)


def test_the_motion_is_that_of_the_flown_law_on_a_rigid_body():
    """J domega/dt = m x b - omega x J omega, m of the PD law and its far error, of either sign of q."""
    inertia, gains = np.array([[1.02, 0.13, -0.09], [0.13, 1.85, 0.21], [-0.09, 0.21, 1.95]]), (6e6, 1600.0)
    loop = module._Loop(inertia, np.linalg.inv(inertia), Gains(*gains), 1e9)
    q = STARTS.q * np.array([1.0, -1.0] * 3)[:, None]
    omega, b_t = 5.0 * STARTS.omega_radps, np.array([2e-5, -1e-5, 3e-5])
    found = loop.rates(np.concatenate([q, omega], axis=1), b_t)
    for row, rate, of_q in zip(found, omega, q, strict=True):
        b = Rotation.from_quat(np.roll(of_q, -1)).inv().apply(b_t)
        m = pd_dipole(tuple(b), tuple(rate), far_error(tuple(of_q)), *gains)
        torque = np.cross(m, b) - np.cross(rate, inertia @ rate)
        assert inertia @ row[4:] == pytest.approx(torque, rel=1e-9)
        assert row[:4] == pytest.approx(0.5 * np.array(multiply(tuple(of_q), (0.0, *rate))), rel=1e-9)


def test_no_coil_gives_more_than_its_dipole():
    """A torque no larger than that of three saturated coils."""
    loop = module._Loop(np.eye(3), np.eye(3), Gains(1e12, 1e9), 0.2)
    b_t = np.array([2e-5, -1e-5, 3e-5])
    rates = loop.rates(np.concatenate([STARTS.q, 0.0 * STARTS.omega_radps], axis=1), b_t)
    assert np.linalg.norm(rates[:, 4:], axis=1).max() <= 0.2 * np.sqrt(3.0) * np.linalg.norm(b_t)


@pytest.mark.long
def test_the_search_shortens_the_longest_settling():
    """The claim of the source, beside gains chosen for the end of the motion."""
    start, _ = best_on_line(FIFTY)
    before = settling_orbits(FIFTY, start, 0.2, STARTS, 1.6).max()
    found, after = minimax(FIFTY, start, 0.2, STARTS, 1.6, rounds=9)
    assert after < 0.95 * before
    assert found != start


@pytest.mark.long
def test_what_has_not_settled_costs_more_than_the_flight_and_more_with_weaker_coils():
    """By the error at the end: 0.02 and 0.2 A m^2, and none, from each start."""
    start, _ = best_on_line(FIFTY)
    weak, strong = (settling_orbits(FIFTY, start, most_am2, STARTS, 1.0) for most_am2 in (0.02, 0.2))
    assert (strong > 1.0).all()
    assert (weak > strong).all()
    assert settling_orbits(FIFTY, start, 0.0, STARTS, 0.2).min() > 0.2
