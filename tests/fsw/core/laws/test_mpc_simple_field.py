"""Prediction with a field that costs less: the fit is as good as the model, a held field for moments."""

import numpy as np
import pytest

from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.laws.lqr import STEPS
from fsw.core.laws.mpc import mpc
from fsw.core.laws.mpc_simple_field import FittedGains, HeldFieldGains, fitted, mpc_fitted, mpc_held
from fsw.core.laws.plan.riccati import backward
from fsw.core.orbit.field import FieldKind

DIAGONAL = np.diag([1.02, 1.85, 1.95])


def test_a_field_of_five_functions_is_fitted_exactly():
    u = 2.0 * np.pi * (np.arange(12) + 0.5) / 12.0
    wanted = np.array([0.1, 1.7, 4.4])

    def field(u):
        return np.stack([1.0 + np.cos(u), np.sin(2.0 * u) - 2.0, np.cos(2.0 * u) - 3.0 * np.sin(u)], axis=-1)

    assert fitted(u, field(u), wanted) == pytest.approx(field(wanted))


def test_what_the_functions_do_not_have_is_averaged_out():
    u = 2.0 * np.pi * (np.arange(12) + 0.5) / 12.0
    found = fitted(u, np.tile(np.cos(4.0 * u), (3, 1)).T, np.array([0.3]))
    assert found == pytest.approx(np.zeros((1, 3)), abs=1e-12)


@pytest.fixture(scope="module")
def flight(bench, turned):
    def fly(law, name, gains=None, orbits=2.0):
        body, model = bench.Body(DIAGONAL, most_am2=2.0), bench.model_of(bench.Orbit())
        return bench.fly_from_rest(
            law,
            bench.setpoint(),
            body=body,
            c_body_from_orbit=turned((1, 2, 3), 20.0),
            orbits=orbits,
            step_s=20.0,
            look=lambda inputs: inputs.replace(ephemeris=model, tick=20 * inputs.tick),
            settings=bench.scheduled(body, 1.0, name, gains),
        )

    return fly


def test_on_the_dipoles_field_the_fit_flies_as_the_model_does(flight):
    """Its field has the five functions alone."""
    by_fit, by_model = flight(mpc_fitted, "mpc_fitted", orbits=0.5), flight(mpc, "mpc", orbits=0.5)
    assert by_fit.m_body == pytest.approx(by_model.m_body, abs=1e-3 * np.abs(by_model.m_body).max())


@pytest.mark.long
def test_the_longer_a_field_is_held_the_worse_it_points(flight):
    """The source: with the field held, the horizon must be short."""
    soon, late = (
        np.mean(flight(mpc_held, "mpc_held", {"horizon_orbits": h}).angle_deg[-300:]) for h in (0.04, 0.125)
    )
    assert soon < 1.5
    assert late > 4.0 * soon


@pytest.fixture
def asked(bench, turned):
    def ask(law, name, memory=(), tick=9, **changed):
        orbit, body = bench.Orbit(), bench.Body(DIAGONAL, most_am2=2.0)
        c = turned((1, -2, 3), 15.0) @ orbit.c_orbit_from_eci(float(tick))
        inputs = bench.inputs_at(orbit, tick, 1.0, c, np.array([1e-3, 0.0, 1e-3]), None)
        inputs = inputs.replace(ephemeris=bench.model_of(orbit, FieldKind.DIRECT_DIPOLE))
        settings = bench.scheduled(body, 1.0, name)
        return law(inputs.replace(**changed), memory, bench.setpoint(), settings)

    return ask


BOTH = pytest.mark.parametrize(("law", "name"), [(mpc_fitted, "mpc_fitted"), (mpc_held, "mpc_held")])


@BOTH
@pytest.mark.parametrize("missing", ["attitude", "reference"])
def test_without_knowledge_nothing_is_asked_for(asked, law, name, missing):
    assert any(asked(law, name).m_body_am2)
    changed = {missing: UNKNOWN if missing == "attitude" else None}
    assert asked(law, name, **changed).m_body_am2 == (0.0, 0.0, 0.0)


def test_the_fit_needs_a_model_and_the_held_field_none(asked):
    assert not any(asked(mpc_fitted, "mpc_fitted", ephemeris=None).m_body_am2)
    assert any(asked(mpc_held, "mpc_held", ephemeris=None).m_body_am2)


def test_the_held_field_is_renewed_each_step_and_the_fit_each_five(asked):
    for law, name, steps in ((mpc_fitted, "mpc_fitted", 5), (mpc_held, "mpc_held", 1)):
        memory = asked(law, name).memory
        step_s = 6052.4 / 48.0
        assert asked(law, name, memory, tick=int(8 + steps * step_s)).memory == memory
        assert asked(law, name, memory, tick=int(11 + steps * step_s)).memory != memory


@pytest.mark.parametrize("gains", [{"horizon_orbits": 0.6}, {"horizon_orbits": 0.0}, {"effort": 0.0}])
def test_numbers_out_of_range_are_refused(gains):
    with pytest.raises(ValueError, match="must be"):
        HeldFieldGains(**gains)
    with pytest.raises(ValueError, match="must be"):
        FittedGains(**({"horizon_orbits": 5.0} if gains.get("horizon_orbits") == 0.6 else gains))


def test_the_held_field_is_that_of_orbital_axes(asked, bench, turned):
    """Of a turned body the plan is that along the field seen from the orbit, not from the body."""
    orbit, c, body = bench.Orbit(), turned((1, -2, 3), 15.0), bench.Body(DIAGONAL, most_am2=2.0)
    table = bench.scheduled(body, 1.0, "mpc_held").schedules["mpc_held"]
    b_orbit = orbit.c_orbit_from_eci(9.0) @ orbit.b_eci_t(9.0)
    steps = round(HeldFieldGains().horizon_orbits * STEPS)
    gain = backward(table.problem, np.tile(b_orbit, (steps, 1)), table.costs[steps])[0][0]
    relative = np.array([1e-3, 0.0, 1e-3]) - orbit.rate_radps * c[:, 2]
    theta = 2.0 * np.sin(np.radians(7.5)) * np.array([1.0, -2.0, 3.0]) / np.sqrt(14.0)
    x = np.concatenate([c.T @ relative, theta, c.T @ np.array(table.problem.resting_nm)])
    expected = c @ gain @ x
    expected *= min(1.0, 2.0 / np.abs(expected).max())
    assert asked(mpc_held, "mpc_held").m_body_am2 == pytest.approx(expected, rel=1e-6)
