"""The surface in the rate: what holds the motion on it, what brings it there, one without the other."""

import numpy as np
import pytest

from fsw.core.laws.sliding_rate import (
    RateSurfaceGains,
    equivalent_change,
    rate_surface,
    reaching_change,
)
from fsw.core.laws.table import LAWS

INERTIA = np.array([[1.02, 0.05, -0.03], [0.05, 1.85, 0.04], [-0.03, 0.04, 1.95]])
BOTH = pytest.mark.parametrize("name", ["sliding_rate", "sliding_rate_modified"])


def test_the_surface_has_no_inertia_in_it():
    assert rate_surface((1e-3, -2e-3, 0.0), (0.1, 0.2, -0.3), 0.01) == pytest.approx((2e-3, 0.0, -3e-3))


def test_the_reaching_is_limited_axis_by_axis():
    assert reaching_change((1e-3, -5e-3, 4e-4), 2e-3, 2e-3) == pytest.approx((-2e-6, 4e-6, -8e-7))


def test_what_holds_the_surface_cancels_its_change():
    """ds/dt = f + u + K dq/dt is zero."""
    free, turning = (1e-6, -2e-6, 3e-6), (1e-4, 2e-4, -1e-4)
    held = np.array(equivalent_change(free, turning, 0.01))
    assert held + free + 0.01 * np.array(turning) == pytest.approx(np.zeros(3), abs=1e-20)


@pytest.fixture
def dipoles(bench, turned):
    """Of both laws, and what they see."""
    orbit = bench.Orbit()
    c_body_from_eci = turned((1, -2, 3), 25.0) @ orbit.c_orbit_from_eci(700.0)
    inputs = bench.inputs_at(orbit, 700, 1.0, c_body_from_eci, np.array([1e-3, 2e-3, -1e-3]), None)
    own = {name: RateSurfaceGains() for name in ("sliding_rate", "sliding_rate_modified")}
    config = bench.config(bench.Body(INERTIA), 1.0, own)
    return inputs, [np.array(LAWS[n].point(inputs, (), bench.setpoint(), config).m_body_am2) for n in own]


def across(v, b):
    n = np.array(b) / np.linalg.norm(b)
    return v - n * (n @ v)


def test_the_modified_law_gives_what_is_normal_to_the_field_of_the_reaching_torque(dipoles):
    inputs, (_, modified) = dipoles
    w0, q = inputs.reference.orbit_rate_radps, np.array(inputs.attitude.q_body_from_orbit)
    s = np.array(inputs.attitude.omega_body_orbit_radps) + 0.5 * w0 * q[1:] * np.sign(q[0])
    wanted = INERTIA @ (-3.0 * w0 * np.clip(s, -w0, w0))
    assert np.cross(modified, inputs.b_body_t) == pytest.approx(across(wanted, inputs.b_body_t), rel=1e-9)


def test_the_classical_law_adds_what_holds_the_surface(dipoles, bench):
    """By the rigid body's equations written out again."""
    inputs, (classical, modified) = dipoles
    w0, omega = inputs.reference.orbit_rate_radps, np.array(inputs.attitude.omega_body_orbit_radps)
    q = np.array(inputs.attitude.q_body_from_orbit)
    q *= np.sign(q[0])
    c = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    c += 2.0 * (np.outer(q[1:], q[1:]) - q[1:] @ q[1:] * np.eye(3))
    c -= 2.0 * q[0] * np.array([[0, -q[3], q[2]], [q[3], 0, -q[1]], [-q[2], q[1], 0]])
    absolute = omega + w0 * c[:, 2]
    gravity = 3.0 * w0**2 * np.cross(c[:, 0], INERTIA @ c[:, 0])
    free = np.linalg.solve(INERTIA, gravity - np.cross(absolute, INERTIA @ absolute))
    free += w0 * np.cross(omega, c[:, 2])
    wanted = -INERTIA @ (free + 0.5 * w0 * 0.5 * (q[0] * omega + np.cross(q[1:], omega)))
    added = np.cross(classical - modified, inputs.b_body_t)
    assert added == pytest.approx(across(wanted, inputs.b_body_t), rel=1e-6)


@pytest.fixture(scope="module")
def rms_deg(bench, turned):
    def run(name):
        flight = bench.fly_from_rest(
            LAWS[name].point,
            bench.setpoint(),
            gains={name: RateSurfaceGains()},
            body=bench.Body(most_am2=5.0),
            c_body_from_orbit=turned((1, 2, 3), 20.0),
            orbits=4.0,
            step_s=10.0,
        )
        return [float(np.sqrt(np.mean(part**2))) for part in np.array_split(flight.angle_deg, 4)]

    return run


@pytest.mark.long
def test_both_converge_and_the_modified_law_sooner(rms_deg):
    classical, modified = rms_deg("sliding_rate"), rms_deg("sliding_rate_modified")
    assert classical[-1] < 0.5
    assert modified[1] < 0.1 * classical[1]
    assert modified[-1] < 0.01


@BOTH
@pytest.mark.parametrize("field", ["reach", "slope", "layer"])
def test_gains_out_of_range_are_refused(name, field):
    with pytest.raises(ValueError, match="greater than 0"):
        LAWS[name].gains(**{field: 0.0})
