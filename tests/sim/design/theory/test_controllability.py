"""The Gramian of an orbit: by its definition, regular on an inclined orbit, singular over the equator."""

from dataclasses import replace

import numpy as np
import pytest

from sim.design.theory.bodies import BODIES, Body
from sim.design.theory.controllability import conditioning, gramian
from sim.design.theory.linear import dipole_field, free_motion, skew

FULL = Body("full", ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95)), 800.0, 98.6)


def test_it_is_what_dipoles_of_an_orbit_reach():
    """W = sum of x x^T of the motions from unit dipoles, integrated step by step on the way."""
    steps = 3600
    h, reached = 2.0 * np.pi / steps, np.zeros((6, 6))
    inertia = np.array(FULL.inertia_kgm2) / (np.trace(FULL.inertia_kgm2) / 3.0)
    free = free_motion(FULL)
    for u in h * (np.arange(steps) + 0.5):
        push = np.zeros((6, 3))
        push[:3] = -np.linalg.solve(inertia, skew(dipole_field(np.array(u), FULL)))
        reached = reached + h * (free @ reached + reached @ free.T + push @ push.T)
    assert gramian(FULL) == pytest.approx(reached, rel=0.02, abs=0.02 * np.abs(reached).max())


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body.name)
def test_on_an_inclined_orbit_every_motion_can_be_stopped(body):
    assert conditioning(body) > 1e-5


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body.name)
def test_over_the_equator_pitch_cannot(body):
    """The dipole's field stands along the normal: no torque about it."""
    assert conditioning(replace(body, inclination_deg=0.0)) < 1e-12
