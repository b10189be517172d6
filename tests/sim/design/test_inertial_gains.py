"""Gains of inertial pointing: the line of averaging, and how near it comes to the best of all."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fsw.core.algebra.quaternion import multiply
from fsw.core.laws.pd import far_error, pd_dipole
from sim.design import inertial_gains as module
from sim.design.inertial_gains import (
    best_of_all,
    best_on_line,
    corners,
    critical_gains,
    inertial_degree,
    inertial_projection,
    minimax,
    natural_k_w,
    robust_share,
    settling_orbits,
    slowest,
    spread_starts,
    worst_degree,
)
from sim.design.pd_limits import weaker
from sim.design.theory.bodies import BODIES, Body, diagonal
from sim.design.theory.linear import Gains, feedback_scales, projection

FIFTY = BODIES[2]
SPHERE = Body("sphere", diagonal((1.6, 1.6, 1.6)), 800.0, 98.6)


def test_at_the_node_the_axes_are_the_orbits_and_half_an_orbit_later_turned_about():
    u = np.array([0.0, np.pi])
    turned, plain = inertial_projection(u, FIFTY), projection(u, FIFTY)
    assert turned[0] == pytest.approx(plain[0])
    about = np.diag([-1.0, -1.0, 1.0])
    assert turned[1] == pytest.approx(about @ plain[1] @ about)


def test_the_slowest_axis_of_a_polar_orbit_over_a_sphere():
    """<G> of B = (-3/2 sin 2u, 3/2 cos 2u - 1/2, 0): diag(11/8, 9/8, 5/2)."""
    polar = Body("polar", diagonal((2.0, 2.0, 2.0)), 800.0, 90.0)
    assert slowest(polar) == pytest.approx(9.0 / 8.0 / 2.0, rel=1e-6)


def test_on_the_line_the_slowest_axis_is_critically_damped():
    """z^2 + g (K_w z + K_a) = 0 has a double root for the least g of J^-1 <G>, of any body."""
    inertia = ((1.02, 0.13, -0.09), (0.13, 1.85, 0.21), (-0.09, 0.21, 1.95))
    body = replace(FIFTY, inertia_kgm2=inertia)
    u = 2.0 * np.pi * np.arange(360) / 360.0
    mean = inertial_projection(u, body).mean(axis=0)
    g = np.linalg.eigvals(np.linalg.solve(np.array(inertia), mean)).real.min()
    k_w, k_a = feedback_scales(body, critical_gains(body, 3e6)).tolist()
    assert (g * k_w) ** 2 == pytest.approx(4.0 * g * k_a, rel=1e-6)


@pytest.mark.parametrize("stiffness", [4.0, 0.4])
def test_weak_gains_decay_as_averaging_says(stiffness):
    """As the slowest root of z^2 + g (K_w z + K_a) = 0, g of J^-1 <G>, above and below critical."""
    line = critical_gains(SPHERE, 0.02 * natural_k_w(SPHERE))
    gains = Gains(line.k_w, stiffness * line.k_a)
    mean = inertial_projection(np.linspace(0.0, np.pi, 721)[:-1], SPHERE).mean(axis=0) / 1.6
    k_w, k_a = feedback_scales(SPHERE, gains).tolist()
    roots = [np.roots([1.0, g * k_w, g * k_a]).real.max() for g in np.linalg.eigvalsh(mean)]
    assert inertial_degree(SPHERE, gains) == pytest.approx(max(roots), rel=0.02)


@pytest.mark.long
def test_the_best_of_the_line_is_near_the_best_of_all():
    """The claim of the source: a simple scheme will do."""
    (_, line), (_, best) = best_on_line(FIFTY), best_of_all(FIFTY)
    assert best <= line < 0.75 * best < 0.0


# --- Gains for bounds on the inertia: the corners are bodies, and weaker gains hold at all of them


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


# --- Minimax gains: the flights of many starts at once are those of one, and the search shortens the longest

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
@pytest.mark.slow
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
