"""Field tracking by direction: the size of the field does not count, and the air gives the third axis."""

import numpy as np
import pytest

from fsw.core.laws.direction_tracking import direction_error, direction_tracking
from fsw.core.laws.field_tracking import field_tracking
from fsw.core.laws.interface import FieldSample

LONG = np.diag([0.040, 0.012, 0.042])


def test_the_error_by_hand():
    """|B| = 5e-5, B/|B| = (0.6, 0.8, 0), b/|b| = (0, 0, 1)."""
    error = direction_error((0.0, 0.0, 2e-5), (3e-5, 4e-5, 0.0))
    assert error == pytest.approx((-3e-5, -4e-5, 5e-5))


def test_the_pull_turns_the_field_onto_the_expected_one():
    """A body at rest turns with the torque -e x b, and b comes nearer to B."""
    b, expected = np.array([1e-5, 2e-5, -1e-5]), np.array([2e-5, 1e-5, 2e-5])
    turn = np.cross(-np.array(direction_error(tuple(b), tuple(expected))), b)
    moved = b + 1e4 * np.cross(b, turn)  # db/dt = b x omega
    assert np.dot(moved, expected) / np.linalg.norm(moved) > np.dot(b, expected) / np.linalg.norm(b)


def test_a_model_that_is_too_weak_leaves_nothing_to_do_at_the_nominal_attitude(bench):
    """The plain law asks for a dipole along the field, and with the field's change for more."""
    asked = {}
    for law in (direction_tracking, field_tracking):
        memory = ()
        for tick in (500, 501):
            c = bench.Orbit().c_orbit_from_eci(float(tick))
            inputs = bench.inputs_at(bench.Orbit(), tick, 1.0, c, np.zeros(3), FieldSample())
            weak = tuple(0.9 * part for part in inputs.reference.b_eci_t)
            inputs = inputs.replace(reference=inputs.reference.replace(b_eci_t=weak))
            demand = law(inputs, memory, bench.setpoint(k_w=1e6, k_a=800.0), bench.config(bench.Body(), 1.0))
            memory = demand.memory
        asked[law] = np.linalg.norm(demand.m_body_am2)
    assert asked[direction_tracking] < 1e-6
    assert asked[field_tracking] > 1e-3


@pytest.mark.long
@pytest.mark.parametrize("vane_nm", [6e-6, 0.0])
def test_with_the_air_three_axes_are_held_and_without_it_none(bench, turned, vane_nm):
    orbit, c0 = bench.Orbit(altitude_km=400.0, inclination_deg=80.0), turned((2, 5, -3), 35.0)
    run = bench.fly(
        direction_tracking,
        bench.setpoint(k_w=1e5, k_a=20.0),
        orbit=orbit,
        body=bench.Body(inertia=LONG, vane_nm=vane_nm),
        c_body_from_orbit=c0,
        omega_body=np.array([0.001, 0.001, -0.001]) + orbit.rate_radps * c0[:, 2],
        seconds=4.0 * orbit.period_s,
        step_s=6.0,
        known=False,
    )
    if vane_nm:
        assert run.angle_deg[-1] < 2.0
    else:
        assert run.angle_deg[-900:].min() > 15.0
