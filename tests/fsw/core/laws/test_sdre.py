"""The state-dependent regulator: its factors are the motion, and from far off it costs less than ``lqr``."""

import numpy as np
import pytest

from fsw.core.algebra.quaternion import dcm, normalise
from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.lqr import lqr, node
from fsw.core.laws.plan.riccati import free_step, resting_torque, stepped
from fsw.core.laws.predictive import free_rate_change
from fsw.core.laws.sdre import factors, sdre, solution
from fsw.core.orbit.earth import MU_M3PS2

INERTIA = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
WHEEL = (0.002, -0.003, 0.01)
RADIUS_M = 7178137.0
W0 = float(np.sqrt(MU_M3PS2 / RADIUS_M**3))
ATTITUDES = [(1.0, 0.0, 0.0, 0.0), (0.7, 0.3, -0.5, 0.4), (-0.2, 0.5, 0.6, -0.3), (0.05, -0.9, 0.3, 0.2)]


@pytest.mark.parametrize("q", ATTITUDES)
def test_the_factors_times_the_state_are_the_motion(q):
    """At any attitude and rate, beside the predictive law's equation; and the kinematics of a quaternion."""
    q, omega = normalise(q), (8e-4, -2e-3, 1.5e-3)
    a = factors(q, omega, W0, INERTIA, WHEEL)
    sign = 1.0 if q[0] >= 0.0 else -1.0
    vector = sign * np.array(q[1:])
    rest = resting_torque(INERTIA, WHEEL, W0)
    change = a @ np.concatenate([omega, 2.0 * vector, rest])
    inverse = tuple(map(tuple, np.linalg.inv(INERTIA).tolist()))
    expected = free_rate_change(omega, dcm(q), W0, RADIUS_M, INERTIA, inverse, WHEEL)
    assert change[:3] == pytest.approx(expected, rel=1e-9, abs=1e-13)
    kinematics = sign * q[0] * np.array(omega) + np.cross(vector, omega)
    assert change[3:] == pytest.approx(kinematics)


def test_about_the_nominal_attitude_the_step_is_that_of_the_regulator():
    a = factors((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), W0, INERTIA, WHEEL)
    expected = free_step(INERTIA, WHEEL, W0, 126.0)
    assert stepped(a, 126.0) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.fixture(scope="module")
def flight(bench, turned):
    def fly(law, angle_deg, orbits):
        body, model = bench.Body(np.diag([1.02, 1.85, 1.95]), most_am2=2.0), bench.model_of(bench.Orbit())
        return bench.fly_from_rest(
            law,
            bench.setpoint(),
            body=body,
            c_body_from_orbit=turned((1, 2, 3), angle_deg),
            orbits=orbits,
            step_s=20.0,
            look=lambda inputs: inputs.replace(ephemeris=model, tick=20 * inputs.tick),
            settings=bench.scheduled(body, 1.0, "sdre", also=("lqr",)),
        )

    return fly


@pytest.mark.long
def test_from_far_off_it_costs_less_than_the_linear_regulator(flight):
    """120 deg: the sum of the squared angle over an orbit."""
    by_sdre, by_lqr = (np.sum(flight(law, 120.0, 1.0).angle_deg ** 2) for law in (sdre, lqr))
    assert by_sdre < 0.85 * by_lqr


@pytest.mark.long
def test_near_the_goal_it_points(flight):
    assert flight(sdre, 15.0, 1.6).angle_deg[-1] < 1.0


@pytest.mark.parametrize("missing", ["attitude", "reference", "ephemeris", "schedule"])
def test_without_knowledge_nothing_is_asked_for(bench, missing):
    body, orbit = bench.Body(np.diag([1.02, 1.85, 1.95]), most_am2=2.0), bench.Orbit()
    full, none = bench.scheduled(body, 1.0, "sdre"), bench.scheduled(body, 1.0, "lqr")
    inputs = bench.inputs_at(orbit, 9, 1.0, np.eye(3), np.array([1e-3, 2e-3, 1e-3]), None)
    inputs = inputs.replace(ephemeris=bench.model_of(orbit))
    assert any(sdre(inputs, (), bench.setpoint(), full).m_body_am2)
    if missing != "schedule":
        inputs = inputs.replace(**{missing: UNKNOWN if missing == "attitude" else None})
    settings = none if missing == "schedule" else full
    assert sdre(inputs, (), bench.setpoint(), settings).m_body_am2 == (0.0, 0.0, 0.0)


def test_a_solution_is_flown_for_its_steps_and_then_made_anew(bench):
    body, orbit = bench.Body(np.diag([1.02, 1.85, 1.95]), most_am2=2.0), bench.Orbit()
    settings = bench.scheduled(body, 1.0, "sdre")
    inputs = bench.inputs_at(orbit, 9, 1.0, np.eye(3), np.array([1e-3, 2e-3, 1e-3]), None)
    inputs = inputs.replace(ephemeris=bench.model_of(orbit))
    memory = sdre(inputs, (), bench.setpoint(), settings).memory
    last = int(2.0 * settings.schedules["sdre"].problem.step_s)
    assert sdre(inputs.replace(tick=9 + last), memory, bench.setpoint(), settings).memory == memory
    assert sdre(inputs.replace(tick=10 + last), memory, bench.setpoint(), settings).memory[0] == 10 + last


TUMBLING = np.array([-0.022, 0.0051, -0.0021])


@pytest.mark.parametrize(("times", "is_solved"), [(1.0, True), (5.0, False), (50.0, False), (1e4, False)])
def test_where_the_course_leaves_all_bounds_nothing_is_asked_for(bench, times, is_solved):
    """Two minutes, the step of the regulator, are many turns of a body that tumbles fast."""
    settings = bench.scheduled(bench.Body(np.diag([1.02, 1.85, 1.95]), most_am2=6.4), 1.0, "sdre")
    inputs = bench.inputs_at(bench.Orbit(), 9, 1.0, np.eye(3), times * TUMBLING, None)
    found = sdre(inputs.replace(ephemeris=bench.model_of(bench.Orbit())), (), bench.setpoint(), settings)
    assert any(found.m_body_am2) is is_solved
    assert bool(found.memory) is is_solved
    assert np.isfinite(found.m_body_am2).all()


@pytest.mark.interpreted
@pytest.mark.parametrize("last", [np.inf, np.nan])
def test_a_course_that_only_ends_beyond_all_bounds_is_no_solution(bench, monkeypatch, last):
    settings = bench.scheduled(bench.Body(np.array(INERTIA), most_am2=2.0), 1.0, "sdre")
    given = (settings.schedules["sdre"], np.full(6, 1e-4), (0.0, 0.0, 0.0), np.full((3, 3), 2e-5), 7, W0)
    assert solution(*given, settings) is not None
    ending = [*[np.full(6, 1e-4)] * 3, np.full(6, last)]
    monkeypatch.setattr("fsw.core.laws.sdre.SEQUENCE", 1)
    monkeypatch.setattr("fsw.core.laws.sdre._course", lambda *_: ending)
    assert solution(*given, settings) is None


@pytest.mark.parametrize("steps", [1, 2])
def test_the_cost_at_the_end_is_that_of_orbital_axes(bench, turned, steps):
    """From 50 deg off: no other last dipole leaves less effort and cost, turned as the body is then."""
    settings = bench.scheduled(bench.Body(np.array(INERTIA), most_am2=2.0), 1.0, "sdre")
    table, torque = settings.schedules["sdre"], np.array([2e-7, -1e-7, 3e-7])
    vector = np.sin(np.radians(25.0)) * np.array([1.0, -2.0, 3.0]) / np.sqrt(14.0)
    state = np.concatenate([[-1.2e-3, 1e-3, -8e-4], 2.0 * vector])
    b = np.array([[2e-5, -1e-5, 1.5e-5], [-1e-5, 2e-5, 1e-5]])[:steps]
    gains = solution(table, state, tuple(torque), b, 7, W0, settings)

    def attitude(state):
        return (float(np.sqrt(1.0 - state[3:] @ state[3:] / 4.0)), *(0.5 * state[3:]).tolist())

    def step(state, b_orbit, m):
        free = stepped(
            factors(attitude(state), tuple(state[:3]), W0, INERTIA, (0.0, 0.0, 0.0)), table.problem.step_s
        )
        return free @ np.concatenate([state, torque + np.cross(m, np.array(dcm(attitude(state))) @ b_orbit)])

    for b_orbit, gain in zip(b[:-1], gains[:-1], strict=True):
        state = step(state, b_orbit, gain @ np.concatenate([state, torque]))
    m = gains[-1] @ np.concatenate([state, torque])
    end = np.array(dcm(attitude(step(state, b[-1], m))))

    def left(m):
        x = np.kron(np.eye(2), end.T) @ step(state, b[-1], m)
        last, known = table.costs[7], end.T @ torque
        return table.problem.effort * m @ m + x @ last[:, :6] @ x + 2.0 * x @ last[:, 6:] @ known

    by = 1e-2 * np.linalg.norm(m)
    assert min(left(m + one) for one in by * np.vstack([np.eye(3), -np.eye(3)])) > left(m)


@pytest.mark.interpreted
def test_the_fields_looked_at_are_those_in_the_middle_of_the_steps_ahead(bench, monkeypatch):
    """To the node of the table where they end, half an orbit on."""
    seen = []

    def spy(table, start, torque_nm, b_orbit_t, end_node, *rest):
        seen.append((b_orbit_t, end_node))
        return solution(table, start, torque_nm, b_orbit_t, end_node, *rest)

    monkeypatch.setattr("fsw.core.laws.sdre.solution", spy)
    orbit = bench.Orbit()
    settings = bench.scheduled(bench.Body(np.diag([1.02, 1.85, 1.95]), most_am2=2.0), 1.0, "sdre")
    inputs = bench.inputs_at(orbit, 700, 1.0, np.eye(3), np.array([1e-3, 2e-3, 1e-3]), None)
    sdre(inputs.replace(ephemeris=bench.model_of(orbit)), (), bench.setpoint(), settings)
    ((b_orbit_t, end_node),) = seen
    step_s = settings.schedules["sdre"].problem.step_s
    t_s = 700.0 + step_s * (np.arange(len(b_orbit_t)) + 0.5)
    expected = np.einsum("kij,kj->ki", orbit.c_orbit_from_eci(t_s), orbit.b_eci_t(t_s))
    assert b_orbit_t == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())
    assert end_node == node(orbit.rate_radps * (700.0 + step_s * len(b_orbit_t)))
