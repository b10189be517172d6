"""Plans for a tumbling body: the motion beside scipy's, the descent beside any other move."""

from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from fsw.core.laws.plan.tumbling import Tumbling, costs, damping_course, descend, reference_dipole

CASE = Tumbling(
    inertia_kgm2=np.array([[1.02, 0.1, -0.05], [0.1, 1.85, 0.07], [-0.05, 0.07, 1.95]]),
    wheel_body_nms=np.array([0.0, 0.01, 0.02]),
    omega_body_radps=np.array([0.03, -0.05, 0.06]),
    c_body_from_eci=Rotation.from_rotvec([0.3, -0.8, 1.1]).as_matrix().T,
    b_eci_t=np.array([1.5e-5, -2e-5, 2.5e-5]),
    b_rate_eci_tps=np.array([2e-7, 1e-7, -3e-7]),
    horizon_s=40.0,
    steps=4,
    most_am2=2.0,
    weight=0.7,
    effort=1e-6,
    steepness=None,
)
PLAN = np.array([[1.0, -2.0, 0.5], [0.0, 1.5, -1.0], [2.0, 0.0, 1.0], [-1.0, -1.0, 2.0]])


def flown_energies(case, plan):
    """At the end of each step, by direction cosines and scipy's integrator."""
    inertia, step_s = case.inertia_kgm2, case.horizon_s / case.steps

    def change(t, y, m):
        c, omega = y[:9].reshape(3, 3), y[9:]
        b = c @ (case.b_eci_t + t * case.b_rate_eci_tps)
        torque = np.cross(m, b) - np.cross(omega, inertia @ omega + case.wheel_body_nms)
        return np.concatenate([-np.cross(omega, c.T).T.ravel(), np.linalg.solve(inertia, torque)])

    y, energies = np.concatenate([case.c_body_from_eci.ravel(), case.omega_body_radps]), []
    for k, m in enumerate(plan):
        y = solve_ivp(change, (k * step_s, (k + 1) * step_s), y, args=(m,), rtol=1e-10, atol=1e-14).y[:, -1]
        energies.append(0.5 * y[9:] @ inertia @ y[9:])
    return np.array(energies)


SLOW = replace(
    CASE,
    omega_body_radps=np.array([3e-5, -5e-5, 6e-5]),
    wheel_body_nms=np.array([0.0, 1e-3, 2e-3]),
    b_rate_eci_tps=np.array([2e-6, 1e-6, -3e-6]),
)
"""What energy it has comes of the dipoles, in a field that changes within a step."""


FAST = replace(CASE, omega_body_radps=10.0 * CASE.omega_body_radps)
"""More than a turn a step."""


@pytest.mark.long
@pytest.mark.parametrize("case", [CASE, SLOW, FAST], ids=["tumbling", "slow", "fast"])
def test_the_cost_is_that_of_the_motion(case):
    energies = flown_energies(case, PLAN)
    expected = energies[-1] + np.mean(0.7 * energies + 1e-6 * np.sum(PLAN**2, axis=1))
    assert costs(case, PLAN[None])[0] == pytest.approx(expected, rel=1e-4)
    assert expected > 1e-6 * np.mean(np.sum(PLAN**2, axis=1))


def test_plans_side_by_side_are_what_they_are_alone():
    both = costs(CASE, np.stack([PLAN, -PLAN]))
    assert both.tolist() == pytest.approx([costs(CASE, PLAN[None])[0], costs(CASE, -PLAN[None])[0]])
    assert abs(both[0] - both[1]) > 1e-4 * both[0]


def test_the_reference_takes_energy_away_and_keeps_the_limits():
    b = CASE.c_body_from_eci @ CASE.b_eci_t
    m = reference_dipole(b, CASE.omega_body_radps, 2.0, 1e6)
    assert np.cross(m, b) @ CASE.omega_body_radps < 0.0
    assert reference_dipole(b, CASE.omega_body_radps, 2.0, 1e16) == pytest.approx(
        -2.0 * np.sign(np.cross(b, CASE.omega_body_radps)), rel=1e-4
    )
    weak = reference_dipole(b, CASE.omega_body_radps, 2.0, 1.0)
    assert weak == pytest.approx(-4.0 / pi * np.cross(b, CASE.omega_body_radps))


@pytest.mark.long
def test_the_course_of_the_damping_law_damps():
    case = replace(CASE, steepness=3e6)
    course = damping_course(case)
    energies = flown_energies(case, course)
    assert energies[-1] < flown_energies(case, np.zeros((4, 3)))[-1]
    b = case.c_body_from_eci @ case.b_eci_t
    assert course[0] == pytest.approx(reference_dipole(b, case.omega_body_radps, 2.0, 3e6))


def test_with_a_reference_the_weight_is_of_its_dipole():
    case = replace(CASE, steepness=3e6, weight=0.0)
    heavier = replace(case, weight=2.0)
    more = costs(heavier, PLAN[None])[0] - costs(case, PLAN[None])[0]
    assert 0.0 < more <= 2.0 * 3 * 2.0**2


@pytest.mark.long
def test_the_descent_ends_where_no_single_dipole_is_better():
    plan, cost, made = descend(CASE, np.zeros((4, 3)), -inf, 60)
    assert made > 1
    assert cost == pytest.approx(costs(CASE, plan[None])[0])
    assert np.abs(plan).max() <= 2.0
    for i in range(12):
        for by in (0.5, -0.5):
            other = plan.copy().ravel()
            other[i] = np.clip(other[i] + by, -2.0, 2.0)
            assert costs(CASE, other.reshape(1, 4, 3))[0] > cost - 1e-3 * abs(cost)


def test_what_is_good_enough_is_not_searched_further():
    start_cost = costs(CASE, np.zeros((1, 4, 3)))[0]
    plan, cost, made = descend(CASE, np.zeros((4, 3)), start_cost, 60)
    assert (made, cost) == (0, pytest.approx(start_cost))
    assert not plan.any()
    _, better, more = descend(CASE, np.zeros((4, 3)), start_cost * (1.0 - 1e-6), 60)
    assert 1 <= more < 60
    assert better < start_cost


def test_the_reference_is_that_of_the_field_then():
    """A body too heavy to turn: of each step the dipole at its beginning, in the cost that at its end."""
    rate = np.array([2e-7, 1e-7, -3e-7])
    heavy = replace(
        CASE,
        inertia_kgm2=1e12 * np.eye(3),
        omega_body_radps=np.array([1e-9, -2e-9, 3e-9]),
        wheel_body_nms=np.zeros(3),
        effort=0.0,
        steepness=1e13,
    )

    def reference(t_s):
        b = CASE.c_body_from_eci @ (CASE.b_eci_t + t_s * rate)
        return reference_dipole(b, heavy.omega_body_radps, 2.0, 1e13)

    expected = np.array([reference(10.0 * k) for k in range(4)])
    assert damping_course(heavy) == pytest.approx(expected, rel=1e-5, abs=1e-6)
    squares = [np.sum(reference(10.0 * (k + 1)) ** 2) for k in range(4)]
    energy = 0.5 * 1e12 * heavy.omega_body_radps @ heavy.omega_body_radps
    assert costs(heavy, expected[None])[0] - energy == pytest.approx(0.7 * np.mean(squares), rel=1e-4)
