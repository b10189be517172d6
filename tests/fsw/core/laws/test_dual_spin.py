"""Dual spin: the torques of the three coils, and the wheel brought to the orbit normal."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.dual_spin import (
    DualSpinGains,
    dual_spin,
    pitch,
    pitch_dipole,
    twice_roll,
    wheel_axis_dipole,
)
from fsw.core.laws.interface import Wheel
from fsw.core.laws.pitch_wheel import PitchWheelGains, pitch_wheel

WHEEL = (0.0, 0.0, 0.05)
INERTIA = np.diag([1.9, 1.95, 2.0])
component = st.floats(-1.0, 1.0, allow_subnormal=False)
vectors = st.tuples(component, component, component)
fields = vectors.map(lambda v: tuple(4e-5 * c for c in v))
rates = vectors.map(lambda v: tuple(0.01 * c for c in v))


@given(fields, rates)
def test_the_rate_term_takes_energy_away_by_the_coil_along_the_wheel_alone(b, omega):
    m = wheel_axis_dipole(b, omega, 0.0, 1e7, 4000.0)
    assert m[0] == m[1] == 0.0
    assert np.dot(np.cross(m, b), omega) <= 1e-18


@pytest.mark.parametrize("b", [(1.7e-5, -2.3e-5, 3.1e-5), (-1.7e-5, 2.9e-5, 1.1e-5)])
@pytest.mark.parametrize("roll_rad", [1e-3, -1e-3])
def test_the_attitude_term_turns_the_tilted_momentum_back(b, roll_rad, turned):
    """A turn about axis 2 tilts the momentum along axis 1 of the orbit; the torque there opposes the tilt."""
    tilt = WHEEL[2] * (turned((0, 1, 0), np.degrees(roll_rad)).T @ (0.0, 0.0, 1.0))[0]
    torque = np.cross(wheel_axis_dipole(b, (0.0, 0.0, 0.0), 2.0 * roll_rad, 1e7, 4000.0), b)
    assert torque[0] == pytest.approx(-2.0 * 4000.0 * b[1] ** 2 * roll_rad)
    assert torque[0] * tilt < 0.0


@pytest.mark.parametrize("pitch_deg", [0.0, 60.0, 180.0, -120.0])
@pytest.mark.parametrize("lean_about", [(1, 0, 0), (0, 1, 0)])
def test_at_any_pitch_it_is_turned_back(turned, pitch_deg, lean_about):
    """With a field that has no first component, the torque is along axis 1 alone and reduces the lean."""
    c = turned((0, 0, 1), pitch_deg) @ turned(lean_about, 5.0)
    b, normal_body = (0.0, -2.3e-5, 3.1e-5), c[:, 2]
    rows = tuple(map(tuple, c.tolist()))
    torque = np.cross(wheel_axis_dipole(b, (0.0, 0.0, 0.0), twice_roll(rows), 1e7, 4000.0), b)
    assert torque[0] == pytest.approx(2.0 * 4000.0 * b[1] ** 2 * normal_body[0], abs=1e-18)
    assert torque @ normal_body >= 0.0


@given(fields, st.floats(-1e-2, 1e-2))
def test_the_other_two_coils_turn_the_body_about_the_wheel(b, gain):
    m = pitch_dipole(b, gain)
    assert m[2] == 0.0
    assert np.cross(m, b)[2] == pytest.approx(gain * (b[0] ** 2 + b[1] ** 2), abs=1e-25)


@given(st.floats(-pi + 1e-6, pi - 1e-6))
def test_pitch_is_the_turn_about_axis_3(angle_rad):
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    assert pitch(((c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0))) == pytest.approx(angle_rad, abs=1e-12)


@pytest.fixture(scope="module")
def run(bench, turned):
    orbit, c0 = bench.Orbit(), turned((1, 1, 1), 20.0)
    return bench.fly(
        dual_spin,
        bench.setpoint(k_w=1e7, k_a=4000.0),
        gains={"dual_spin": DualSpinGains(pitch_rad=0.5, stiffness=2.0)},
        orbit=orbit,
        body=bench.Body(inertia=INERTIA, wheel=WHEEL),
        c_body_from_orbit=c0,
        omega_body=orbit.rate_radps * c0[:, 2],
        seconds=4.0 * orbit.period_s,
        step_s=6.0,
    )


class TestFlights:
    @pytest.mark.long
    def test_the_wheel_comes_to_the_orbit_normal(self, run, bench):
        tilt_deg = run.axis_to_deg(2, bench.Orbit().c_orbit_from_eci(0.0)[2])
        assert tilt_deg[0] > 15.0
        assert tilt_deg[-1] < 1.2

    def test_the_body_turns_to_its_pitch_in_the_orbit_plane(self, run):
        """The gravity gradient holds it back by a fraction of a degree."""
        pitch_deg = np.degrees([pitch(tuple(map(tuple, c.tolist()))) for c in run.c_body_from_orbit[-1000:]])
        np.testing.assert_allclose(pitch_deg, np.degrees(0.5), atol=0.5)


@pytest.mark.parametrize("law", [dual_spin, pitch_wheel])
def test_at_a_quarter_turn_of_pitch_the_wheel_is_turned_to_the_normal_too(bench, turned, law):
    """Without rates and at their own pitch only the coil along the wheel acts, against the lean."""
    orbit, k_a = bench.Orbit(), 4000.0
    own = {
        "dual_spin": DualSpinGains(pitch_rad=0.5 * pi),
        "pitch_wheel": PitchWheelGains(pitch_rad=0.5 * pi, unload_per_s=0.0),
    }
    driven = Wheel((0.0, 0.0, 1.0), 2e-4, 2e-3, 0.12, 0.0, 0.0, tick_s=1.0, stale_ticks=10)
    settings = bench.config(bench.Body(INERTIA, WHEEL, driven=driven), 1.0, own)
    c = turned((0, 0, 1), 90.0) @ turned((1, 0, 0), 5.0)
    c_body_from_eci = c @ orbit.c_orbit_from_eci(700.0)
    inputs = bench.inputs_at(orbit, 700, 1.0, c_body_from_eci, orbit.rate_radps * c[:, 2], None)
    m = law(inputs.replace(wheel_nms=0.05), (), bench.setpoint(k_a=k_a), settings).m_body_am2
    assert m[2] == pytest.approx(-2.0 * k_a * inputs.b_body_t[1] * c[0, 2], rel=1e-9)
    assert abs(c[0, 2]) > 0.08


@pytest.mark.parametrize("wheel_nms", [0.0, -0.05])
def test_no_dipole_without_a_wheel_along_the_orbit_normal(bench, turned, wheel_nms):
    body = bench.Body(wheel=(0.0, 0.0, wheel_nms))
    run = bench.fly(
        dual_spin,
        bench.setpoint(k_w=1e7, k_a=4000.0),
        gains={"dual_spin": DualSpinGains()},
        body=body,
        c_body_from_orbit=turned((1, 1, 1), 20.0),
        seconds=20.0,
    )
    assert not run.m_body.any()
