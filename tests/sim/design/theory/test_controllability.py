"""The Gramian of an orbit: by its definition, regular on an inclined orbit, singular over the equator."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sim.design.theory.bodies import BODIES, Body
from sim.design.theory.controllability import conditioning, gramian
from sim.design.theory.linear import dipole_field, free_motion, skew

FULL = Body("full", ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95)), 800.0, 98.6)


def test_it_is_what_dipoles_of_an_orbit_reach():
    """W' = F W + W F^T + P P^T from nothing, by an adaptive integrator."""
    inertia = np.array(FULL.inertia_kgm2) / (np.trace(FULL.inertia_kgm2) / 3.0)
    free = free_motion(FULL)

    def change(u, flat):
        reached, push = flat.reshape(6, 6), np.zeros((6, 3))
        push[:3] = -np.linalg.solve(inertia, skew(dipole_field(np.array(u), FULL)))
        return (free @ reached + reached @ free.T + push @ push.T).ravel()

    flown = solve_ivp(change, (0.0, 2.0 * np.pi), np.zeros(36), method="DOP853", rtol=1e-10, atol=1e-12)
    reached = flown.y[:, -1].reshape(6, 6)
    assert gramian(FULL) == pytest.approx(reached, rel=1e-4, abs=1e-5 * np.abs(reached).max())


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body.name)
def test_on_an_inclined_orbit_every_motion_can_be_stopped(body):
    assert conditioning(body) > 1e-5


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body.name)
def test_over_the_equator_pitch_cannot(body):
    """The dipole's field stands along the normal: no torque about it."""
    assert conditioning(replace(body, inclination_deg=0.0)) < 1e-12
