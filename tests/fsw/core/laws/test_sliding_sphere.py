"""The relay on the rate's surface: it never feeds V of a sphere, and on another body it may."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.sliding_sphere import SphereSlidingGains, relay_dipole, sliding_sphere

component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.filter(lambda v: np.linalg.norm(v) > 0.1).map(lambda v: tuple(4e-5 * c for c in v))
rates = vectors.map(lambda v: tuple(2e-3 * c for c in v))
BOX = np.diag([1.0, 10.0, 10.5])


@pytest.mark.long
@given(rates, fields)
def test_the_coils_never_feed_the_energy_of_a_spheres_surface(s, b):
    """J s . ds/dt = s . (m x b)."""
    assert np.dot(s, np.cross(relay_dipole(s, b, 0.2, 5e-4), b)) <= 1e-20


def test_of_a_box_they_may():
    """s . J^-1 (m x b) greater than zero: what confines the law to spheres."""
    random, s_dot = np.random.default_rng(1), []
    for _ in range(200):
        s, b = random.uniform(-2e-3, 2e-3, 3), random.uniform(-4e-5, 4e-5, 3)
        s_dot.append(s @ np.linalg.solve(BOX, np.cross(relay_dipole(tuple(s), tuple(b), 0.2, 5e-4), b)))
    assert max(s_dot) > 0.1 * abs(min(s_dot))


def test_each_coil_gives_all_it_has_beyond_the_layer():
    assert relay_dipole((0.0, 0.0, 2e-3), (3e-5, 0.0, 0.0), 0.2, 5e-4) == pytest.approx((0.0, 0.2, 0.0))
    assert relay_dipole((0.0, 0.0, 1e-4), (3e-5, 0.0, 0.0), 0.2, 5e-4) == pytest.approx((0.0, 0.04, 0.0))


def test_surface_layer_and_dipole_are_parts_of_w0_and_of_the_mean_dipole(bench, turned):
    """Within a wide layer it is linear: m = -m_0 b x (Omega + K q) / (|b| layer)."""
    orbit, c = bench.Orbit(), turned((1, -2, 3), 25.0)
    omega = np.array([1e-3, 2e-3, -1e-3])
    inputs = bench.inputs_at(orbit, 700, 1.0, c @ orbit.c_orbit_from_eci(700.0), omega, None)
    own = {"sliding_sphere": SphereSlidingGains(slope=0.7, layer=50.0, part=0.03)}
    m = sliding_sphere(inputs, (), bench.setpoint(), bench.config(bench.Body(BOX, most_am2=5.0), 1.0, own))
    w0, b = orbit.rate_radps, np.array(inputs.b_body_t)
    qv = np.sin(np.radians(12.5)) * np.array([1.0, -2.0, 3.0]) / np.sqrt(14.0)
    s = omega - w0 * c[:, 2] + 0.7 * w0 * qv
    expected = -0.03 * 5.0 * np.cross(b, s) / (np.linalg.norm(b) * 50.0 * w0)
    assert m.m_body_am2 == pytest.approx(expected, rel=1e-9)


def test_without_a_field_nothing_is_asked_for():
    assert relay_dipole((1e-3, 0.0, 0.0), (0.0, 0.0, 0.0), 0.2, 5e-4) == (0.0, 0.0, 0.0)


@pytest.mark.long
def test_a_sphere_comes_to_the_nominal_attitude(bench, turned):
    """The claim of the source."""
    flight = bench.fly_from_rest(
        sliding_sphere,
        bench.setpoint(),
        gains={"sliding_sphere": SphereSlidingGains()},
        body=bench.Body(np.diag([1.6, 1.6, 1.6]), most_am2=5.0),
        c_body_from_orbit=turned((1, 2, 3), 20.0),
        orbits=5.0,
        step_s=10.0,
    )
    assert np.sqrt(np.mean(flight.angle_deg[-600:] ** 2)) < 0.3


@pytest.mark.parametrize("changed", [{"slope": 0.0}, {"layer": 0.0}, {"part": 0.0}, {"part": 1.1}])
def test_gains_out_of_range_are_refused(changed):
    with pytest.raises(ValueError, match="must"):
        SphereSlidingGains(**changed)
