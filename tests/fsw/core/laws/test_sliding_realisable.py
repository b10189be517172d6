"""The realisable surface: its matrix takes what the coils cannot give, and stays positive definite."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.predictive import free_change
from fsw.core.laws.sliding_realisable import (
    UNIT,
    RealisableGains,
    error_and_rate,
    matrix_change,
    rows,
    sliding_realisable,
    stepped,
)

INERTIA = np.array([[1.02, 0.05, -0.03], [0.05, 1.85, 0.04], [-0.03, 0.04, 1.95]])
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component).filter(lambda v: np.linalg.norm(v) > 0.1)
units = vectors.map(lambda v: tuple((np.array(v) / np.linalg.norm(v)).tolist()))
matrices = st.tuples(*[component] * 6)


@pytest.mark.long
@given(component, units, vectors)
def test_the_change_takes_what_is_wanted_along_the_field(wanted, n, e):
    change = np.array(rows(matrix_change(wanted, n, e)))
    assert np.array(n) @ change @ e == pytest.approx(wanted, abs=1e-12)
    assert np.array_equal(change, change.T)


@pytest.mark.long
@given(component, units, vectors, matrices)
def test_no_other_symmetric_change_that_does_is_smaller(wanted, n, e, other):
    """Whatever is added that takes nothing along the field makes the sum of squares larger."""
    change, added = np.array(rows(matrix_change(wanted, n, e))), np.array(rows(other))
    across = added - np.array(rows(matrix_change(np.array(n) @ added @ e, n, e)))
    assert np.sum((change + across) ** 2) >= np.sum(change**2) - 1e-12


def test_without_an_error_nothing_changes():
    assert matrix_change(1e-6, (0.6, 0.0, 0.8), (0.0, 0.0, 0.0)) == (0.0,) * 6


@given(matrices)
def test_no_step_leaves_the_bounds(change):
    moments = np.linalg.eigvalsh(rows(stepped(UNIT, change, 0.3, 1.5)))
    assert 0.3 < moments.min() <= moments.max() < 1.5


def test_a_step_within_the_bounds_is_made_whole():
    assert stepped(UNIT, (0.1, -0.2, 0.3, 0.05, 0.0, -0.05), 0.3, 1.5) == pytest.approx(
        (1.1, 0.8, 1.3, 0.05, 0.0, -0.05)
    )


def test_a_step_beyond_them_is_halved_until_it_is_not():
    assert stepped(UNIT, (0.0, 0.0, -1.0, 0.0, 0.0, 0.0), 0.3, 1.5) == (1.0, 1.0, 0.5, 0.0, 0.0, 0.0)


def test_the_rate_of_the_error_is_its_derivative(inputs):
    omega, step_s = np.array(inputs.attitude.omega_body_orbit_radps), 1e-3
    q = np.array(inputs.attitude.q_body_from_orbit)
    q0, qv = q[0], q[1:]
    later = qv + 0.5 * step_s * (q0 * omega + np.cross(qv, omega))
    error, rate = error_and_rate(inputs.attitude)
    assert (2.0 * later - error) / step_s == pytest.approx(rate, rel=1e-9)


@pytest.fixture
def inputs(bench, turned):
    orbit = bench.Orbit()
    c_body_from_eci = turned((1, -2, 3), 25.0) @ orbit.c_orbit_from_eci(700.0)
    return bench.inputs_at(orbit, 700, 1.0, c_body_from_eci, np.array([1e-3, 2e-3, -1e-3]), None)


@pytest.fixture
def settings(bench):
    def of(**changed):
        own = {"sliding_realisable": RealisableGains(**changed)}
        return bench.config(bench.Body(INERTIA), 1.0, own)

    return of


def test_with_the_torque_asked_for_the_surface_decays_as_told(bench, inputs, settings):
    """ds/dt = -c s with s = J Omega + K e, all three axes, by the body's own equations."""
    point, config, gains = bench.setpoint(), settings(), RealisableGains()
    before = (1.2, 0.9, 1.1, 0.1, -0.05, 0.02)
    demand = sliding_realisable(inputs, before, point, config)
    w0 = inputs.reference.orbit_rate_radps
    k0 = gains.slope * w0 * np.trace(INERTIA) / 3.0
    k, k_rate = k0 * np.array(rows(before)), k0 * (np.array(rows(demand.memory)) - rows(before))
    omega = np.array(inputs.attitude.omega_body_orbit_radps)
    free = free_change(inputs, inputs.reference, config)
    push = np.cross(demand.m_body_am2, inputs.b_body_t)
    error, error_rate = map(np.array, error_and_rate(inputs.attitude))
    s = INERTIA @ omega + k @ error
    s_rate = INERTIA @ free + push + k @ error_rate + k_rate @ error
    assert s_rate == pytest.approx(-gains.reach * w0 * s, rel=1e-9)


def test_with_a_constant_matrix_it_would_not(bench, inputs, settings):
    """What the bounds close in is lost along the field."""
    memory = sliding_realisable(inputs, (), bench.setpoint(), settings(least=0.999999, most=1.000001)).memory
    assert memory == pytest.approx(UNIT, abs=1e-5)
    free = sliding_realisable(inputs, (), bench.setpoint(), settings()).memory
    assert np.abs(np.subtract(free, UNIT)).max() > 1e-4


@pytest.fixture(scope="module")
def rms_deg(bench, turned):
    """In each of five orbits."""

    def run(angle_deg, **changed):
        flight = bench.fly_from_rest(
            sliding_realisable,
            bench.setpoint(),
            gains={"sliding_realisable": RealisableGains(**changed)},
            body=bench.Body(most_am2=5.0),
            c_body_from_orbit=turned((1, 2, 3), angle_deg),
            orbits=5.0,
            step_s=10.0,
        )
        return [float(np.sqrt(np.mean(part**2))) for part in np.array_split(flight.angle_deg, 5)]

    return run


@pytest.mark.long
@pytest.mark.parametrize("angle_deg", [20.0, 100.0])
def test_the_attitude_converges(rms_deg, angle_deg):
    assert rms_deg(angle_deg)[-1] < 0.5


@pytest.mark.long
def test_a_steep_surface_that_a_constant_matrix_cannot_hold_is_held(rms_deg):
    """The claim of the source: the constant one asks for what is not there, and drives the satellite away."""
    steep = {"reach": 3.0, "slope": 1.0}
    assert rms_deg(20.0, **steep, least=0.999, most=1.001)[-1] > 90.0
    assert max(rms_deg(20.0, **steep)) < 20.0


@pytest.mark.parametrize(
    "changed",
    [{"reach": 0.0}, {"slope": -1.0}, {"back": -0.1}, {"least": 0.0}, {"least": 1.5}, {"most": 1.0}],
)
def test_gains_out_of_range_are_refused(changed):
    with pytest.raises(ValueError, match="must"):
        RealisableGains(**changed)
