"""Prediction within the limits: the programme is the problem, and pays where coils are at their limits."""

from dataclasses import replace

import numpy as np
import pytest

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.lqr import STEPS
from fsw.core.laws.mpc import mpc
from fsw.core.laws.mpc_box import BoxGains, mpc_box, programme
from fsw.core.laws.plan.box import box_minimum
from fsw.core.laws.plan.riccati import backward, skews

INERTIA = np.array([[1.02, 0.02, 0.01], [0.02, 1.85, -0.03], [0.01, -0.03, 1.95]])
STATE = np.array([2e-4, -1e-4, 3e-4, 0.1, -0.05, 0.2, 2e-8, -3e-8, 1e-8])


@pytest.fixture(scope="module")
def table(bench):
    return bench.scheduled(bench.Body(INERTIA), 1.0, "mpc_box").schedules["mpc_box"]


@pytest.fixture(scope="module")
def field():
    return 3e-5 * np.random.default_rng(4).standard_normal((6, 3))


def test_the_programme_is_the_cost_of_the_steps(table, field, turned):
    """Of any dipoles, in body axes of a turned body, against the steps one by one."""
    problem, c = table.problem, turned((3, -1, 2), 25.0)
    h, g = programme(table, field, c, STATE, 7)
    dipoles = 0.02 * np.random.default_rng(5).standard_normal((6, 3))

    def cost(dipoles):
        x, total, last = STATE[:6], 0.0, table.costs[7]
        for k, m in enumerate(dipoles):
            torque = STATE[6:] - skews(field[k]) @ (c.T @ m)
            x = problem.free @ np.concatenate([x, torque])
            total += problem.effort * m @ m + (x @ (problem.cost * x) if k < 5 else 0.0)
        return total + x @ last[:, :6] @ x + 2.0 * x @ last[:, 6:] @ STATE[6:]

    by_programme = dipoles.ravel() @ h @ dipoles.ravel() + 2.0 * g @ dipoles.ravel()
    assert by_programme == pytest.approx(cost(dipoles) - cost(np.zeros((6, 3))), rel=1e-9)


def test_without_limits_it_is_the_plan_of_the_regulator(table, field):
    h, g = programme(table, field, np.eye(3), STATE, 7)
    gains, _ = backward(table.problem, field, table.costs[7])
    assert box_minimum(h, g, 1e6)[:3] == pytest.approx(gains[0] @ STATE, rel=1e-6, abs=1e-9)


@pytest.fixture(scope="module")
def flight(bench, turned):
    def fly(law, most_am2):
        body, model = (
            bench.Body(np.diag([1.02, 1.85, 1.95]), most_am2=most_am2),
            bench.model_of(bench.Orbit()),
        )
        return bench.fly_from_rest(
            law,
            bench.setpoint(),
            body=body,
            c_body_from_orbit=turned((1, 2, 3), 20.0),
            orbits=1.5,
            step_s=20.0,
            look=lambda inputs: inputs.replace(ephemeris=model, tick=20 * inputs.tick),
            settings=bench.scheduled(body, 1.0, "mpc_box", also=("mpc",)),
        )

    return fly


@pytest.mark.long
def test_with_weak_coils_it_costs_less_than_the_plan_shortened(flight):
    """10 mA m^2 for 20 deg: the sum of the squared angle."""
    boxed, shortened = (flight(law, 0.01) for law in (mpc_box, mpc))
    assert np.abs(boxed.m_body).max() <= 0.01
    assert np.sum(boxed.angle_deg**2) < 0.92 * np.sum(shortened.angle_deg**2)
    assert boxed.angle_deg[-1] < 1.5


@pytest.fixture
def asked(bench, turned):
    def ask(memory=(), tick=9, settings=None, **changed):
        orbit, body = bench.Orbit(), bench.Body(INERTIA, most_am2=2.0)
        c = turned((1, -2, 3), 15.0) @ orbit.c_orbit_from_eci(float(tick))
        inputs = bench.inputs_at(orbit, tick, 1.0, c, np.array([1e-3, 0.0, 1e-3]), None)
        inputs = inputs.replace(ephemeris=bench.model_of(orbit))
        ready = settings or bench.scheduled(body, 1.0, "mpc_box")
        return mpc_box(inputs.replace(**changed), memory, bench.setpoint(), ready)

    return ask


def test_a_dipole_is_given_for_a_step_and_then_found_anew(asked, table):
    memory, last = asked().memory, int(table.problem.step_s)
    assert asked(memory, tick=9 + last).memory == memory
    assert asked(memory, tick=10 + last).memory[0] == 10 + last
    assert asked(memory, tick=8) == asked((), tick=8)


@pytest.mark.parametrize("missing", ["attitude", "reference", "ephemeris"])
def test_without_knowledge_nothing_is_asked_for(asked, missing):
    assert any(asked().m_body_am2)
    assert asked(**{missing: UNKNOWN if missing == "attitude" else None}).m_body_am2 == (0.0, 0.0, 0.0)


def test_without_a_schedule_nothing_is_asked_for(asked, bench):
    ready = bench.scheduled(bench.Body(INERTIA), 1.0, "mpc_box")
    assert asked(settings=replace(ready, schedules={})).m_body_am2 == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("gains", [{"horizon_orbits": 2.0}, {"horizon_orbits": 0.0}, {"effort": 0.0}])
def test_numbers_out_of_range_are_refused(gains):
    with pytest.raises(ValueError, match="must be"):
        BoxGains(**gains)


def test_the_default_reaches_half_an_orbit():
    assert round(BoxGains().horizon_orbits * STEPS) == STEPS // 2


def test_of_a_turned_body_the_dipole_is_in_its_axes(asked, bench, turned, table):
    """No limit met: the plan of the regulator along the model's field, turned from orbital axes."""
    orbit, c, body = bench.Orbit(), turned((1, -2, 3), 15.0), bench.Body(INERTIA, most_am2=1e3)
    steps = round(BoxGains().horizon_orbits * STEPS)
    times = 9.0 + (np.arange(steps) + 0.5) * table.problem.step_s
    field = np.array([orbit.c_orbit_from_eci(t) @ orbit.b_eci_t(t) for t in times])
    gain = backward(table.problem, field, table.costs[steps])[0][0]
    relative = np.array([1e-3, 0.0, 1e-3]) - orbit.rate_radps * c[:, 2]
    theta = 2.0 * np.sin(np.radians(7.5)) * np.array([1.0, -2.0, 3.0]) / np.sqrt(14.0)
    x = np.concatenate([c.T @ relative, theta, c.T @ np.array(table.problem.resting_nm)])
    found = asked(settings=bench.scheduled(body, 1.0, "mpc_box")).m_body_am2
    assert found == pytest.approx(c @ gain @ x, rel=1e-2, abs=1e-2 * np.abs(gain @ x).max())


@pytest.mark.interpreted
def test_the_programme_ends_in_the_cost_of_its_last_node(bench, monkeypatch):
    """A quarter of an orbit ahead."""
    ends = []

    def spy(table, b_orbit_t, c, state, end_node):
        ends.append((len(b_orbit_t), end_node))
        return programme(table, b_orbit_t, c, state, end_node)

    monkeypatch.setattr("fsw.core.laws.mpc_box.programme", spy)
    orbit, body = bench.Orbit(), bench.Body(INERTIA, most_am2=2.0)
    settings = bench.scheduled(body, 1.0, "mpc_box", {"horizon_orbits": 0.25})
    inputs = bench.inputs_at(orbit, 700, 1.0, np.eye(3), np.array([1e-3, 2e-3, 1e-3]), None)
    mpc_box(inputs.replace(ephemeris=bench.model_of(orbit)), (), bench.setpoint(), settings)
    at = orbit.rate_radps * 700.0 / (2.0 * np.pi) * STEPS
    assert ends == [(STEPS // 4, (int(at) + STEPS // 4) % STEPS)]
