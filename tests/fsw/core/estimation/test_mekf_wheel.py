"""The filter of a satellite with a driven wheel: its motion beside the plant's, its noise, its matrices."""

from math import radians

import numpy as np
import pytest
from filter_steps import predict

from fsw.core.algebra.vector import ZERO
from fsw.core.estimation.mekf import correct, start
from fsw.core.estimation.mekf_config import FilterStep, WheelMotion, mekf_config
from fsw.core.estimation.parameters import Prior
from fsw.core.packing import pack
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import TorqueFunction
from sim.plant.dynamics.wheel import SpinningWheel
from sim.plant.environment.surroundings import Surroundings
from sim.plant.wheel_config import WheelConfig

AXIS = (0.48, -0.6, 0.64)
INERTIA = ((1.02, 0.07, -0.05), (0.07, 1.85, 0.11), (-0.05, 0.11, 1.45))
STILL = Surroundings((1.0, 0.0, 0.0), 0.0, ZERO)
TICK_S = 0.5


def tuned(wheel_body_nms=ZERO, priors=None):
    return mekf_config(
        INERTIA,
        TICK_S,
        priors or {},
        wheel_body_nms=wheel_body_nms,
        magnetometer_sigma_t=2e-7,
        sun_sigma_rad=radians(0.5),
        attitude_sigma_rad=radians(5.0),
        rate_sigma_radps=radians(2.0),
        torque_noise_nm_rts=1e-7,
        gate_nis=16.27,
    )


def along(size):
    return tuple(size * part for part in AXIS)


def test_a_steady_wheel_is_one_of_constant_momentum():
    driven, constant = FilterStep(tuned(), 1, WheelMotion(along(0.3))), FilterStep(tuned(along(0.3)), 1)
    assert driven.rotor == constant.rotor
    assert driven.wheel_kick_radps == driven.reaction_body_nm == ZERO
    np.testing.assert_allclose(driven.constant, constant.constant, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(driven.process_noise, constant.process_noise)


def test_the_momentum_comes_on_top_of_a_constant_one():
    step = FilterStep(tuned(along(0.1)), 1, WheelMotion(along(0.3)))
    assert step.rotor.wheel_body_nms == pytest.approx(along(0.4))


def test_what_a_coil_has_done_corrects_a_fast_body_as_one_with_the_wheels_momentum():
    """The age of the samples is an error along the motion, which the momentum bends."""
    late, momentum_nms = {"delay_s": Prior((0.5, 0.6), (0.0, 0.0))}, along(0.3)
    error, uncertainty = np.full(8, 2e-3), np.diag(np.full(8, 1e-6))
    constant, driven, without = (
        start((0.5, -0.5, 0.5, 0.5), (0.2, -0.3, 0.5), tuned(priors=late)) for _ in range(3)
    )
    correct(constant, error, uncertainty, tuned(momentum_nms, late))
    correct(driven, error, uncertainty, tuned(priors=late), momentum_nms)
    correct(without, error, uncertainty, tuned(priors=late))
    assert pack(driven) == pack(constant)
    assert np.abs(driven.covariance - without.covariance).max() > 1e-4 * np.abs(driven.covariance).max()


@pytest.mark.parametrize("driven_am2", [ZERO, (0.3, 0.0, -0.2)], ids=["alone", "beside coils"])
def test_what_is_in_doubt_is_noise_of_the_rate_along_its_kick(driven_am2):
    estimate = start((0.5, -0.5, 0.5, 0.5), (2e-3, -3e-3, 5e-3), tuned())
    sure, doubted = (
        predict(estimate, STILL.e_eci, (1e-5, 2e-5, -3e-5), 0.0, driven_am2, tuned(), ZERO, motion)
        for motion in (WheelMotion(along(0.3)), WheelMotion(along(0.3), doubted_nms=along(0.2)))
    )
    kick = np.linalg.inv(INERTIA) @ along(0.2)
    added = doubted.covariance - sure.covariance
    np.testing.assert_allclose(added[3:6, 3:6], np.outer(kick, kick), rtol=1e-9)
    assert not added[0:3].any()


def test_the_pieces_of_a_tick_add_the_doubt_of_a_tick():
    motion = WheelMotion(along(0.3), doubted_nms=along(2e-4))
    whole, piece = FilterStep(tuned(), 1, motion), FilterStep(tuned(), 9, motion)
    assert piece.wheel_kick_radps == pytest.approx([part / 3.0 for part in whole.wheel_kick_radps])
    np.testing.assert_allclose(9.0 * (piece.constant - np.eye(6)), whole.constant - np.eye(6), atol=1e-15)


@pytest.mark.long
@pytest.mark.parametrize("motor_nm", [0.0, 2e-3, -1.5e-3])
def test_by_measured_speeds_alone_it_turns_as_the_plant(motor_nm):
    """Friction, lag and all: the filter knows momentum and change, and no model of the wheel."""
    config = WheelConfig(
        AXIS, 4e-3, 0.02, 0.9, viscous_nms=2e-6, coulomb_nm=1e-4, time_constant_s=0.4, momentum_nms=0.05
    )
    motion = Motion((0.5, -0.5, 0.5, 0.5), (2e-3, -3e-3, 5e-3))
    wheel, body = SpinningWheel(config, motion.omega_body_radps), RigidBody(config.rest_of(INERTIA))
    estimate = start(motion.q_body_from_eci, motion.omega_body_radps, tuned())
    before = wheel.relative_nms(motion.omega_body_radps)
    for _ in range(60):
        for _ in range(10):
            driven = wheel.advance(motor_nm, motion.omega_body_radps, 0.1 * TICK_S)
            torque = TorqueFunction(lambda q, omega, around, r=driven.reaction_nm: r)
            motion = body.step(motion, torque, 0.1 * TICK_S, STILL, STILL, STILL, driven=driven)
        after = wheel.relative_nms(motion.omega_body_radps)
        moving = WheelMotion(along(0.5 * (before + after)), along((before - after) / TICK_S))
        estimate = predict(estimate, STILL.e_eci, ZERO, 0.0, ZERO, tuned(), ZERO, moving)
        before = after
    assert np.abs(np.array(motion.omega_body_radps)).max() > 5e-3
    assert estimate.omega_body_radps == pytest.approx(motion.omega_body_radps, abs=2e-6)
    assert estimate.q_body_from_eci == pytest.approx(motion.q_body_from_eci, abs=2e-5)
