"""The sliding relay of a pitch wheel: surface, layer, and the decay that the surface gives over the poles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.roll_yaw import RollYaw
from fsw.core.laws.wheel_relay import WheelRelayGains, relay_dipole, surface, wheel_relay

B = (1.7e-5, -2.3e-5, 3.1e-5)
J1, J2, H = 1.9, 1.95, 0.05
small = st.floats(-0.01, 0.01, allow_subnormal=False)
motions = st.builds(RollYaw, small, small, small, small)


def test_the_surface_by_hand():
    s = surface((3e-5, 4e-5, 1e-5), RollYaw(0.1, 0.2, 0.001, 0.002), 0.5, 100.0)
    # 100 (0.6 0.001 - 0.8 0.002) + (0.3 - 0.8) 0.1 - (0.6 + 0.4) 0.2
    assert s == pytest.approx(-0.1 - 0.05 - 0.2)


@given(motions)
def test_the_dipole_drives_the_surface_to_zero_in_precession_and_in_nutation(motion):
    """By the momentum that a pulse of m3 gives, to the lean and to the rates."""
    s = surface(B, motion, 0.2, 100.0)
    torque = np.cross(relay_dipole(s, 2.0, 1e-4), B)
    leaned = motion._replace(roll=motion.roll + torque[0] / H, yaw=motion.yaw - torque[1] / H)
    swung = motion._replace(
        roll_rate=motion.roll_rate + torque[1] / J2, yaw_rate=motion.yaw_rate + torque[0] / J1
    )
    for after in (leaned, swung):
        assert (surface(B, after, 0.2, 100.0) - s) * s <= 0.0
    assert torque.any() == (abs(s) >= 1e-4)


@pytest.mark.parametrize(("s", "m3"), [(0.011, -2.0), (0.009, 0.0), (-0.009, 0.0), (-0.011, 2.0)])
def test_inside_the_layer_the_coil_is_off(s, m3):
    assert relay_dipole(s, 2.0, 0.01) == (0.0, 0.0, m3)


def test_without_a_layer_nothing_is_asked_for_on_the_surface():
    assert relay_dipole(0.0, 2.0, 0.0) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("gains", "named"),
    [
        ({"dipole_am2": 0.0}, "dipole_am2"),
        ({"lead": -0.1}, "lead"),
        ({"rate_s": -1.0}, "rate_s"),
        ({"layer_rad": 1.1}, "layer_rad"),
        ({"layer_rad": float("nan")}, "layer_rad"),
    ],
)
def test_a_gain_out_of_range_is_named(gains, named):
    with pytest.raises(ValueError, match=named):
        WheelRelayGains(**gains)


@pytest.fixture(scope="module")
def polar(lean):
    gains = WheelRelayGains(dipole_am2=2.0, lead=0.1, rate_s=100.0, layer_rad=0.003)
    return lean(wheel_relay, gains=gains, inclination_deg=90.0, step_s=4.0, orbits=2.0)


class TestFlights:
    @pytest.mark.long
    def test_on_the_surface_the_lean_falls_as_the_field_turns(self, polar):
        """exp(-4 pi t) an orbit at most is left, t = lead / (1 + rate_s w0)."""
        left = np.exp(-4.0 * np.pi * 0.1 / (1.0 + 100.0 * 1.038e-3))
        early = polar.orbit_ticks // 4
        assert 3.0 < polar.lean_deg[early] < 10.0
        assert polar.lean_deg[early + polar.orbit_ticks] < 1.05 * left * polar.lean_deg[early]

    def test_the_coil_along_the_wheel_is_on_or_off(self, polar):
        assert set(np.unique(polar.run.m_body[:, 2])) == {-2.0, 0.0, 2.0}

    def test_on_a_polar_orbit_the_other_coils_leave_the_wheel_alone(self, polar, bench):
        """The field lies in the orbit plane, and so their torque is along the normal; in the second orbit."""
        orbit, run = bench.Orbit(inclination_deg=90.0), polar.run
        b = np.einsum("tij,tj->ti", run.c_body_from_eci, orbit.b_eci_t(run.t_s))[polar.orbit_ticks :]
        m = run.m_body[polar.orbit_ticks :]
        by_two = np.cross(m * (1.0, 1.0, 0.0), b)
        across, about = np.linalg.norm(by_two[:, :2], axis=1), np.abs(by_two[:, 2])
        assert about.max() > 0.0
        assert across.max() < 0.2 * about.max()
        assert across.max() < 0.05 * 2.0 * np.linalg.norm(b, axis=1).min()
