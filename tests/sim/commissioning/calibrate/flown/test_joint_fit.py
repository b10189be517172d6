"""Twelve numbers of the magnetometer from |b| and s . b."""

import numpy as np
import pytest

from sim.commissioning.calibrate.flown.joint_fit import FitPrior, joint_fit

NEAR = FitPrior(np.eye(3), 0.1, 1e5)


@pytest.mark.long
def test_without_noise_it_finds_what_is_there(observed, truth):
    matrix, offset = truth
    found = joint_fit(observed(), NEAR)
    assert found.matrix == pytest.approx(matrix, abs=2e-5)
    assert found.offset_nt == pytest.approx(offset, abs=1.0)


@pytest.mark.long
def test_errors_are_as_large_as_it_says(observed, truth):
    """Of 12 numbers in 12 draws, in standard deviations."""
    matrix, offset = truth
    off = []
    for seed in range(12):
        found = joint_fit(observed(400, 50.0, 0.002, seed=seed), NEAR)
        error = np.concatenate([(found.matrix - matrix).ravel(), found.offset_nt - offset])
        off.append(error / np.sqrt(found.covariance.diagonal()))
    assert 0.85 < np.sqrt(np.mean(np.square(off))) < 1.15
    assert np.mean(np.abs(off) < 3.0) > 0.98


@pytest.mark.long
def test_the_noise_of_a_body_that_hardly_turns_is_not_taken_for_a_small_scale_and_an_offset(
    observed_slowly, truth
):
    """Offsets of 12 draws, in standard deviations, and the squares that are left."""
    prior = FitPrior(np.eye(3), 0.05, 60000.0)
    found = [joint_fit(observed_slowly(200.0, 0.0087, seed), prior) for seed in range(12)]
    off = [(one.offset_nt - truth[1]) / np.sqrt(one.covariance.diagonal()[9:]) for one in found]
    assert np.sqrt(np.mean(np.square(off))) < 1.3
    assert np.abs(np.mean(off, axis=0)).max() < 3.0 / np.sqrt(12.0)
    assert np.mean([one.chi2 / one.numbers for one in found]) == pytest.approx(1.0, abs=0.03)


@pytest.mark.long
def test_without_the_sun_the_turn_stays_as_unknown_as_before(observed, truth):
    """|b| is blind to a turn; offset and scale it tells."""
    found = joint_fit(observed(noise_nt=50.0, sun=False), NEAR)
    sigma = np.sqrt(found.covariance.diagonal())
    turn = np.sqrt(found.covariance[1, 1] + found.covariance[3, 3] - 2.0 * found.covariance[1, 3])
    assert turn > 1.3 * 0.1
    assert sigma[9:].max() < 20.0
    assert found.offset_nt == pytest.approx(truth[1], abs=200.0)


def test_a_body_that_does_not_turn_with_a_field_that_hardly_does_leaves_the_offset_open(observed):
    samples = observed(noise_nt=50.0, fixed=True)
    samples = type(samples)(
        samples.field_nt[:200] * 0.002 + samples.field_nt[0] * 0.998,
        samples.sun[:200],
        samples.b_eci_nt[:200] * 0.002 + samples.b_eci_nt[0] * 0.998,
        samples.sun_eci[:200],
        50.0,
        0.002,
    )
    sigma = np.sqrt(joint_fit(samples, NEAR).covariance.diagonal())
    assert sigma[9:].max() > 1000.0


@pytest.mark.long
def test_a_mirrored_sensor_is_found_from_a_mirrored_start(observed, truth):
    mirror = np.diag([1.0, -1.0, 1.0])
    samples = observed()
    mirrored = type(samples)(
        samples.field_nt @ mirror, *(getattr(samples, name) for name in samples.__slots__[1:])
    )
    found = joint_fit(mirrored, FitPrior(mirror, 0.1, 1e5))
    assert found.matrix == pytest.approx(truth[0] @ mirror, abs=2e-5)
    wrong = joint_fit(mirrored, NEAR)
    assert wrong.chi2 > 300.0 > 100.0 * found.chi2  # it must leave what is known beforehand
