"""The law of six gains: the laws that it contains, energy, and what yaw and springs are worth."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.core.laws.dual_spin import wheel_axis_dipole
from fsw.core.laws.roll_yaw import RollYaw
from fsw.core.laws.six_gain import SixGainGains, six_gain, six_gain_dipole

B = (1.7e-5, -2.3e-5, 3.1e-5)
small = st.floats(-0.01, 0.01, allow_subnormal=False)
motions = st.builds(RollYaw, small, small, small, small)


def test_the_equation_by_hand():
    gains = SixGainGains(k2=0.5, k4=2.0, k5=0.25, k6=3.0)
    m = six_gain_dipole((2e-5, 3e-5, 5e-5), RollYaw(0.1, 0.2, 0.01, 0.02), 1000.0, 1e4, gains)
    # 1000 (3e-6 + 0.5 4e-6) - 1e4 (2e-7 - 2 6e-7) - 250 (2e-6 - 3 6e-6)
    assert m == pytest.approx((0.0, 0.0, 5e-3 + 1e-2 + 4e-3))


@given(motions)
def test_with_k2_and_k5_zero_and_k4_one_it_is_the_law_of_dual_spin(motion):
    omega = (motion.yaw_rate, motion.roll_rate, 0.0)
    theirs = wheel_axis_dipole(B, omega, 2.0 * motion.roll, 1e6, 500.0)
    ours = six_gain_dipole(B, motion, 1000.0, 1e6, SixGainGains(k2=0.0, k4=1.0, k5=0.0))
    assert ours == pytest.approx(theirs, rel=1e-12, abs=1e-18)


@given(motions)
def test_with_k4_one_the_rate_part_only_takes_energy_away(motion):
    m = six_gain_dipole(B, motion._replace(roll=0.0, yaw=0.0), 0.0, 1e6, SixGainGains())
    assert np.dot(np.cross(m, B), (motion.yaw_rate, motion.roll_rate, 0.0)) <= 1e-20


@given(motions)
def test_with_k2_one_the_angle_part_only_straightens_the_momentum(motion):
    """d(roll^2 + yaw^2)/dt = -2 m3 (b2 roll + b1 yaw) / h."""
    m3 = six_gain_dipole(B, motion, 1000.0, 0.0, SixGainGains())[2]
    assert m3 * (B[1] * motion.roll + B[0] * motion.yaw) >= 0.0


@pytest.mark.long
@given(motions, motions)
def test_the_spring_has_a_potential(one, other):
    """Its stiffness is symmetric: what a turn does to the torque about another axis, that one does to it."""

    def torque(motion):
        springs, none = SixGainGains(k5=0.5), SixGainGains(k5=0.0)
        m3 = six_gain_dipole(B, motion, 1e3, 0.0, springs)[2] - six_gain_dipole(B, motion, 1e3, 0.0, none)[2]
        return np.cross((0.0, 0.0, m3), B)[:2]

    work, back = torque(one) @ (other.yaw, other.roll), torque(other) @ (one.yaw, one.roll)
    assert work == pytest.approx(back, rel=1e-9, abs=1e-18)


@pytest.mark.parametrize("name", ["k2", "k4", "k5", "k6"])
@pytest.mark.parametrize("value", [-10.1, 10.1, float("nan")])
def test_a_gain_out_of_range_is_named(name, value):
    with pytest.raises(ValueError, match=f"{name} must be -10 to 10"):
        SixGainGains(**{name: value})


def test_of_a_turned_body_the_wheel_is_held_and_the_pitch(bench, turned):
    """Roll and yaw are half of S; k1 = 2 k_a; the other coils give -2 k_a sin pitch - k_w Omega3."""
    orbit, c, relative = bench.Orbit(), turned((1, -2, 3), 12.0), np.array([2e-4, -3e-4, 5e-4])
    motion = c @ orbit.c_orbit_from_eci(700.0), relative + orbit.rate_radps * c[:, 2], None
    inputs = bench.inputs_at(orbit, 700, 1.0, *motion)
    own = {"six_gain": SixGainGains(k2=0.5, k4=2.0, k5=0.25, k6=3.0)}
    settings = bench.config(bench.Body(wheel=(0.0, 0.0, 0.05)), 1.0, own)
    m = six_gain(inputs, (), bench.setpoint(k_w=1e7, k_a=4000.0), settings).m_body_am2
    yaw, roll = 0.5 * (c[1, 2] - c[2, 1]), 0.5 * (c[2, 0] - c[0, 2])
    b1, b2, _ = inputs.b_body_t
    m3 = 8000.0 * (b2 * roll + 0.5 * b1 * yaw - 0.25 * (b1 * roll - 3.0 * b2 * yaw))
    m3 -= 1e7 * (b1 * relative[1] - 2.0 * b2 * relative[0])
    turning = -8000.0 * np.sin(np.arctan2(c[0, 1] - c[1, 0], c[0, 0] + c[1, 1])) - 1e7 * relative[2]
    assert m == pytest.approx((turning * b2, -turning * b1, m3), rel=1e-6)


class TestFlights:
    @pytest.mark.long
    def test_with_yaw_the_wheel_comes_to_the_normal_faster_than_without(self, lean):
        both, roll_alone = (lean(six_gain, gains=SixGainGains(k2=k2)) for k2 in (1.0, 0.0))
        assert both.most_deg(0) > 9.0
        assert both.lean_deg[-1] < 1.2
        assert roll_alone.lean_deg[-1] > 2.0 * both.lean_deg[-1]

    @pytest.mark.long
    def test_without_yaw_at_all_it_still_comes_to_the_normal(self, lean):
        """As with a horizon sensor: yaw becomes roll a quarter of an orbit later."""
        run = lean(six_gain, gains=SixGainGains(k2=0.0, k5=0.5, k6=0.0))
        assert run.most_deg(1) < 0.5 * run.most_deg(0)

    def test_nutation_is_damped(self, lean):
        run = lean(six_gain, gains=SixGainGains(), angle_deg=0.01, relative=(1e-3, 0.0, 0.0), orbits=1.0)
        swing = np.linalg.norm(run.run.relative_body[:, :2], axis=1)
        assert swing[-100:].max() < 0.1 * swing[:30].max()
