"""Absolute rate, momentum and attitude as the laws see them, against the motion they come from."""

from dataclasses import replace

import numpy as np
import pytest

from fsw.core.algebra.quaternion import dcm
from fsw.core.laws.interface import FieldSample, Wheel
from fsw.core.laws.motion import motion
from fsw.core.laws.plan.riccati import resting_torque
from fsw.core.laws.table import LAWS

INERTIA = np.array([[1.3, 0.2, -0.1], [0.2, 2.4, 0.3], [-0.1, 0.3, 1.9]])


@pytest.fixture
def body(bench):
    return bench.Body(inertia=INERTIA, wheel=(0.01, -0.02, 0.3))


def test_the_motion_is_the_true_one(bench, body, turned):
    orbit, omega, c_body_from_eci = bench.Orbit(), np.array([0.03, -0.01, 0.02]), turned((3, -1, 2), 130.0)
    inputs = bench.inputs_at(orbit, 400, 5.0, c_body_from_eci, omega, FieldSample())
    moving = motion(inputs, bench.config(body, 5.0))
    np.testing.assert_allclose(moving.omega_body_radps, omega, atol=1e-15)
    np.testing.assert_allclose(moving.momentum_body_nms, INERTIA @ omega + (0.01, -0.02, 0.3), atol=1e-14)
    np.testing.assert_allclose(dcm(moving.q_body_from_eci), c_body_from_eci, atol=1e-14)


@pytest.mark.parametrize("missing", ["attitude", "orbit"])
def test_without_attitude_or_orbit_there_is_none(bench, body, missing):
    known = missing != "attitude"
    inputs = bench.inputs_at(bench.Orbit(), 9, 1.0, np.eye(3), np.zeros(3), FieldSample(), known=known)
    if missing == "orbit":
        inputs = inputs.replace(reference=None)
    assert motion(inputs, bench.config(body, 1.0)) is None


AXIS, DRIVEN_NMS = (0.48, -0.6, 0.64), 0.07
DRIVEN = Wheel(AXIS, 2e-4, 2e-3, 0.12, 0.0, 0.0, tick_s=1.0, stale_ticks=10)
OF_MOMENTUM = (
    "predictive",
    "two_step",
    "sliding_realisable",
    "sliding_rate",
    "spin_relay",
    "three_term",
    "reorientation",
    "stepped_precession",
    "nmpc_damping",
    "sdre",
    "lqr_disturbed",
)


def asked(bench, turned, law, settings, wheel_nms):
    """What a law demands in four ticks of a body that turns."""
    orbit, memory, demands = bench.Orbit(), (), []
    for tick in range(700, 704):
        c = turned((1, -2, 3), 25.0 + 0.1 * tick) @ orbit.c_orbit_from_eci(float(tick))
        inputs = bench.inputs_at(orbit, tick, 1.0, c, np.array([1e-3, 2e-3, -1e-3]), FieldSample())
        inputs = inputs.replace(ephemeris=bench.model_of(orbit), wheel_nms=wheel_nms)
        demand = LAWS[law].point(inputs, memory, bench.setpoint(k_w=1e6, k_a=1e3, spin_radps=0.02), settings)
        memory = demand.memory
        demands.append((*demand.m_body_am2, *(demand.impulse_body_nms or ()), *demand.memory))
    return np.array(demands)


@pytest.mark.parametrize("law", OF_MOMENTUM)
def test_a_driven_wheel_turns_the_body_as_one_of_constant_speed_does(bench, turned, law):
    """Schedules are made without one; without a report it is left out."""
    body = bench.Body(inertia=INERTIA, driven=DRIVEN, most_am2=5.0)
    gains = {law: LAWS[law].gains()} if LAWS[law].gains else {}
    driven = bench.config(body, 1.0, gains)
    if law in ("sdre", "lqr_disturbed"):
        driven = bench.scheduled(body, 1.0, law)
    constant_nms = tuple(DRIVEN_NMS * part for part in AXIS)
    schedules = {
        name: replace(
            table,
            problem=replace(
                table.problem,
                resting_nm=resting_torque(driven.inertia_kgm2, constant_nms, bench.Orbit().rate_radps),
            ),
        )
        for name, table in driven.schedules.items()
    }
    constant = replace(driven, wheel=None, wheel_body_nms=constant_nms, schedules=schedules)
    known = asked(bench, turned, law, driven, DRIVEN_NMS)
    np.testing.assert_allclose(known, asked(bench, turned, law, constant, None), rtol=1e-6, atol=1e-12)
    unknown = asked(bench, turned, law, driven, None)
    assert not np.allclose(known, unknown, rtol=1e-6, atol=1e-12)
    np.testing.assert_array_equal(unknown, asked(bench, turned, law, replace(driven, wheel=None), None))
