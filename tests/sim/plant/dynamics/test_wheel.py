"""The wheel's own dynamics: motor with lag, friction, limit, and what the body feels of them."""

from math import exp

import numpy as np
import pytest

from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import TorqueFunction
from sim.plant.dynamics.wheel import SpinningWheel
from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import ZERO, matrix
from sim.plant.wheel_config import WheelConfig

AXIS = (0.48, -0.6, 0.64)
INERTIA = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
STILL = Surroundings((1.0, 0.0, 0.0), 0.0, ZERO)


def wheel(**parts):
    values = {"inertia_kgm2": 4e-3, "max_torque_nm": 0.02, "max_momentum_nms": 0.9} | parts
    return WheelConfig(AXIS, **values)


def reaction(driven):
    return TorqueFunction(lambda q, omega, around: driven.reaction_nm)


def flown(config, asked_nm, seconds, step_s=0.25, omega=(0.02, -0.03, 0.05), motion=None):
    """SpinningWheel and body without other torques: the wheel, and rows of (motion, relative momentum)."""
    motion = motion or Motion((0.5, -0.5, 0.5, 0.5), omega)
    unit, body = SpinningWheel(config, motion.omega_body_radps), RigidBody(config.rest_of(INERTIA))
    rows = [(motion, unit.relative_nms(motion.omega_body_radps))]
    for _ in range(round(seconds / step_s)):
        driven = unit.advance(asked_nm, motion.omega_body_radps, step_s)
        motion = body.step(motion, reaction(driven), step_s, STILL, STILL, STILL, driven=driven)
        rows.append((motion, unit.relative_nms(motion.omega_body_radps)))
    return rows


def momentum_eci(motion, relative_nms):
    """J omega + h w with the whole inertia and the relative momentum, in inertial axes."""
    body = np.array(INERTIA) @ motion.omega_body_radps + relative_nms * np.array(AXIS)
    return np.array(matrix(motion.q_body_from_eci)).T @ body


@pytest.mark.parametrize("asked_nm", [0.0, 0.015, -0.02])
def test_what_the_wheel_gains_the_body_loses(asked_nm):
    config = wheel(viscous_nms=2e-5, coulomb_nm=1e-3, time_constant_s=0.7, momentum_nms=0.3)
    rows = flown(config, asked_nm, 30.0, step_s=0.05)
    first, last = momentum_eci(*rows[0]), momentum_eci(*rows[-1])
    assert np.linalg.norm(first) > 0.2
    assert abs(rows[-1][1] - rows[0][1]) > 1e-3
    assert last == pytest.approx(first, abs=2e-9)


def test_a_torque_about_a_principal_axis_turns_the_body_the_other_way():
    """By hand: J' domega = -T t about the axis, dh = T t, of a sphere of 2 kg m^2."""
    config = WheelConfig((0.0, 0.0, 1.0), inertia_kgm2=0.5, max_torque_nm=0.1, max_momentum_nms=1.0)
    unit = SpinningWheel(config, ZERO)
    sphere = ((2.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 2.0))
    driven = unit.advance(0.03, ZERO, 2.0)
    body, start = RigidBody(config.rest_of(sphere)), Motion((1.0, 0.0, 0.0, 0.0), ZERO)
    motion = body.step(start, reaction(driven), 2.0, STILL, STILL, STILL, driven=driven)
    assert driven.reaction_nm == pytest.approx((0.0, 0.0, -0.03))
    assert motion.omega_body_radps == pytest.approx((0.0, 0.0, -0.06 / 1.5))
    assert unit.relative_nms(motion.omega_body_radps) == pytest.approx(0.06 + 0.5 * 0.04)


def test_the_motor_follows_with_its_time_constant():
    unit = SpinningWheel(wheel(time_constant_s=2.0), ZERO)
    for _ in range(6):
        unit.advance(0.01, ZERO, 0.5)
    whole = 0.01 * (3.0 - 2.0 * (1.0 - exp(-1.5)))
    assert unit.relative_nms(ZERO) == pytest.approx(whole, rel=1e-12)


def test_the_motor_gives_no_more_than_it_can_whatever_is_asked():
    unit = SpinningWheel(wheel(torque_scale=1.2), ZERO)
    unit.advance(0.01, ZERO, 1.0)
    assert unit.relative_nms(ZERO) == pytest.approx(0.012)
    unit.advance(5.0, ZERO, 1.0)
    assert unit.relative_nms(ZERO) == pytest.approx(0.032)


def test_coasting_it_slows_down_by_its_friction():
    """dW/dt = -(c W + T_c) / J_w far above W_0, so that it stops at a time given by a logarithm."""
    config = wheel(viscous_nms=1e-4, coulomb_nm=5e-3, momentum_nms=0.8)
    unit = SpinningWheel(config, ZERO)
    for _ in range(200):
        unit.advance(0.0, ZERO, 0.1)
    decay = exp(-1e-4 * 20.0 / 4e-3)
    expected = 4e-3 * (200.0 * decay - 5e-3 / 1e-4 * (1.0 - decay))
    assert unit.relative_nms(ZERO) == pytest.approx(expected, rel=1e-4)


def test_friction_stops_the_wheel_and_does_not_turn_it_back():
    unit = SpinningWheel(wheel(coulomb_nm=5e-3, momentum_nms=0.02), ZERO)
    momenta = [unit.advance(0.0, ZERO, 0.1) and unit.relative_nms(ZERO) for _ in range(300)]
    assert momenta[-1] == pytest.approx(0.0, abs=1e-6)
    assert min(momenta) > -1e-6


def test_friction_far_beyond_what_a_step_resolves_only_stops_it():
    unit = SpinningWheel(wheel(coulomb_nm=0.019, viscous_nms=0.01, momentum_nms=0.01), ZERO)
    for _ in range(5):
        unit.advance(0.0, ZERO, 1.0)
        assert 0.0 <= unit.relative_nms(ZERO) < 0.01


def test_friction_is_that_of_the_speed_against_the_body():
    turning = tuple(50.0 * part for part in AXIS)
    unit = SpinningWheel(wheel(viscous_nms=1e-4), turning)
    assert unit.relative_nms(turning) == pytest.approx(0.0)
    assert unit.advance(0.0, turning, 1.0).reaction_nm == pytest.approx(ZERO, abs=1e-15)
    assert max(map(abs, unit.advance(0.0, ZERO, 1.0).reaction_nm)) > 1e-3


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_at_its_limit_the_motor_can_only_slow_it_down(sign):
    unit = SpinningWheel(wheel(momentum_nms=sign * 0.89), ZERO)
    step = unit.advance(sign * 0.02, ZERO, 1.0)
    assert unit.relative_nms(ZERO) == pytest.approx(sign * 0.9)
    assert np.dot(step.reaction_nm, AXIS) == pytest.approx(-sign * 0.01)
    assert unit.advance(sign * 0.02, ZERO, 1.0).reaction_nm == pytest.approx(ZERO, abs=1e-15)
    unit.advance(-sign * 0.02, ZERO, 1.0)
    assert unit.relative_nms(ZERO) == pytest.approx(sign * 0.88)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_beyond_its_limit_as_when_the_body_turns_against_it_nothing_stops_it_at_once(sign):
    unit, turning = SpinningWheel(wheel(momentum_nms=sign * 0.9), ZERO), tuple(-sign * 3.0 * a for a in AXIS)
    beyond = unit.relative_nms(turning)
    assert abs(beyond) == pytest.approx(0.912)
    assert unit.advance(sign * 0.02, turning, 1.0).reaction_nm == pytest.approx(ZERO, abs=1e-15)
    assert unit.relative_nms(turning) == pytest.approx(beyond)


def test_the_inertia_without_the_wheel_is_that_of_the_rest():
    rest = np.array(wheel().rest_of(INERTIA))
    assert rest == pytest.approx(np.array(INERTIA) - 4e-3 * np.outer(AXIS, AXIS), rel=1e-14)
    assert (rest == rest.T).all()


@pytest.mark.parametrize(
    "wrong",
    [
        {"inertia_kgm2": 0.0},
        {"max_torque_nm": -1.0},
        {"max_momentum_nms": 0.0},
        {"viscous_nms": -1e-9},
        {"time_constant_s": -1.0},
        {"momentum_nms": -0.95},
    ],
)
def test_what_no_wheel_is_like_is_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        wheel(**wrong)


def test_an_axis_that_is_no_unit_vector_is_refused():
    with pytest.raises(ValueError, match="axis_body"):
        WheelConfig((0.6, 0.6, 0.6), 1e-3, 0.1, 0.1)
