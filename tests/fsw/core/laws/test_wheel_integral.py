"""The integral part of a pitch wheel's law: signs, memory, and what it leaves of a constant torque."""

import numpy as np
import pytest

from fsw.core.laws.wheel_integral import integral_dipole, wheel_integral, wheel_integral_far

B = (1.7e-5, -2.3e-5, 3.1e-5)
TORQUE_NM = (1e-6, -1.5e-6, 1e-6)


def test_each_integral_gives_a_torque_against_its_own_turn():
    """Over the orbit the products b1 b2 have no mean; the squares have."""
    for axis, other in ((0, 1), (1, 0)):
        integral = tuple(5.0 if i == axis else 0.0 for i in range(3))
        m = integral_dipole(B, integral, 2.0)
        assert m[:2] == pytest.approx((0.0, 0.0))
        assert np.cross(m, B)[axis] == pytest.approx(-2.0 * 2.0 * 5.0 * B[other] ** 2)


def test_the_integral_of_the_pitch_is_answered_by_the_other_two_coils():
    m = integral_dipole(B, (0.0, 0.0, 5.0), 2.0)
    assert m[2] == 0.0
    assert np.cross(m, B)[2] == pytest.approx(-2.0 * 2.0 * 5.0 * (B[0] ** 2 + B[1] ** 2))


def _asked(bench, turned, law, memory=(), most_am2=1e3, known=True, k_i=2.0):
    orbit, c = bench.Orbit(), turned((1, 2, 3), 2.0)
    inputs = bench.inputs_at(
        orbit, 700, 4.0, c @ orbit.c_orbit_from_eci(2800.0), orbit.rate_radps * c[:, 2], None, known=known
    )
    settings = bench.config(bench.Body(wheel=(0.0, 0.0, 0.05), most_am2=most_am2), 4.0)
    return law(inputs, memory, bench.setpoint(k_w=1e7, k_a=4000.0, k_i=k_i), settings)


def test_yaw_roll_and_pitch_are_summed_in_this_order(bench, turned):
    turn = np.radians(2.0) * np.array([1, 2, 3]) / np.sqrt(14.0)
    memory = _asked(bench, turned, wheel_integral, (1.0, 2.0, 3.0)).memory
    np.testing.assert_allclose(memory, (1.0, 2.0, 3.0) + 4.0 * turn, rtol=2e-3)


def test_far_from_the_goal_and_without_attitude_the_integral_rests(bench, turned):
    memory = (1.0, 2.0, 3.0)
    assert _asked(bench, turned, wheel_integral_far, memory).memory == memory
    blind = _asked(bench, turned, wheel_integral, memory, known=False)
    assert blind.memory == memory
    assert blind.m_body_am2 == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("law", [wheel_integral, wheel_integral_far])
def test_the_integral_stops_at_what_the_coils_can_give(bench, turned, law):
    """Far from the goal too: k_i may have been raised since it grew."""
    memory = _asked(bench, turned, law, (3e3, 2e3, 1e3), most_am2=0.01).memory
    assert np.linalg.norm(memory) < 200.0
    np.testing.assert_allclose(np.array(memory) / memory[2], (3.0, 2.0, 1.0), rtol=1e-3)


@pytest.mark.long
def test_it_takes_the_mean_of_a_constant_torque_away(lean):
    """Without it T2 / (h w0) of roll and T1 / (h w0) of yaw are left, and the pitch hangs off."""
    flight = {"angle_deg": 0.01, "orbits": 6.0, "step_s": 12.0, "torque": TORQUE_NM}
    without, with_it = (lean(wheel_integral, k_i=k_i, **flight).mean_angles_deg() for k_i in (0.0, 3.0))
    left = np.degrees(np.array(TORQUE_NM) / 0.05 / 1.0382e-3)
    assert without[:2] == pytest.approx(left[:2], rel=0.25)
    assert abs(with_it[0]) < 0.5 * abs(without[0])
    assert abs(with_it[1]) < 0.1 * abs(without[1])
    assert abs(with_it[2]) < 0.01 * abs(without[2])
