"""The filter's tuning: what stands where, and what is prepared from it."""

from dataclasses import replace
from math import radians

import numpy as np
from cell_samples import CELLS

from fsw.core.algebra.vector import inverse
from fsw.core.estimation.mekf_config import mekf_config
from fsw.core.estimation.parameters import NOTHING, OF_CELLS, Parameters, Prior, Rotor


def test_the_priors_stand_where_the_layout_says(satellite):
    config = satellite.config()
    expected = np.repeat([radians(5.0), radians(2.0)], 3) ** 2
    np.testing.assert_allclose(config.initial_covariance.diagonal()[:6], expected, rtol=1e-12)
    sigmas = {
        "mag_bias_t": (3e-7, 4e-7, 5e-7),
        "torque_body_nm": (1e-7, 8e-8, 9e-8),
        "inertia_error_kgm2": (0.06, 0.1, 0.08, 0.018, 0.016, 0.02),
        "sun_turn_rad": (0.004, 0.003, 0.005),
        "delay_s": (0.5, 0.6),
    }
    for name in set(satellite.carried) & set(sigmas):
        variances = config.initial_covariance.diagonal()[satellite.place(name)]
        np.testing.assert_allclose(variances, np.square(sigmas[name]), rtol=1e-12)
    off_diagonal = config.initial_covariance - np.diag(config.initial_covariance.diagonal())
    assert not off_diagonal.any()


def test_every_array_has_the_size_of_the_error_state(satellite):
    config, size = satellite.config(), satellite.size()
    assert config.layout.size == size
    assert config.initial_covariance.shape == config.process_noise.shape == (size, size)
    assert config.constant.shape == (6, size)
    assert config.field_sensitivity.shape == config.sun_sensitivity.shape == (3, size)


def test_the_parameters_begin_at_the_means_of_their_priors(full):
    """With cells theirs are there even where they are certain."""
    of_cells = {name: (0.0,) * size for name, size in OF_CELLS.items()}
    assert full.config(cells=CELLS).initial_parameters == replace(NOTHING, **of_cells)
    tuning = {
        "magnetometer_sigma_t": 2e-7,
        "sun_sigma_rad": 0.01,
        "attitude_sigma_rad": 0.1,
        "rate_sigma_radps": 0.03,
        "torque_noise_nm_rts": 1e-8,
        "gate_nis": 16.27,
    }
    late = {
        "delay_s": Prior((0.2, 0.3), (0.0, 0.0), mean=(0.5, 0.7)),
        "mag_scale": Prior((0.1,) * 3, (0.0,) * 3),
    }
    config = mekf_config(full.inertia_kgm2, 1.0, late, **tuning)
    assert config.initial_parameters == Parameters(delay_s=(0.5, 0.7))
    with_cells = mekf_config(full.inertia_kgm2, 1.0, late, cells=CELLS, **tuning)
    assert with_cells.initial_parameters == replace(config.initial_parameters, **of_cells)


def test_the_rotor_is_that_of_the_table(full):
    config = full.config(wheel_body_nms=(0.01, -0.02, 0.03))
    assert config.rotor == Rotor(full.inertia_kgm2, inverse(full.inertia_kgm2), (0.01, -0.02, 0.03))


def test_noise_of_the_sensors(full):
    config = full.config(magnetometer_sigma_t=1.5e-7, sun_sigma_rad=0.007)
    np.testing.assert_allclose(config.field_noise, 1.5e-7**2 * np.eye(3), rtol=1e-12)
    np.testing.assert_allclose(config.sun_noise, 0.007**2 * np.eye(3), rtol=1e-12)
    np.testing.assert_allclose(config.both_noise.diagonal(), [1.5e-7**2] * 3 + [0.007**2] * 3, rtol=1e-12)
