"""The magnetometer by |B| alone: known errors are found within their deviations, others are not told."""

import numpy as np
import pytest
from recorded_samples import AXES, MATRIX, OFFSET_NT, made_up
from scipy.spatial.transform import Rotation

from sim.commissioning.calibrate.magnetometer import NAMES, fit_magnetometer


def samples(count=600, noise_nt=200.0, seed=1, matrix=MATRIX, reach=1.0):
    """Directions all over the sphere, or within a part of it; strengths as along an orbit."""
    random = np.random.default_rng(seed)
    direction = random.standard_normal((count, 3)) * (reach, 1.0, 1.0) + (0.0, 0.0, 0.0)
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    strength = 35e3 + 12e3 * np.sin(np.linspace(0.0, 5.0, count))
    field = direction * strength[:, None] + noise_nt * random.standard_normal((count, 3))
    return field @ np.linalg.inv(matrix).T + OFFSET_NT, strength


def deviations(fit, matrix=MATRIX):
    off = [*(fit.offset_nt - OFFSET_NT), *(fit.matrix - matrix)[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]]
    return np.array(off) / fit.sigma


@pytest.mark.long
def test_the_true_numbers_are_within_their_deviations():
    off = np.array([deviations(fit_magnetometer(*samples(seed=seed))) for seed in range(12)])
    assert np.mean(np.abs(off) < 3.0) > 0.95
    assert np.mean(off**2) == pytest.approx(1.0, abs=0.6)


def test_all_nine_are_told_and_the_residual_is_the_noise():
    fit = fit_magnetometer(*samples())
    assert fit.determined.all()
    assert fit.rms_nt == pytest.approx(200.0, rel=0.1)
    assert fit.correlation_rows < 2.0


def test_wild_samples_do_not_pull_it():
    mag, strength = samples()
    mag[::40] += (30000.0, -20000.0, 10000.0)
    fit = fit_magnetometer(mag, strength)
    assert np.abs(fit.offset_nt - OFFSET_NT).max() < 150.0
    assert np.abs(fit.matrix - MATRIX).max() < 0.006


def test_a_row_that_lacks_a_number_counts_for_nothing():
    mag, strength = samples()
    gaps = mag.copy()
    gaps[[5, 6, 300], [0, 2, 1]] = np.nan
    kept = np.isfinite(gaps).all(axis=1)
    fit, without = fit_magnetometer(gaps, strength), fit_magnetometer(mag[kept], strength[kept])
    assert fit.values == without.values
    np.testing.assert_array_equal(fit.residual_nt, without.residual_nt)
    assert len(fit.residual_nt) == len(mag) - 3


def test_its_values_stand_in_the_order_of_their_names():
    fit = fit_magnetometer(*samples())
    values = dict(zip(NAMES, fit.values, strict=True))
    assert [values[f"b_{axis}"] for axis in "xyz"] == fit.offset_nt.tolist()
    assert (values["m_xx"], values["m_xy"], values["m_yz"]) == tuple(fit.matrix[[0, 0, 1], [0, 1, 2]])


def test_a_matrix_that_turns_comes_out_without_its_turn():
    """|B| does not show it: M = R S gives the S of the polar decomposition, symmetric and positive."""
    turned = Rotation.from_rotvec(np.radians((3.0, -20.0, 8.0))).as_matrix() @ MATRIX
    fit = fit_magnetometer(*samples(matrix=turned))
    np.testing.assert_allclose(fit.matrix, MATRIX, atol=0.006)
    np.testing.assert_array_equal(fit.matrix, fit.matrix.T)
    assert np.linalg.eigvalsh(fit.matrix).min() > 0.0


@pytest.mark.long
def test_a_bias_along_the_spin_axis_cannot_be_seen_in_a_minute(tmp_path):
    """The field along the axis stands still, and so may the bias."""
    short, long = (made_up(seconds, noise_nt=300.0, seed=4).along(tmp_path) for seconds in (60, 900))
    fits = [fit_magnetometer(one.recorded.mag_nt, one.strength_nt) for one in (short, long)]
    assert fits[0].determined[:3].tolist() == [True, False, True]
    assert fits[0].weakest_nt > 1500.0
    assert fits[0].weakest_axis @ AXES[:, 1] > 0.98
    assert fits[1].determined.all()
    assert fits[1].weakest_nt < 0.3 * fits[0].weakest_nt


@pytest.mark.long
def test_what_is_told_of_a_spin_is_true(tmp_path):
    """Where samples hardly change along an axis, their noise must not be taken for a smaller scale there."""
    off = []
    for seed in range(6):
        around = made_up(200, noise_nt=300.0, seed=seed).along(tmp_path)
        fit = fit_magnetometer(around.recorded.mag_nt, around.strength_nt)
        off += deviations(fit)[fit.determined].tolist()
    assert len(off) > 20
    assert np.mean(np.abs(off) < 3.0) > 0.9
    assert np.max(np.abs(off)) < 5.0


def test_neighbouring_errors_count_as_one():
    mag, strength = samples(noise_nt=0.0)
    slow = 300.0 * np.sin(np.linspace(0.0, 40.0, len(strength)))
    white = 212.0 * np.random.default_rng(5).standard_normal(len(strength))
    first, second = fit_magnetometer(mag, strength + white), fit_magnetometer(mag, strength + slow)
    assert second.correlation_rows > 4.0 * first.correlation_rows
    assert second.sigma[:3].mean() > 1.5 * first.sigma[:3].mean()
