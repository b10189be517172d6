"""The linear-quadratic problem: against another implementation, its own cost, and where it has no answer."""

from math import pi

import numpy as np
import pytest
from scipy.linalg import expm

from fsw.core.laws.plan.riccati import (
    NotHeldError,
    backward,
    free_step,
    periodic,
    regulator_problem,
    resting_torque,
)
from sim.design.theory import linear
from sim.design.theory.bodies import Body
from sim.design.theory.periodic_lqr import Augmented, Weights, design

INERTIA = ((1.02, 0.05, -0.03), (0.05, 1.85, 0.1), (-0.03, 0.1, 1.95))
BODY = Body("off-diagonal", INERTIA, 800.0, 98.6)
W0, B0 = BODY.rate_radps, BODY.field_t
NO_WHEEL = (0.0, 0.0, 0.0)
WHEEL = (0.001, -0.002, 0.003)
FAST_WHEEL = (0.05, -0.1, 2.0)


def orbit_field(steps, body=BODY):
    return body.field_t * linear.dipole_field(2.0 * pi / steps * (np.arange(steps) + 0.5), body)


def orbit_problem(steps, rate=1.0, effort=0.1, body=BODY, wheel=NO_WHEEL):
    step_s = 2.0 * pi / steps / body.rate_radps
    return regulator_problem(body.inertia_kgm2, wheel, body.rate_radps, body.field_t, step_s, rate, effort)


@pytest.fixture(scope="module")
def solved():
    given, field = orbit_problem(96), orbit_field(96)
    return given, field, *periodic(given, field)


def rolled(given, field, gains, x, d, change=0.0):
    """The cost of flying gains over one orbit, and the state at its end; the first dipole changed."""
    cost = 0.0
    for k, (gain, b) in enumerate(zip(gains, field, strict=True)):
        m = gain @ np.concatenate([x, d]) + (change if k == 0 else 0.0)
        cost += x @ (given.cost * x) + given.effort * m @ m
        x = given.free[:, :6] @ x + given.free[:, 6:] @ (np.cross(m, b) + d)
    return cost, x


@pytest.mark.parametrize("wheel", [NO_WHEEL, WHEEL, (0.0, 0.0, 0.02), (0.0, 0.0, 0.1), FAST_WHEEL])
def test_a_free_step_is_the_exponential_of_the_linearised_motion(wheel):
    """Beside a fast wheel too, with which a rate turns by many revolutions in the step."""
    to_si = np.diag([W0] * 3 + [1.0] * 3)
    motion = W0 * to_si @ linear.free_motion(Body("b", INERTIA, 800.0, 98.6, wheel)) @ np.linalg.inv(to_si)
    both = np.zeros((9, 9))
    both[:6, :6], both[:3, 6:] = motion, np.linalg.inv(np.array(INERTIA))
    assert free_step(INERTIA, wheel, W0, 100.0) == pytest.approx(expm(100.0 * both)[:6], rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("momentum_nms", [0.15, 1.0])
def test_beside_the_momentum_of_an_ordinary_wheel_the_attitude_is_held(momentum_nms):
    """Its motion dies away over an orbit, as much as with steps of half the length."""

    def left(steps):
        given = orbit_problem(steps, wheel=(0.0, 0.0, momentum_nms))
        field = orbit_field(steps)
        closed = np.eye(6)
        for gain, b in zip(periodic(given, field)[0], field, strict=True):
            closed = (given.free[:, :6] + given.free[:, 6:] @ np.cross(gain[:, :6].T, b).T) @ closed
        return np.abs(np.linalg.eigvals(closed)).max()

    assert left(48) < 0.97
    assert left(48) == pytest.approx(left(96), rel=1e-3)


@pytest.mark.parametrize("wheel", [NO_WHEEL, WHEEL])
def test_the_resting_torque_is_that_of_the_design(wheel):
    body = Body("b", INERTIA, 800.0, 98.6, wheel)
    assert resting_torque(INERTIA, wheel, W0) == pytest.approx(linear.resting_torque(body), rel=1e-9)


@pytest.mark.long
def test_gains_tend_to_the_regulator_of_the_design_as_steps_shorten():
    """Another implementation: Hamiltonian transitions in u, no step held."""

    def ours(steps):
        given = orbit_problem(steps)
        return periodic(given, orbit_field(steps))[0][:: steps // 32]

    def theirs(steps):
        law = design(BODY, Weights(rate=1.0, effort=0.1), Augmented.TORQUE, nodes=steps)
        return law.gain[:: steps // 32]

    exact = theirs(128)
    size = np.abs(exact).max(axis=(0, 1))
    rough, fine = (np.abs(ours(steps) - exact).max(axis=(0, 1)) / size for steps in (768, 1536))
    assert fine.max() < 0.03
    assert fine == pytest.approx(rough / 2.0, rel=0.2)


def test_the_periodic_solution_comes_again_after_an_orbit(solved):
    given, field, gains, costs = solved
    again, before = backward(given, field, costs[0])
    assert before[0] == pytest.approx(costs[0], rel=1e-8, abs=1e-8 * np.abs(costs[0]).min())
    assert again == pytest.approx(gains, rel=1e-6, abs=1e-8 * np.abs(gains).max())


def test_the_cost_told_is_the_cost_flown(solved):
    """x^T P x + 2 x^T S d, less the part of d alone, which is that of a start at rest."""
    given, field, gains, costs = solved
    x, d = np.array([2e-4, -1e-4, 3e-4, 0.1, -0.2, 0.15]), np.array([1e-7, -2e-7, 3e-7])

    def reports(ahead, state):
        return state @ ahead[:, :6] @ state + 2.0 * state @ ahead[:, 6:] @ d

    def whole(start):
        run, end = rolled(given, field, gains, start, d)
        return run + reports(costs[0], end)

    assert whole(x) - whole(0.0 * x) == pytest.approx(reports(costs[0], x), rel=1e-9)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_any_other_first_dipole_costs_more(solved, axis, sign):
    given, field, gains, costs = solved
    x, d = np.array([2e-4, -1e-4, 3e-4, 0.1, -0.2, 0.15]), np.array([1e-7, -2e-7, 3e-7])

    def whole(change):
        run, end = rolled(given, field, gains, x, d, change)
        return run + end @ costs[0][:, :6] @ end + 2.0 * end @ costs[0][:, 6:] @ d

    assert whole(sign * 0.01 * np.eye(3)[axis]) > whole(np.zeros(3))


def test_a_body_that_no_dipole_holds_has_no_schedule():
    """On an equatorial orbit the dipole's field is along the normal: no torque about it, ever."""
    body = Body("equatorial", ((1.02, 0.0, 0.0), (0.0, 1.85, 0.0), (0.0, 0.0, 1.95)), 800.0, 0.0)
    with pytest.raises(NotHeldError, match="no periodic dipole"):
        periodic(orbit_problem(96, body=body), orbit_field(96, body))
