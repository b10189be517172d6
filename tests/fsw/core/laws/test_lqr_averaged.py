"""The averaged regulator: one cost matrix, the measured field; near the periodic one where effort is dear."""

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.lqr import STEPS, LqrGains, orbit_problem
from fsw.core.laws.lqr_averaged import AveragedGains, averaged_schedule, gain_at, lqr_averaged
from fsw.core.laws.plan.riccati import periodic, skews

INERTIA = np.array([[1.02, 0.02, 0.01], [0.02, 1.85, -0.03], [0.01, -0.03, 1.95]])
DIAGONAL = np.diag([1.02, 1.85, 1.95])


def problem_of(bench, gains):
    orbit, rows = bench.Orbit(), tuple(map(tuple, INERTIA.tolist()))
    b0 = 7.812e15 / orbit.radius_m**3
    return orbit_problem(rows, (0.0, 0.0, 0.0), orbit.rate_radps, np.radians(98.6), b0, gains)


def test_the_cost_matrix_is_the_one_that_scipy_finds(bench):
    """The averaged reach as the product of a matrix with its transpose."""
    problem, field = problem_of(bench, LqrGains(effort=3.0))
    table = bench.scheduled(bench.Body(INERTIA), 1.0, "lqr_averaged", {"effort": 3.0}).schedules[
        "lqr_averaged"
    ]
    pushes = -problem.free[:, 6:] @ skews(field)
    reach = np.linalg.cholesky(np.mean(pushes @ pushes.swapaxes(1, 2), axis=0) + 1e-18 * np.eye(6))
    expected = solve_discrete_are(
        problem.free[:, :6], reach, np.diag(problem.cost), problem.effort * np.eye(6)
    )
    assert table.costs[0, :, :6] == pytest.approx(expected, rel=1e-4, abs=1e-6 * np.abs(expected).max())


def test_the_known_torque_is_answered_so_that_the_mean_motion_costs_least(bench):
    """S: of the averaged loop driven by d for ever, the slope of the cost at the state."""
    problem, field = problem_of(bench, LqrGains(effort=3.0))
    both = (
        bench.scheduled(bench.Body(INERTIA), 1.0, "lqr_averaged", {"effort": 3.0})
        .schedules["lqr_averaged"]
        .costs[0]
    )
    pushes = -problem.free[:, 6:] @ skews(field)
    reach = np.mean(pushes @ pushes.swapaxes(1, 2), axis=0) / problem.effort
    closed = np.linalg.solve(np.eye(6) + reach @ both[:, :6], problem.free[:, :6])
    series, term = np.zeros((6, 3)), closed.T @ both[:, :6] @ problem.free[:, 6:]
    for _ in range(4000):
        series, term = series + term, closed.T @ term
    assert both[:, 6:] == pytest.approx(series, rel=1e-3, abs=1e-5 * np.abs(series).max())


def test_the_dearer_the_effort_the_nearer_it_is_to_the_periodic_regulator(bench):
    def distance(effort):
        problem, field = problem_of(bench, LqrGains(effort=effort))
        table = bench.scheduled(bench.Body(INERTIA), 1.0, "lqr_averaged", {"effort": effort}).schedules[
            "lqr_averaged"
        ]
        exact = periodic(problem, field)[0][:, :, :6]
        return np.linalg.norm(table.gains[:, :, :6] - exact) / np.linalg.norm(exact)

    near, far = distance(1e4), distance(1.0)
    assert near < 0.1
    assert near < 0.3 * far


def test_the_dipole_turns_with_the_field(bench):
    """The field reversed: the dipole too."""
    table = bench.scheduled(bench.Body(INERTIA), 1.0, "lqr_averaged").schedules["lqr_averaged"]
    b = np.array([1e-5, -2e-5, 1.5e-5])
    assert gain_at(table.problem, table.costs[0], -b) == pytest.approx(
        -gain_at(table.problem, table.costs[0], b)
    )


@pytest.mark.parametrize("factor", [(1.0, 1.0, 1.0), (1.2, 0.85, 1.1), (0.8, 1.15, 0.95)])
def test_it_points_though_the_moments_are_others_than_it_thinks(bench, turned, factor):
    """The source: not sensitive to the inertia."""
    thought = bench.Body(DIAGONAL, most_am2=2.0)
    flown = bench.fly_from_rest(
        lqr_averaged,
        bench.setpoint(),
        body=bench.Body(DIAGONAL * np.array(factor), most_am2=2.0),
        c_body_from_orbit=turned((1, 2, 3), 20.0),
        orbits=2.0,
        step_s=20.0,
        settings=bench.scheduled(thought, 20.0, "lqr_averaged"),
    )
    assert flown.angle_deg[-1] < 1.0


@pytest.mark.parametrize("missing", ["attitude", "reference", "schedule"])
def test_without_knowledge_nothing_is_asked_for(bench, missing):
    body, orbit = bench.Body(INERTIA), bench.Orbit()
    settings = bench.scheduled(body, 1.0, "lqr_averaged" if missing != "schedule" else "lqr")
    inputs = bench.inputs_at(orbit, 9, 1.0, np.eye(3), np.array([1e-3, 2e-3, 1e-3]), None)
    assert any(
        lqr_averaged(inputs, (), bench.setpoint(), bench.scheduled(body, 1.0, "lqr_averaged")).m_body_am2
    )
    if missing == "attitude":
        inputs = inputs.replace(attitude=UNKNOWN)
    if missing == "reference":
        inputs = inputs.replace(reference=None)
    assert lqr_averaged(inputs, (), bench.setpoint(), settings).m_body_am2 == (0.0, 0.0, 0.0)


def test_of_a_turned_body_under_a_torque_the_dipole_is_that_of_the_equation(bench, turned):
    """In orbital axes, 40 deg off, from P, S and the measured field by numpy alone; then in the body's."""
    orbit, c, torque = bench.Orbit(), turned((1, -2, 3), 40.0), np.array([3e-6, -2e-6, 4e-6])
    settings = bench.scheduled(bench.Body(INERTIA), 1.0, "lqr_averaged")
    c_orbit, relative = orbit.c_orbit_from_eci(900.0), np.array([1e-4, -2e-4, 3e-4])
    omega = relative + orbit.rate_radps * c[:, 2]
    inputs = bench.inputs_at(orbit, 900, 1.0, c @ c_orbit, omega, None)
    asked = lqr_averaged(inputs.replace(torque_body_nm=tuple(torque)), (), bench.setpoint(), settings)
    table = settings.schedules["lqr_averaged"]
    problem, both = table.problem, table.costs[0]
    known = c.T @ (torque + problem.resting_nm)
    x = np.concatenate(
        [c.T @ relative, 2.0 * np.sin(np.radians(20.0)) * np.array([1, -2, 3]) / np.sqrt(14.0)]
    )
    push = -problem.free[:, 6:] @ skews(c_orbit @ orbit.b_eci_t(900.0))
    moved = both[:, :6] @ problem.free @ np.concatenate([x, known]) + both[:, 6:] @ known
    curved = push.T @ both[:, :6] @ push + problem.effort * np.eye(3)
    assert asked.m_body_am2 == pytest.approx(c @ -np.linalg.solve(curved, push.T @ moved), rel=1e-6)


def test_where_nothing_holds_the_body_the_cost_is_that_of_half_an_orbit(bench):
    """Over the equator the field does not turn, and a sphere is free about it: value iteration by gains."""
    orbit, gains = bench.Orbit(inclination_deg=0.0), AveragedGains(effort=3.0)
    sphere = ((1.6, 0.0, 0.0), (0.0, 1.6, 0.0), (0.0, 0.0, 1.6))
    given = (sphere, (0.0, 0.0, 0.0), orbit.rate_radps, 0.0, 7.812e15 / orbit.radius_m**3)
    problem, field = orbit_problem(*given, gains)
    pushes = -problem.free[:, 6:] @ skews(field)
    f, mean = problem.free[:, :6], np.mean(pushes @ pushes.swapaxes(1, 2), axis=0)
    values, vectors = np.linalg.eigh(mean)
    kept = values > 1e-9 * values.max()
    reach = vectors[:, kept] * np.sqrt(values[kept])
    cost = np.zeros((6, 6))
    for _ in range(STEPS // 2):
        gain = np.linalg.solve(
            reach.T @ cost @ reach + problem.effort * np.eye(kept.sum()), reach.T @ cost @ f
        )
        cost = f.T @ cost @ (f - reach @ gain) + np.diag(problem.cost)
    found = averaged_schedule(*given, gains).costs[0, :, :6]
    assert found == pytest.approx(cost, rel=1e-6, abs=1e-9 * np.abs(cost).max())
    assert np.linalg.eigvalsh(found)[0] >= -1e-9 * np.abs(found).max()
