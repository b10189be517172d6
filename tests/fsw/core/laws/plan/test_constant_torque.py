"""The torque that stays at the nominal attitude: what is estimated, and what the table lacks of inertia."""

import numpy as np
import pytest

from fsw.core.estimation.parameters import UNCHANGED_INERTIA, Parameters
from fsw.core.laws.plan.constant_torque import constant_torque
from fsw.core.laws.plan.law_axes import law_axes

TORQUE_NM = (2e-8, -3e-8, 1e-8)
ERROR_KGM2 = (0.02, -0.05, 0.03, 0.011, -0.017, 0.023)
"""J11, J22, J33, J12, J13, J23."""


@pytest.fixture
def reference(bench):
    return bench.inputs_at(bench.Orbit(), 700, 1.0, np.eye(3), np.zeros(3), None).reference


def test_it_is_gravity_gradient_and_turn_of_the_inertia_that_is_off(reference):
    """3 w0^2 e1 x dJ e1 - w0^2 e3 x dJ e3."""
    xx, yy, zz, xy, xz, yz = ERROR_KGM2
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    e1, _, e3 = np.eye(3)
    square = reference.orbit_rate_radps**2
    expected = 3.0 * square * np.cross(e1, tensor @ e1) - square * np.cross(e3, tensor @ e3)
    known = Parameters(torque_body_nm=TORQUE_NM, inertia_error_kgm2=ERROR_KGM2)
    assert constant_torque(known, reference, None) == pytest.approx(expected + np.array(TORQUE_NM), rel=1e-12)
    assert min(abs(expected)) > 1e-9


def test_where_nothing_is_off_or_there_is_no_orbit_it_is_the_estimated_torque(reference):
    exact = Parameters(torque_body_nm=TORQUE_NM, inertia_error_kgm2=UNCHANGED_INERTIA)
    assert constant_torque(exact, reference, None) == TORQUE_NM
    off = Parameters(torque_body_nm=TORQUE_NM, inertia_error_kgm2=ERROR_KGM2)
    assert constant_torque(off, None, None) == TORQUE_NM


def test_where_another_axis_looks_up_it_is_that_of_the_attitude_held_there(reference):
    """Body axis -y up, z ahead: the orbit's normal is body axis -x."""
    xx, yy, zz, xy, xz, yz = ERROR_KGM2
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    up, normal = np.array([0.0, -1.0, 0.0]), np.array([-1.0, 0.0, 0.0])
    square = reference.orbit_rate_radps**2
    expected = 3.0 * square * np.cross(up, tensor @ up) - square * np.cross(normal, tensor @ normal)
    known = Parameters(torque_body_nm=TORQUE_NM, inertia_error_kgm2=ERROR_KGM2)
    found = constant_torque(known, reference, law_axes("-y", "z"))
    assert found == pytest.approx(expected + np.array(TORQUE_NM), rel=1e-12)
