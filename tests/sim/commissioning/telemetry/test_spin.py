"""Starts from the field: the true spin is among those that fit, and where two fit alike both are found."""

import numpy as np
import pytest
from recorded_samples import AXES, MATRIX, OFFSET_NT, made_up
from scipy.spatial.transform import Rotation

from sim.commissioning.telemetry.spin import spin_axis, spins

AXIS = AXES[:, 1]


def calibrated(truth, off_nt=(0.0, 0.0, 0.0)):
    rows = np.array([[float(field) for field in line.split(",")] for line in truth.text.splitlines()[1:]])
    return (rows[:, 1:4] - OFFSET_NT) @ MATRIX.T + off_nt


def found(truth, off_nt=(0.0, 0.0, 0.0)):
    return spins(truth.t_s, calibrated(truth, off_nt), truth.b_eci_nt, AXIS)


def off_deg(spin, truth):
    return np.degrees(Rotation.from_matrix(spin.dcm_body_from_eci @ truth.dcm[0].T).magnitude())


@pytest.mark.long
@pytest.mark.parametrize("rate_degps", [31.0, -47.0, 75.0, 170.0])
def test_the_true_spin_is_among_those_that_fit(rate_degps):
    truth = made_up(200, rate_degps)
    best = min(found(truth), key=lambda spin: off_deg(spin, truth))
    assert off_deg(best, truth) < 12.0
    assert best.rate_degps == pytest.approx(rate_degps, abs=0.05)
    np.testing.assert_allclose(best.omega_body_radps, np.radians(best.rate_degps) * AXIS)


@pytest.mark.long
def test_a_field_that_turns_far_shows_the_true_spin_first():
    truth = made_up(900, 31.0)
    assert off_deg(found(truth)[0], truth) < 8.0


def test_one_that_turns_little_fits_two_spins_alike():
    first, second, *_ = found(made_up(150, 31.0, seed=4))
    assert second.misfit_deg < 1.2 * first.misfit_deg
    assert abs(first.rate_degps - second.rate_degps) > 0.05


@pytest.mark.long
def test_a_bias_across_the_axis_is_found_and_one_along_it_cannot_be():
    across = np.cross(AXIS, (0.0, 0.0, 1.0))
    across /= np.linalg.norm(across)
    truth = made_up(200, 31.0)
    best = found(truth, 4000.0 * across + 2000.0 * AXIS)[0]
    assert best.bias_nt @ across == pytest.approx(4000.0, abs=400.0)
    assert best.bias_nt @ AXIS == pytest.approx(0.0, abs=1e-6)


@pytest.mark.long
def test_the_axis_is_that_across_which_samples_differ():
    truth = made_up(200, 31.0)
    axis = spin_axis(calibrated(truth))
    assert np.degrees(np.arccos(axis @ AXIS)) < 1.5
    assert axis[np.argmax(np.abs(axis))] > 0.0


def test_a_sample_of_no_field_counts_for_nothing():
    truth = made_up(150, 31.0)
    field_nt = calibrated(truth)
    field_nt[40] = 0.0
    (best, *_) = spins(truth.t_s, field_nt, truth.b_eci_nt, AXIS)
    assert off_deg(best, truth) < 12.0
