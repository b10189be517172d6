"""Spin about a body axis: what each coil may and may not do, and flights from a tumble."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.interface import FieldSample
from fsw.core.laws.spin import (
    SpinGains,
    nutation,
    nutation_dipole,
    spin_up,
    spin_up_dipole,
    y_thomson,
    y_thomson_dipole,
)

K_W = 3e6
INERTIA = np.diag([2.0, 1.0, 1.0])
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.map(lambda v: tuple(4e-5 * c for c in v))
rates = vectors.map(lambda v: tuple(0.1 * c for c in v))
axes = st.integers(0, 2)


@pytest.fixture(scope="module")
def spinning(bench):
    """Fly a law on a body of most inertia about axis 1, without gravity gradient."""

    def fly(law, name, omega, orbits, spin_radps=0.0, step_s=3.0):
        orbit = bench.Orbit()
        return bench.fly(
            law,
            bench.setpoint(k_w=K_W, spin_radps=spin_radps),
            gains={name: SpinGains(axis=1.0)},
            orbit=orbit,
            body=bench.Body(inertia=INERTIA, gravity=False),
            omega_body=omega,
            seconds=orbits * orbit.period_s,
            step_s=step_s,
        )

    return fly


class TestEquations:
    @pytest.mark.long
    @given(fields, fields, st.floats(0.1, 10.0))
    def test_nutation_of_the_third_axis(self, b, before, interval_s):
        """m3 = -k db3/dt."""
        expected = (0.0, 0.0, -K_W * (b[2] - before[2]) / interval_s)
        assert nutation_dipole(b, before, interval_s, 2, K_W) == pytest.approx(expected, abs=1e-12)

    @given(fields)
    def test_spin_up_of_the_third_axis(self, b):
        """m = k (b2, -b1, 0)."""
        assert spin_up_dipole(b, 2, 7.0) == pytest.approx((7.0 * b[1], -7.0 * b[0], 0.0), abs=1e-15)

    @pytest.mark.long
    @given(fields, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
    def test_y_thomson_of_the_second_axis(self, b, spin, wanted):
        """m1 = k (w2 - w2ref) sign b3, k = k_w |b|."""
        expected = (K_W * np.linalg.norm(b) * (spin - wanted) * np.sign(b[2]), 0.0, 0.0)
        assert y_thomson_dipole(b, spin, wanted, 1, K_W) == pytest.approx(expected, abs=1e-12)


class TestTorques:
    @pytest.mark.long
    @given(fields, rates, axes)
    def test_nutation_damping_adds_no_energy_and_leaves_the_spin(self, b, omega, axis):
        """In a field at rest db/dt = b x omega."""
        earlier = tuple(np.array(b) - 1e-3 * np.cross(b, omega))
        torque = np.cross(nutation_dipole(b, earlier, 1e-3, axis, K_W), b)
        assert torque @ np.array(omega) <= 1e-14
        assert torque[axis] == pytest.approx(0.0, abs=1e-20)

    @given(fields, axes)
    def test_spin_up_never_turns_back(self, b, axis):
        """The torque about e is k (|b|^2 - b_e^2)."""
        torque = np.cross(spin_up_dipole(b, axis, 7.0), b)
        assert torque[axis] == pytest.approx(7.0 * (np.dot(b, b) - b[axis] ** 2), abs=1e-18)

    @given(fields, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), axes)
    def test_y_thomson_torque_opposes_the_error_of_the_spin(self, b, spin, wanted, axis):
        torque = np.cross(y_thomson_dipole(b, spin, wanted, axis, K_W), b)
        across = abs(b[(axis + 1) % 3])
        expected = -K_W * np.linalg.norm(b) * (spin - wanted) * across
        assert torque[axis] == pytest.approx(expected, rel=1e-9, abs=1e-16)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_both_laws_of_the_spin_count_the_absolute_rate(bench, turned, axis):
    """Without a sample before there is no nutation damping beside them."""
    c, omega = turned((1, -2, 3), 40.0) @ bench.Orbit().c_orbit_from_eci(300.0), np.array([0.02, -0.03, 0.01])
    inputs = bench.inputs_at(bench.Orbit(), 300, 1.0, c, omega, FieldSample())
    own = {name: SpinGains(axis + 1.0) for name in ("spin_up", "y_thomson")}
    settings, point = bench.config(bench.Body(), 1.0, own), bench.setpoint(k_w=K_W, spin_radps=0.015)
    b, e = np.array(inputs.b_body_t), np.eye(3)[axis]
    lacking = 0.015 - omega[axis]
    assert spin_up(inputs, (), point, settings).m_body_am2 == pytest.approx(
        K_W * lacking * np.cross(b, e), abs=1e-12
    )
    held = -K_W * lacking * np.linalg.norm(b) * np.sign(b[(axis + 1) % 3]) * np.eye(3)[(axis + 2) % 3]
    assert y_thomson(inputs, (), point, settings).m_body_am2 == pytest.approx(held, abs=1e-12)


@pytest.mark.long
class TestFlights:
    def test_nutation_is_damped_and_the_spin_kept(self, spinning):
        run = spinning(nutation, "nutation", (0.1, -0.03, 0.025), orbits=1.5)
        across = np.linalg.norm(run.omega_body[:, 1:], axis=1)
        assert across[-1] < 0.01 * across[0]
        np.testing.assert_allclose(run.omega_body[:, 0], 0.1, rtol=1e-6)
        by_minute = run.energy_j[across > 0.004][::20]
        assert np.all(np.diff(by_minute) < 0.0)

    def test_spin_up_reaches_its_rate_and_stays(self, spinning):
        run = spinning(spin_up, "spin_up", (0.001, -0.003, 0.005), orbits=1.5, spin_radps=0.1)
        assert run.omega_body[-1, 0] == pytest.approx(0.1, rel=2e-3)
        assert np.linalg.norm(run.omega_body[-1, 1:]) < 2e-4
        assert run.omega_body[:, 0].max() < 0.1001

    def test_y_thomson_spins_about_the_orbit_normal(self, spinning, bench):
        normal = bench.Orbit().c_orbit_from_eci(0.0)[2]
        run = spinning(y_thomson, "y_thomson", (0.01, -0.03, 0.025), orbits=4, spin_radps=0.02, step_s=5.0)
        assert run.omega_body[-1, 0] == pytest.approx(0.02, rel=2e-3)
        tilt_deg = run.axis_to_deg(0, normal)
        assert tilt_deg[0] > 60.0
        assert tilt_deg[-1] < 15.0
        assert tilt_deg[-1] < 0.6 * tilt_deg[len(tilt_deg) // 2]


class TestGains:
    @pytest.mark.parametrize("number", [0.0, 1.5, 4.0])
    def test_there_are_three_axes(self, number):
        with pytest.raises(ValueError, match="body axis 1, 2 or 3"):
            SpinGains(axis=number)
