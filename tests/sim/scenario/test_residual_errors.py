"""What a calibration leaves: nothing where it is the sensor's own, all of it where there is none."""

import numpy as np
import pytest

from fsw.input.schema import merge
from sim.scenario.assemble import plant_config
from sim.scenario.residual_errors import coil_errors, magnetometer_errors, reading_of, sun_turn_rad
from sim.scenario.schema import flight_table, load

UNLIKE = {
    "coils": {
        "dipole_scale": [0.9, 1.07, -1.02],
        "misalignment_deg": [[0.4, 1.5, -2.0], [2.5, 0.1, 0.7], [-1.0, 3.0, 0.2]],
    },
    "sensors": {
        "magnetometer": {
            "bias_nt": [31000.0, -24000.0, 900.0],
            "scale": [1.04, 0.97, 0.99],
            "misalignment_deg": [0.5, -0.8, 0.3],
            "non_orthogonality_deg": [1.0, -1.5, 0.4],
        },
        "sun": {"misalignment_deg": [0.6, 2.0, -1.2]},
    },
}


@pytest.fixture
def flown():
    """Plant and onboard calibration of a satellite that is unlike its nominal self in each error."""

    def make(calibration=None):
        scenario = load("microsat", merge(UNLIKE, {"flight": {"calibration": calibration or {}}}))
        return plant_config(scenario, 1), flight_table(scenario).calibration

    return make


def test_without_a_calibration_the_errors_are_the_plant_s(flown):
    plant, table = flown()
    found = magnetometer_errors(plant.magnetometer, table)
    assert found.bias_t == plant.magnetometer.bias_t
    assert found.turn_rad == plant.magnetometer.misalignment_rad
    assert found.scale == pytest.approx((0.04, -0.03, -0.01))
    assert sun_turn_rad(plant.sun_sensor, table) == plant.sun_sensor.misalignment_rad
    lengths = np.linalg.norm(coil_errors(plant.coils, table) + np.eye(3), axis=0)
    assert lengths == pytest.approx([0.9, 1.07, 1.02])


def test_the_true_calibration_leaves_nothing(flown):
    plant, table = flown()
    sensed, offset_t = reading_of(plant.magnetometer)
    found = magnetometer_errors(
        plant.magnetometer,
        flown(
            {
                "magnetometer": {
                    "matrix": np.linalg.inv(sensed).tolist(),
                    "offset_nt": (1e9 * offset_t).tolist(),
                }
            }
        )[1],
    )
    assert np.abs(found).max() < 1e-12
    true_dipoles = coil_errors(plant.coils, table) + np.eye(3)
    known = flown({"coils": {"matrix": true_dipoles.tolist()}})[1]
    assert np.abs(coil_errors(plant.coils, known)).max() < 1e-12, "output 3 is known to be reversed"


def test_a_calibration_that_is_off_leaves_what_it_is_off_by(flown):
    plant, _ = flown()
    sensed, offset_t = reading_of(plant.magnetometer)
    turn, scale = np.array([2e-3, -3e-3, 1e-3]), np.array([1e-3, -2e-3, 4e-3])
    cross = np.array([[0.0, -turn[2], turn[1]], [turn[2], 0.0, -turn[0]], [-turn[1], turn[0], 0.0]])
    off = (np.eye(3) + np.diag(scale) - cross) @ np.linalg.inv(sensed)
    given = {"matrix": off.tolist(), "offset_nt": (1e9 * offset_t - [100.0, 0.0, -50.0]).tolist()}
    found = magnetometer_errors(plant.magnetometer, flown({"magnetometer": given})[1])
    assert found.turn_rad == pytest.approx(turn, abs=1e-12)
    assert found.scale == pytest.approx(scale, abs=1e-12)
    assert found.bias_t == pytest.approx(off @ [100e-9, 0.0, -50e-9], abs=1e-15)
