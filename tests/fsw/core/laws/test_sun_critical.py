"""Critical damping to the Sun: the paper's components, the double root, and the flight with coils alone."""

import numpy as np
import pytest

from fsw.core.laws.interface import FieldSample
from fsw.core.laws.sun_critical import CriticalGains, critical_acceleration, sun_critical

SUN = (0.2, -0.7, 0.5)
MOMENTS = (1.02, 1.85, 1.95)


def test_the_components_are_the_paper_s():
    """In units of the first moment A: m1, m2, m3 with L = A/C, mu = (B - C)/A."""
    (a, b, c), xi = MOMENTS, 0.002
    (w1, w2, w3), (s1, _, s3) = omega, sun = (0.003, -0.001, 0.002), (0.48, 0.6, -0.64)
    ratio, mu = a / c, (b - c) / a
    paper = (
        -2.0 * xi * w1 + xi**2 * s3,
        -2.0 * xi * (1.0 + ratio * mu) * w2 / ratio,
        -(2.0 * xi * w3 + xi**2 * s1) / ratio,
    )
    ours = np.array(MOMENTS) * critical_acceleration(omega, sun, 1, xi) / a
    np.testing.assert_allclose(ours, paper)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_small_angle_falls_as_the_double_root(axis):
    """A turn theta of the body, s = e - theta x e: theta (1 + xi t) exp(-xi t) from rest."""
    xi, step_s, e = 0.01, 0.1, np.eye(3)[axis]
    theta, rate = 1e-3 * (np.array([1.0, -2.0, 1.5]) * (1.0 - e)), np.zeros(3)
    first = theta.copy()
    for _ in range(2000):
        sun = e - np.cross(theta, e)
        rate = rate + step_s * np.array(critical_acceleration(tuple(rate), tuple(sun), axis, xi))
        theta = theta + step_s * rate
    np.testing.assert_allclose(theta, first * 3.0 * np.exp(-2.0), rtol=0.01, atol=1e-12)


def test_the_torque_is_the_inertia_times_it_across_the_field(bench, turned):
    body = bench.Body(inertia=np.array([[1.02, 0.03, -0.02], [0.03, 1.85, 0.05], [-0.02, 0.05, 1.95]]))
    c, omega = turned((1, 2, 3), 40.0) @ bench.Orbit().c_orbit_from_eci(300.0), np.array([3e-3, -2e-3, 1e-3])
    sun = np.array(SUN) / np.linalg.norm(SUN)
    inputs = bench.inputs_at(bench.Orbit(), 300, 1.0, c, omega, FieldSample(), sun)
    settings = bench.config(body, 1.0, {"sun_critical": CriticalGains(3.0, 0.004)})
    m = sun_critical(inputs, (), bench.setpoint(), settings).m_body_am2
    wanted = body.inertia @ critical_acceleration(tuple(omega), tuple(c @ sun), 2, 0.004)
    b = np.array(inputs.b_body_t)
    np.testing.assert_allclose(np.cross(m, b), wanted - b * (b @ wanted) / (b @ b), atol=1e-12)


@pytest.mark.long
@pytest.mark.parametrize(("xi_radps", "comes"), [(0.001, True), (0.006, False)])
def test_with_coils_alone_a_slow_root_comes_to_the_sun_and_a_fast_one_does_not(
    bench, turned, xi_radps, comes
):
    """The field must have turned before the body has: about an orbital rate."""
    run = bench.fly(
        sun_critical,
        bench.setpoint(),
        gains={"sun_critical": CriticalGains(2.0, xi_radps)},
        body=bench.Body(gravity=False),
        c_body_from_orbit=turned((1, 2, -1), 80.0),
        omega_body=(0.005, -0.005, 0.005),
        seconds=3.5 * bench.Orbit().period_s,
        step_s=8.0,
        sun_eci=SUN,
    )
    off = run.axis_to_deg(1, SUN)
    assert off[0] > 40.0
    assert (off[-300:].max() < 10.0) == comes


def test_a_root_without_sense_is_refused():
    with pytest.raises(ValueError, match="must be positive"):
        CriticalGains(2.0, -0.001)
