"""Roll, yaw and pitch of the laws with a wheel, against turns that are known."""

import numpy as np
import pytest

from fsw.core.laws.roll_yaw import can_hold, pitch_holding_dipole, roll_yaw


@pytest.fixture
def seen(bench, turned):
    """What a law sees at a small turn and a rate relative to the orbital frame."""

    def inputs(turn_rad, rate_radps=(0.0, 0.0, 0.0), known=True):
        orbit = bench.Orbit()
        c = turned(turn_rad, np.degrees(np.linalg.norm(turn_rad)))
        motion = c @ orbit.c_orbit_from_eci(700.0), np.array(rate_radps) + orbit.rate_radps * c[:, 2], None
        return bench.inputs_at(orbit, 700, 1.0, *motion, known=known)

    return inputs


def test_roll_is_about_axis_2_and_yaw_about_axis_1(seen):
    motion = roll_yaw(seen((3e-4, -5e-4, 7e-4), (1e-4, 2e-4, -3e-4)))
    assert motion.yaw == pytest.approx(3e-4, rel=1e-3)
    assert motion.roll == pytest.approx(-5e-4, rel=1e-3)
    assert (motion.yaw_rate, motion.roll_rate) == pytest.approx((1e-4, 2e-4), rel=1e-6)


@pytest.mark.parametrize(("turn", "rate"), [(1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-4), (0.0, -1e-4)])
def test_the_pitch_is_turned_back_and_its_rate_braked(seen, bench, turn, rate):
    inputs = seen((0.0, 0.0, turn), (0.0, 0.0, rate)) if turn else seen((1e-9, 0, 0), (0.0, 0.0, rate))
    m = pitch_holding_dipole(inputs, bench.setpoint(k_w=2e6, k_a=900.0))
    b = np.array(inputs.b_body_t)
    wanted = -(1800.0 * turn + 2e6 * rate) * (b[0] ** 2 + b[1] ** 2)
    assert np.cross(m, b)[2] == pytest.approx(wanted, rel=1e-4)
    assert m[2] == 0.0


def test_nothing_can_be_held_without_attitude_or_wheel(seen, bench):
    def settings(wheel):
        return bench.config(bench.Body(wheel=(0.0, 0.0, wheel)), 1.0)

    known, unknown = seen((1e-3, 0.0, 0.0)), seen((1e-3, 0.0, 0.0), known=False)
    assert can_hold(known, settings(0.05))
    assert not can_hold(known, settings(0.0))
    assert not can_hold(known, settings(-0.05))
    assert not can_hold(unknown, settings(0.05))
