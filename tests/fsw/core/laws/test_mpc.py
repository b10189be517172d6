"""Predictive control over the orbit ahead: the regulator on its own field, better than it on the real one."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws import by_mode
from fsw.core.laws.lqr import STEPS, LqrGains, lqr, schedule
from fsw.core.laws.mpc import APPLIED_STEPS, MpcGains, mpc, plan
from fsw.core.laws.plan.riccati import backward
from fsw.core.orbit.ephemeris import ephemeris_model
from fsw.core.orbit.field import FieldKind, field_eci_t
from fsw.core.orbit.propagation import circular_orbit
from fsw.wire.messages import Mode

EPOCH = 1742461200
MOST_AM2 = 2.0
STEP_S = 10.0
INERTIA = np.diag([1.02, 1.85, 1.95])
TORQUE = (1e-7, 1e-7, 1e-7)


def model_of(kind, orbit):
    circle = circular_orbit(orbit.altitude_km, orbit.inclination_deg, 0.0, 0.0, EPOCH)
    return ephemeris_model(circle, EPOCH, 1, kind, degree=4)


@pytest.fixture(scope="module")
def settings(bench):
    orbit = bench.Orbit()
    ready = bench.config(bench.Body(INERTIA, most_am2=MOST_AM2), STEP_S, {"mpc": MpcGains()})
    table = schedule(
        ready.inertia_kgm2,
        (0.0, 0.0, 0.0),
        orbit.rate_radps,
        radians(orbit.inclination_deg),
        7.812e15 / orbit.radius_m**3,
        LqrGains(),
    )
    return replace(ready, schedules={"lqr": table, "mpc": table})


@pytest.fixture
def inputs(bench, turned):
    """Tick 3 of a satellite on the direct dipole's field, 15 deg off."""
    orbit = bench.Orbit()
    c_body_from_eci = turned((1, -2, 3), 15.0) @ orbit.c_orbit_from_eci(30.0)
    given = bench.inputs_at(orbit, 3, STEP_S, c_body_from_eci, np.array([1e-4, 2e-4, 1.3e-3]), None)
    return given.replace(ephemeris=model_of(FieldKind.DIRECT_DIPOLE, orbit))


@pytest.mark.parametrize("steps", [APPLIED_STEPS, STEPS // 3, STEPS, 2 * STEPS])
def test_on_the_field_of_the_regulator_the_plan_is_the_regulator(settings, steps):
    """However far it looks, as its end is worth what the regulator makes of it."""
    table, start = settings.schedules["mpc"], 17
    u = 2.0 * np.pi / STEPS * (start + np.arange(steps) + 0.5)
    i, b0 = radians(98.6), 7.812e15 / (7178137.0**3)
    field = b0 * np.stack([-2 * np.sin(u) * np.sin(i), np.cos(u) * np.sin(i), np.full(steps, np.cos(i))], -1)
    expected = table.gains[(start + np.arange(APPLIED_STEPS)) % STEPS]
    gains = plan(table, field, (start + steps) % STEPS)
    assert gains == pytest.approx(expected, rel=1e-6, abs=1e-7 * np.abs(expected).min(axis=(0, 1)).max())


def test_on_that_field_both_laws_ask_for_nearly_the_same(bench, settings, inputs):
    """Not the same: the steps of the one begin with the plan, those of the other at the node."""
    by_lqr, by_mpc = (np.array(law(inputs, (), bench.setpoint(), settings).m_body_am2) for law in (lqr, mpc))
    assert by_mpc == pytest.approx(by_lqr, abs=0.1 * np.linalg.norm(by_lqr))


def test_the_plan_is_made_along_the_field_in_the_middle_of_its_steps(bench, settings, inputs, turned):
    """From this tick on, to the cost of the step in which it ends, and turned to the axes of the body."""
    table, orbit, c = settings.schedules["mpc"], bench.Orbit(), turned((1, -2, 3), 15.0)
    steps, short = STEPS // 6, replace(settings, gains={"mpc": MpcGains(horizon_orbits=1.0 / 6.0)})
    times = 3 * STEP_S + (np.arange(steps) + 0.5) * table.problem.step_s
    field = np.array([orbit.c_orbit_from_eci(t) @ orbit.b_eci_t(t) for t in times])
    gain = backward(table.problem, field, table.costs[steps])[0][0]
    relative = np.array([1e-4, 2e-4, 1.3e-3]) - orbit.rate_radps * c[:, 2]
    theta = 2.0 * np.sin(np.radians(7.5)) * np.array([1.0, -2.0, 3.0]) / np.sqrt(14.0)
    expected = c @ gain @ np.concatenate([c.T @ relative, theta, np.zeros(3)])
    found = np.array(mpc(inputs, (), bench.setpoint(), short).m_body_am2)
    assert found == pytest.approx(expected, abs=5e-3 * np.abs(expected).max())


@pytest.mark.long
def test_on_a_tilted_field_with_a_constant_torque_the_plan_points_better(bench, settings, turned):
    """What the regulator's own field does not have: the tilt, which turns with the Earth."""
    model = model_of(FieldKind.IGRF14, bench.Orbit())

    class Real(bench.Orbit):
        def b_eci_t(self, t_s):
            r = self.radius_m * self.c_orbit_from_eci(t_s)[..., 0, :]
            times = np.broadcast_to(t_s, r.shape[:-1])
            b = [
                field_eci_t(model.field, tuple(place), EPOCH + float(t))
                for place, t in zip(r.reshape(-1, 3).tolist(), times.reshape(-1), strict=True)
            ]
            return np.array(b).reshape(r.shape)

    orbit = Real()

    def rms_deg(law):
        run = bench.fly(
            law,
            bench.setpoint(),
            orbit=orbit,
            body=bench.Body(INERTIA, most_am2=MOST_AM2, torque=TORQUE),
            c_body_from_orbit=turned((1, 2, 3), 10.0),
            omega_body=(0.0, 0.0, orbit.rate_radps),
            seconds=6.0 * orbit.period_s,
            step_s=STEP_S,
            look=lambda inputs: inputs.replace(torque_body_nm=TORQUE, ephemeris=model),
            settings=settings,
        )
        return float(np.sqrt(np.mean(run.angle_deg[-len(run.t_s) // 2 :] ** 2)))

    by_lqr, by_mpc = rms_deg(lqr), rms_deg(mpc)
    assert by_mpc < 2.2
    assert by_mpc < 0.8 * by_lqr


RESIDUAL_AM2 = (0.05, -0.03, 0.08)


def charged_for_the_whole_dipole(problem, field, last, state, residual_am2):
    """The dipoles of the coils that cost least along the field with effort |m + residual|^2, (steps, 3).

    By least squares over all steps at once, from the step's matrix alone. The cost at the end is ``last``.
    """
    steps, f = len(field), problem.free[:, :6]
    pushes = [problem.free[:, 6:] @ np.cross(np.eye(3), b).T for b in field]
    reach, moved = np.zeros((6, 3 * steps)), np.array(state[:6])
    rows, wanted = [], []
    for k, push in enumerate(pushes):
        reach = f @ reach
        reach[:, 3 * k : 3 * k + 3] = push
        moved = f @ moved + problem.free[:, 6:] @ np.array(state[6:]) + push @ np.array(residual_am2)
        weight = np.diag(np.sqrt(problem.cost)) if k + 1 < steps else np.linalg.cholesky(last[:, :6]).T
        rows.append(weight @ reach)
        wanted.append(-weight @ moved)
    rows.append(np.sqrt(problem.effort) * np.eye(3 * steps))
    wanted.append(-np.sqrt(problem.effort) * np.tile(residual_am2, steps))
    return np.linalg.lstsq(np.concatenate(rows), np.concatenate(wanted), rcond=None)[0].reshape(steps, 3)


def test_the_plan_less_the_residual_dipole_costs_least_where_effort_is_the_whole_dipole(settings):
    """Along any field: so it need not be known when the plan is made."""
    problem, rng = settings.schedules["mpc"].problem, np.random.default_rng(3)
    field = rng.normal(size=(8, 3)) * 3e-5
    last = np.hstack([settings.schedules["mpc"].costs[5][:, :6], np.zeros((6, 3))])
    state = np.concatenate([rng.normal(size=3) * 1e-4, rng.normal(size=3) * 0.1, rng.normal(size=3) * 1e-7])
    gains, _ = backward(problem, field, last)
    best = charged_for_the_whole_dipole(problem, field, last, state, RESIDUAL_AM2)[0]
    assert gains[0] @ state - RESIDUAL_AM2 == pytest.approx(best, abs=1e-6 * np.linalg.norm(best))


@pytest.mark.long
def test_a_residual_dipole_that_is_known_costs_nothing_and_one_that_is_not_drives_it_away(
    bench, settings, turned
):
    """In the mode's demand, from 10 deg off; and while the coils can give it."""
    orbit = bench.Orbit()
    model = model_of(FieldKind.DIRECT_DIPOLE, orbit)
    flown = replace(settings, setpoint=bench.setpoint("mpc"))

    def angles_deg(dipole_am2, known):
        def law(inputs, memory, setpoint, config):
            return by_mode.demand(Mode.POINT, inputs, memory, setpoint, config)

        return bench.fly(
            law,
            flown.setpoint,
            orbit=orbit,
            body=bench.Body(INERTIA, most_am2=MOST_AM2, dipole=dipole_am2),
            c_body_from_orbit=turned((1, 2, 3), 10.0),
            omega_body=(0.0, 0.0, orbit.rate_radps),
            seconds=3.0 * orbit.period_s,
            step_s=STEP_S,
            look=lambda inputs: inputs.replace(
                ephemeris=model, dipole_body_am2=dipole_am2 if known else (0.0, 0.0, 0.0)
            ),
            settings=flown,
        ).angle_deg

    without = angles_deg((0.0, 0.0, 0.0), known=False)
    known = angles_deg(RESIDUAL_AM2, known=True)
    assert known == pytest.approx(without, abs=0.1)
    assert angles_deg(RESIDUAL_AM2, known=False)[-len(without) // 3 :].mean() > 5.0


def test_a_plan_is_flown_for_its_steps_and_then_made_anew(bench, settings, inputs):
    step_ticks = settings.schedules["mpc"].problem.step_s / STEP_S
    memory = mpc(inputs, (), bench.setpoint(), settings).memory
    last, first = int(APPLIED_STEPS * step_ticks), int(APPLIED_STEPS * step_ticks) + 1
    still = mpc(inputs.replace(tick=3 + last), memory, bench.setpoint(), settings).memory
    anew = mpc(inputs.replace(tick=3 + first), memory, bench.setpoint(), settings).memory
    assert still == memory
    assert anew[0] == 3 + first
    assert anew[1:] != memory[1:]


def test_each_step_of_a_plan_has_its_gain(bench, settings, inputs):
    step_ticks = settings.schedules["mpc"].problem.step_s / STEP_S
    memory = mpc(inputs, (), bench.setpoint(), settings).memory
    ticks = [3 + int(step * step_ticks) + 1 for step in range(APPLIED_STEPS)]
    asked = [mpc(inputs.replace(tick=tick), memory, bench.setpoint(), settings) for tick in ticks]
    assert len({demand.m_body_am2 for demand in asked}) == APPLIED_STEPS
    assert {demand.memory for demand in asked} == {memory}


@pytest.mark.parametrize("foreign", [(1.0, 2.0, 3.0), (900.0,) + (7.0,) * 135, (0.0,) * 136])
def test_what_is_not_a_plan_of_now_is_replaced(bench, settings, inputs, foreign):
    """Another law's memory, a plan of the future, and one long gone."""
    late = inputs.replace(tick=500)
    assert mpc(late, foreign, bench.setpoint(), settings) == mpc(late, (), bench.setpoint(), settings)


def test_the_bound_of_the_coils_holds(bench, settings, inputs):
    tight = replace(settings, mean_dipole_am2=1e-3)
    m = mpc(inputs, (), bench.setpoint(), tight).m_body_am2
    free = mpc(inputs, (), bench.setpoint(), settings).m_body_am2
    assert max(map(abs, m)) == pytest.approx(1e-3)
    assert np.cross(m, free) == pytest.approx(np.zeros(3), abs=1e-15)


def test_without_a_bound_in_reach_it_changes_nothing(bench, settings, inputs):
    wide = replace(settings, mean_dipole_am2=1e6)
    assert mpc(inputs, (), bench.setpoint(), wide) == mpc(inputs, (), bench.setpoint(), settings)


@pytest.mark.parametrize("missing", ["attitude", "reference", "ephemeris", "schedule"])
def test_without_knowledge_nothing_is_asked_for(bench, settings, inputs, missing):
    given = settings if missing != "schedule" else replace(settings, schedules={})
    if missing != "schedule":
        inputs = inputs.replace(**{missing: UNKNOWN if missing == "attitude" else None})
    assert mpc(inputs, (), bench.setpoint(), given).m_body_am2 == (0.0, 0.0, 0.0)


def test_a_gap_in_the_attitude_keeps_the_plan(bench, settings, inputs):
    memory = mpc(inputs, (), bench.setpoint(), settings).memory
    assert mpc(inputs.replace(attitude=UNKNOWN), memory, bench.setpoint(), settings).memory == memory
