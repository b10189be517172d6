"""The filter's tuning: where each part of the error state stands, and what is prepared from it."""

from math import radians

import numpy as np
import pytest

from fsw.core.estimation.mekf_config import layout, mekf_config

INERTIA = ((1.02, 0.07, -0.05), (0.07, 1.85, 0.11), (-0.05, 0.11, 1.45))
J_INVERSE = np.linalg.inv(np.array(INERTIA))


def make_config(bias=True, torque=True):
    return mekf_config(
        INERTIA,
        0.5,
        estimate_bias=bias,
        estimate_torque=torque,
        magnetometer_sigma_t=2e-7,
        sun_sigma_rad=radians(0.5),
        attitude_sigma_rad=radians(5.0),
        rate_sigma_radps=radians(2.0),
        bias_sigma_t=3e-7,
        torque_sigma_nm=1e-7,
        torque_noise_nm_rts=1e-7,
        bias_walk_t_prts=1e-10,
        torque_walk_nm_prts=3e-10,
        gate_nis=16.27,
    )


class TestLayout:
    @pytest.mark.parametrize(
        ("bias", "torque", "size", "bias_at", "torque_at"),
        [
            (False, False, 6, None, None),
            (True, False, 9, 6, None),
            (False, True, 9, None, 6),
            (True, True, 12, 6, 9),
        ],
    )
    def test_sizes_and_places(self, bias, torque, size, bias_at, torque_at):
        parts = layout(bias, torque)
        assert (parts.size, parts.bias, parts.torque) == (size, bias_at, torque_at)
        config = make_config(bias, torque)
        assert config.initial_covariance.shape == config.process_noise.shape == (size, size)

    def test_the_prior_stands_where_the_layout_says(self):
        diagonal = make_config().initial_covariance.diagonal()
        expected = np.repeat([radians(5.0), radians(2.0), 3e-7, 1e-7], 3) ** 2
        np.testing.assert_allclose(diagonal, expected, rtol=1e-12)
        without_bias = make_config(bias=False).initial_covariance.diagonal()
        np.testing.assert_allclose(without_bias, np.delete(expected, [6, 7, 8]), rtol=1e-12)
