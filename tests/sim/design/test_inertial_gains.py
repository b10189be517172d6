"""Gains of inertial pointing: the line of averaging, and how near it comes to the best of all."""

from dataclasses import replace

import numpy as np
import pytest

from sim.design.inertial_gains import (
    best_of_all,
    best_on_line,
    critical_gains,
    inertial_degree,
    inertial_projection,
    natural_k_w,
    slowest,
)
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
