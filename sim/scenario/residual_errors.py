"""The errors of sensors and coils that the onboard calibration leaves, and the filter has to find.

A calibrated sample is M (A b + c - o), the reading being A b + c, so that M A - 1 and M (c - o) are left.
Errors are small, of first order: E = M A - 1 holds scale errors on its diagonal and a misalignment, -[turn
x], in its antisymmetric part; no parameter describes its symmetric part off the diagonal.
"""

from typing import NamedTuple

import numpy as np

from fsw.table.calibration import CalibrationTable, coil_axes, outputs_of
from sim.plant.config import CoilConfig
from sim.plant.hardware.sensors import MagnetometerPhysics
from sim.plant.rotation import ZERO, Vec3, from_vector, matrix
from sim.plant.sensor_config import MagnetometerConfig, SunSensorConfig
from sim.value_types import Array, vec3

UNIT_T = 1e-4
UNIT_FIELDS_T = ((UNIT_T, 0.0, 0.0), (0.0, UNIT_T, 0.0), (0.0, 0.0, UNIT_T))


class MagnetometerErrors(NamedTuple):
    """Of calibrated samples, body axes: offset [T], misalignment [rad] and scale minus one."""

    bias_t: Vec3
    turn_rad: Vec3
    scale: Vec3


def reading_of(plant: MagnetometerConfig) -> tuple[Array, Array]:
    """A and c of the reading A b + c [T] of a field b, body axes, without noise, quantum or saturation."""
    bare = MagnetometerConfig(
        bias_t=plant.bias_t,
        scale=plant.scale,
        misalignment_rad=plant.misalignment_rad,
        non_orthogonality_rad=plant.non_orthogonality_rad,
        saturation_t=1.0,
        wiring=plant.wiring,
    )
    sensor = MagnetometerPhysics(bare, seed=0)
    still = np.array(sensor.measure(ZERO, ZERO)[0])
    by_axis = [np.array(sensor.measure(field, ZERO)[0]) - still for field in UNIT_FIELDS_T]
    return np.array(by_axis).T / UNIT_T, still


def magnetometer_errors(plant: MagnetometerConfig, table: CalibrationTable) -> MagnetometerErrors:
    """The plant's own errors, or what a calibration leaves of them."""
    known = table.magnetometer
    if known is None:
        first, second, third = plant.scale
        return MagnetometerErrors(
            plant.bias_t, plant.misalignment_rad, (first - 1.0, second - 1.0, third - 1.0)
        )
    sensed, offset_t = reading_of(plant)
    calibration = np.array(known.matrix)
    left = calibration @ sensed - np.eye(3)
    bias_t = calibration @ (offset_t - 1e-9 * np.array(known.offset_nt))
    return MagnetometerErrors(vec3(bias_t), _turn_rad(left), vec3(left.diagonal()))


def sun_turn_rad(plant: SunSensorConfig, table: CalibrationTable) -> Vec3:
    """The misalignment of the Sun sensor that is left."""
    if table.sun is None:
        return plant.misalignment_rad
    turned = np.array(matrix(from_vector(plant.misalignment_rad)))
    return _turn_rad(np.array(table.sun.matrix) @ turned)


def coil_errors(plant: CoilConfig, table: CalibrationTable) -> Array:
    """G: column j is the error of the dipole for a demand of 1 A m^2 along body axis j."""
    axes = [matrix(from_vector(turn))[coil] for coil, turn in enumerate(plant.misalignment_rad)]
    by_coil = np.array(axes).T * np.array(plant.dipole_scale)
    by_output = by_coil[:, [abs(coil) - 1 for coil in plant.wiring]] * np.sign(plant.wiring)
    if table.coils is None or table.coils.matrix is None:
        return np.asarray(by_output - np.eye(3), float)
    outputs = outputs_of(table.coils.matrix)
    order = [outputs.of_axis(axis) for axis in range(3)]
    true = (by_output * np.array(outputs.sign))[:, order]
    return np.asarray(true @ np.linalg.inv(np.array(coil_axes(table.coils)).T) - np.eye(3), float)


def _turn_rad(error: Array) -> Vec3:
    """The rotation t of -[t x], the antisymmetric part."""
    return vec3(
        0.5 * np.array([error[1, 2] - error[2, 1], error[2, 0] - error[0, 2], error[0, 1] - error[1, 0]])
    )
