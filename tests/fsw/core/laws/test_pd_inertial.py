"""Inertial PD: the error is that from the target, and the body stays there while the orbit turns."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fsw.core.algebra.quaternion import dcm, from_dcm, multiply
from fsw.core.laws.pd import attitude_error, pd_dipole
from fsw.core.laws.pd_inertial import InertialGains, from_target, inertial, inertial_far

TARGET = InertialGains(0.1, -0.3, 0.2)
K_W, K_A = 9.55e6, 3160.0
INERTIA = np.diag([1.6, 1.8, 1.7])


def test_the_target_is_a_unit_quaternion_of_positive_scalar_part():
    q = TARGET.q_target_from_eci
    assert np.linalg.norm(q) == pytest.approx(1.0)
    assert q[0] > 0.0


def test_at_the_target_nothing_is_off_and_a_turn_from_it_is_the_turn():
    q_target = TARGET.q_target_from_eci
    assert from_target(q_target, q_target) == pytest.approx((1.0, 0.0, 0.0, 0.0))
    turn = (0.96, 0.0, 0.28, 0.0)
    assert from_target(multiply(q_target, turn), q_target) == pytest.approx(turn)


@pytest.fixture
def inputs(bench, turned):
    orbit = bench.Orbit()
    c_body_from_eci = turned((1, -2, 3), 25.0)
    return bench.inputs_at(orbit, 700, 1.0, c_body_from_eci, np.array([1e-3, 2e-3, -1e-3]), None)


def test_the_dipole_is_that_of_pd_by_absolute_rate_and_the_turn_from_the_target(bench, inputs, turned):
    point, own = bench.setpoint(k_w=K_W, k_a=K_A), {"pd_inertial": TARGET}
    demand = inertial(inputs, (), point, bench.config(bench.Body(INERTIA), 1.0, own))
    c_target = np.array(dcm(TARGET.q_target_from_eci))
    error = attitude_error(tuple(map(tuple, (turned((1, -2, 3), 25.0) @ c_target.T).tolist())))
    expected = pd_dipole(inputs.b_body_t, (1e-3, 2e-3, -1e-3), error, K_W, K_A)
    assert demand.m_body_am2 == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("law", [inertial, inertial_far])
@pytest.mark.parametrize("missing", ["orbit", "attitude"])
def test_without_orbit_or_attitude_nothing_is_asked_for(bench, inputs, law, missing):
    blind = inputs.replace(reference=None)
    if missing == "attitude":
        blind = inputs.replace(attitude=inputs.attitude.invalid())
    point = bench.setpoint(k_w=K_W, k_a=K_A)
    settings = bench.config(bench.Body(INERTIA), 1.0, {"pd_inertial": TARGET})
    assert law(blind, (), point, settings).m_body_am2 == (0.0, 0.0, 0.0)
    assert any(law(inputs, (), point, settings).m_body_am2)


def test_half_a_turn_off_the_far_form_turns_and_the_near_form_rests(bench, turned):
    c_target = np.array(dcm(TARGET.q_target_from_eci))
    over = bench.inputs_at(bench.Orbit(), 700, 1.0, turned((0, 1, 0), 180.0) @ c_target, np.zeros(3), None)
    point = bench.setpoint(k_w=K_W, k_a=K_A)
    settings = bench.config(bench.Body(INERTIA), 1.0, {"pd_inertial": TARGET})
    assert np.linalg.norm(inertial(over, (), point, settings).m_body_am2) < 1e-9
    assert np.linalg.norm(inertial_far(over, (), point, settings).m_body_am2) > 1e-3


@pytest.mark.long
@pytest.mark.parametrize(("gravity", "limit_deg"), [(False, 0.3), (True, 12.0)])
def test_it_comes_to_an_inertial_target_and_stays(bench, turned, gravity, limit_deg):
    """Four orbits from 40 deg off; the gravity gradient is what is left."""
    orbit, c_target = bench.Orbit(), np.array(dcm(TARGET.q_target_from_eci))
    run = bench.fly(
        inertial,
        bench.setpoint(k_w=K_W, k_a=K_A),
        gains={"pd_inertial": TARGET},
        orbit=orbit,
        body=bench.Body(INERTIA, most_am2=5.0, gravity=gravity),
        c_body_from_orbit=turned((3, 1, 2), 40.0) @ c_target @ orbit.c_orbit_from_eci(0.0).T,
        seconds=4.0 * orbit.period_s,
        step_s=10.0,
    )
    off = Rotation.from_matrix(run.c_body_from_eci @ c_target.T).magnitude()
    assert np.degrees(off[0]) == pytest.approx(40.0)
    assert np.degrees(off[-600:].max()) < limit_deg
    assert from_dcm(tuple(map(tuple, run.c_body_from_orbit[-1].tolist())))[0] < 0.99


@pytest.mark.parametrize("target", [(0.9, 0.9, 0.0), (0.9, 0.0, -0.9), (0.0, -0.9, 0.9)])
def test_a_target_that_is_no_rotation_is_refused(target):
    with pytest.raises(ValueError, match="unit quaternion"):
        InertialGains(*target)
