"""Absolute rate, momentum and attitude as the laws see them, against the motion they come from."""

import numpy as np
import pytest

from fsw.core.algebra.quaternion import dcm
from fsw.core.laws.interface import FieldSample
from fsw.core.laws.motion import motion

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
        inputs = inputs._replace(reference=None)
    assert motion(inputs, bench.config(body, 1.0)) is None
