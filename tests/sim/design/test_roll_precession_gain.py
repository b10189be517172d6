"""The gain of the precession by roll: averaging, Floquet theory and the law's own torque agree."""

from math import radians

import numpy as np
import pytest

from fsw.core.laws.roll_precession import roll_dipole
from sim.design.roll_precession_gain import DIPOLE_TM3, averaged, degree, gain_of, motion

RADIUS_M, RATE_RADPS, INCLINATION_RAD = 7.178e6, 1.038e-3, radians(98.6)


@pytest.mark.parametrize("c", [0.02, 0.1, 0.4])
def test_floquet_theory_gives_the_averaged_decay_at_small_gains(c):
    assert degree(c) == pytest.approx(averaged(c)[0], rel=5e-3)


def test_the_second_exponent_is_three_times_the_first():
    """The trace of the matrix over an orbit is their sum, -c/2 in the mean."""
    u = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
    trace = np.trace(motion(0.3)(u), axis1=1, axis2=2).mean()
    assert trace == pytest.approx(sum(averaged(0.3)))
    assert averaged(0.3)[1] == pytest.approx(3.0 * averaged(0.3)[0])


def test_a_gain_of_the_wrong_sign_is_unstable():
    assert degree(-0.1) > 0.01


@pytest.mark.parametrize("u", [0.3, 1.9, 4.4])
def test_the_matrix_is_that_of_the_law_in_the_dipole_s_field(u):
    """Body in the orbital frame, spinning about axis 3: E' = torque / (h w0) and the turning of the frame."""
    k_h, h_nms = gain_of(0.4, RATE_RADPS, RADIUS_M, INCLINATION_RAD), 0.2
    size, tilt = DIPOLE_TM3 / RADIUS_M**3, np.array([1e-6, -2e-6])
    b = size * np.array(
        [
            -2.0 * np.sin(u) * np.sin(INCLINATION_RAD),
            np.cos(u) * np.sin(INCLINATION_RAD),
            np.cos(INCLINATION_RAD),
        ]
    )
    axis = np.array([*tilt, 1.0])
    m = roll_dipole(tuple(b), (tilt[0], 0.0, tilt[0]), (0.0, 1.0, tilt[1]), h_nms, 2, k_h)[2]
    torque = np.cross(m * axis, b)[:2]
    expected = torque / (h_nms * RATE_RADPS) + np.array([tilt[1], -tilt[0]])
    np.testing.assert_allclose(motion(0.4)(np.array([u]))[0] @ tilt, expected, rtol=1e-4)


def test_over_the_equator_no_gain_serves():
    assert gain_of(0.4, RATE_RADPS, RADIUS_M, 0.0) == float("inf")
