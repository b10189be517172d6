from dataclasses import replace
from math import radians

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.plant.config import MagnetometerConfig, SunSensorConfig
from sim.plant.sensors import MagnetometerPhysics, SunSensorPhysics

B = (1.1e-5, -2.3e-5, 3.1e-5)
S = (0.6, -0.48, 0.64)
OFF = (0.0, 0.0, 0.0)


def read_field(config, m=OFF, b=B, seed=1):
    return MagnetometerPhysics(config, seed).measure(b, m)


def read_sun(config, lit=1.0, seed=1):
    return SunSensorPhysics(config, seed).measure(S, lit)


def test_perfect_sensors_show_the_truth():
    assert read_field(MagnetometerConfig()) == (pytest.approx(B, rel=1e-15), True)
    assert read_sun(SunSensorConfig()) == (pytest.approx(S, rel=1e-15), True)


def test_bias_and_scale_are_added_and_multiplied_on_their_axes():
    config = MagnetometerConfig(bias_t=(3e-7, -2e-7, 1e-7), scale=(1.01, 0.98, 1.03))
    expected = np.array(B) * (1.01, 0.98, 1.03) + (3e-7, -2e-7, 1e-7)
    assert read_field(config)[0] == pytest.approx(expected)


def test_misalignment_turns_the_sensor():
    tilt = (0.02, -0.03, 0.05)
    sensor_from_body = Rotation.from_rotvec(tilt).inv()
    assert read_field(MagnetometerConfig(misalignment_rad=tilt))[0] == pytest.approx(
        sensor_from_body.apply(B)
    )
    assert read_sun(SunSensorConfig(misalignment_rad=tilt))[0] == pytest.approx(sensor_from_body.apply(S))


def test_errors_come_in_their_order_turned_then_scaled_then_biased():
    tilt, scale, bias = (0.02, -0.03, 0.05), (1.5, 0.5, 1.7), (1e-6, 2e-6, 3e-6)
    config = MagnetometerConfig(bias_t=bias, scale=scale, misalignment_rad=tilt)
    expected = np.array(scale) * Rotation.from_rotvec(tilt).inv().apply(B) + bias
    assert read_field(config)[0] == pytest.approx(expected)


def test_coils_add_their_own_field():
    """0.1 A m^2 at 0.1 m on its axis: mu0 m / (2 pi r^3) = 20 uT, as large as the Earth's field."""
    on_axis = 2e-7 / 0.1**3
    config = MagnetometerConfig(
        coil_coupling_t_per_am2=((on_axis, 2e-6, 3e-6), (4e-6, -0.5 * on_axis, 5e-6), (6e-6, 7e-6, 8e-6))
    )
    own = np.array(read_field(config, (0.1, 0.0, 0.0))[0]) - B
    assert own == pytest.approx([2e-5, 4e-7, 6e-7])
    own = np.array(read_field(config, (0.0, 0.1, 0.0))[0]) - B
    assert own == pytest.approx([2e-7, -1e-5, 7e-7])
    assert read_field(config)[0] == pytest.approx(B)


def test_magnetometer_noise_is_white_with_the_given_deviation():
    sensor = MagnetometerPhysics(MagnetometerConfig(noise_t=2e-7), 5)
    errors = np.array([sensor.measure(B, OFF)[0] for _ in range(5000)]) - B
    assert errors.std(axis=0) == pytest.approx([2e-7] * 3, rel=0.05)
    assert np.abs(errors.mean(axis=0)).max() < 4.0 * 2e-7 / np.sqrt(5000)
    assert np.abs(np.corrcoef(errors.T) - np.eye(3)).max() < 0.06


def test_sun_noise_is_an_angle_across_the_line_of_sight():
    sensor = SunSensorPhysics(SunSensorConfig(noise_rad=radians(0.5)), 5)
    readings = np.array([sensor.measure(S, 1.0)[0] for _ in range(5000)])
    assert np.linalg.norm(readings, axis=1) == pytest.approx(1.0, abs=1e-14)
    across = np.cross(S, readings)
    assert np.degrees(np.sqrt((across**2).sum(axis=1).mean() / 2.0)) == pytest.approx(0.5, rel=0.05)
    assert np.abs(across.mean(axis=0)).max() < 4.0 * radians(0.5) / np.sqrt(5000)


def test_readings_are_whole_quanta():
    field, _ = read_field(MagnetometerConfig(noise_t=2e-7, quantum_t=3e-8))
    assert np.array(field) / 3e-8 == pytest.approx(np.round(np.array(field) / 3e-8), abs=1e-9)
    sun, _ = read_sun(SunSensorConfig(noise_rad=0.01, quantum=1e-3))
    assert np.array(sun) / 1e-3 == pytest.approx(np.round(np.array(sun) / 1e-3), abs=1e-9)
    exact, _ = read_field(MagnetometerConfig(quantum_t=3e-8))
    assert np.abs(np.array(exact) - B).max() <= 1.5e-8 * (1 + 1e-9)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_one_saturated_axis_spoils_the_sample_and_is_held_at_the_end_of_the_range(axis, sign):
    b = [1e-5, -1e-5, 1e-5]
    b[axis] = sign * 5.1e-5
    reading, valid = read_field(MagnetometerConfig(saturation_t=5e-5), b=tuple(b))
    assert not valid
    assert reading[axis] == sign * 5e-5
    b[axis] = sign * 4.9e-5
    assert read_field(MagnetometerConfig(saturation_t=5e-5), b=tuple(b)) == (pytest.approx(b), True)


@pytest.mark.parametrize(("lit", "valid"), [(0.0, False), (0.499, False), (0.5, True), (1.0, True)])
def test_sun_is_seen_while_half_of_it_is(lit, valid):
    reading, seen = read_sun(SunSensorConfig(), lit)
    assert seen is valid
    assert reading == (pytest.approx(S) if valid else OFF)


def test_noise_of_a_sample_does_not_depend_on_what_was_sensed_before():
    """An eclipse or a saturated sample draws its numbers all the same."""
    sun_config, field_config = SunSensorConfig(noise_rad=0.01), MagnetometerConfig(noise_t=2e-7)
    dark, light = SunSensorPhysics(sun_config, 1), SunSensorPhysics(sun_config, 1)
    dark.measure(S, 0.0)
    light.measure(S, 1.0)
    assert dark.measure(S, 1.0) == light.measure(S, 1.0)
    strong, weak = MagnetometerPhysics(field_config, 1), MagnetometerPhysics(field_config, 1)
    strong.measure((1.0, 1.0, 1.0), OFF)
    weak.measure(OFF, OFF)
    assert strong.measure(B, OFF) == weak.measure(B, OFF)


def test_sensors_of_one_seed_have_their_own_noise():
    field, _ = read_field(MagnetometerConfig(noise_t=1.0, saturation_t=99.0), b=OFF)
    config = SunSensorConfig(noise_rad=1e-6)
    across = np.cross(S, read_sun(config)[0]) / 1e-6
    expected = np.cross(S, np.cross(field, S))
    assert np.abs(across - expected).max() > 0.1
    assert np.abs(across + expected).max() > 0.1


def test_configuration_can_be_replaced_in_part():
    config = replace(MagnetometerConfig(noise_t=2e-7), noise_t=0.0)
    assert read_field(config)[0] == pytest.approx(B)
