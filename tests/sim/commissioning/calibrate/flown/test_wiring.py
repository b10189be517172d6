"""Signed permutations in numbers and in words."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sim.commissioning.calibrate.flown.wiring import (
    COILS,
    MAGNETOMETER,
    RIGHT,
    WIRINGS,
    body_from_outputs,
    channels_from_body,
    in_words,
)


def test_there_are_48_of_them_each_once_and_half_of_them_mirror():
    assert len(set(WIRINGS)) == 48
    assert RIGHT in WIRINGS
    assert sum(np.linalg.det(channels_from_body(one)) < 0.0 for one in WIRINGS) == 24


def test_a_channel_shows_its_axis_and_an_output_drives_it():
    b = np.array([1.0, 20.0, 300.0])
    assert (channels_from_body((-2, 3, 1)) @ b).tolist() == [-20.0, 300.0, 1.0]
    assert body_from_outputs((-2, 3, 1))[:, 0].tolist() == [0.0, -1.0, 0.0]


def test_each_has_words_of_its_own():
    for unit in (COILS, MAGNETOMETER):
        assert len({in_words(unit, one) for one in WIRINGS}) == 48


@pytest.mark.parametrize(
    ("wiring", "coils", "magnetometer"),
    [
        ((1, 2, 3), "coils: wired as the table says", "magnetometer: wired as the table says"),
        (
            (1, -2, 3),
            "coils: coil 2 is reversed",
            "magnetometer: channel 2 is reversed; its axes are mirrored",
        ),
        (
            (1, 3, -2),
            "coils: coils 2 and 3 are swapped, coil 3 is reversed",
            "magnetometer: turned 90 deg about axis 1",
        ),
        ((-1, 2, -3), "coils: coils 1 and 3 are reversed", "magnetometer: turned 180 deg about axis 2"),
        ((2, 1, -3), None, "magnetometer: turned 180 deg about the diagonal of axes +1 and +2"),
        ((2, 3, 1), None, "magnetometer: turned 120 deg about the diagonal (+, +, +) of the axes"),
    ],
)
def test_in_words(wiring, coils, magnetometer):
    if coils:
        assert in_words(COILS, wiring) == coils
    assert in_words(MAGNETOMETER, wiring) == magnetometer


@pytest.mark.parametrize("axis", [1, 2, 3])
@pytest.mark.parametrize("angle_deg", [90, -90, 180])
def test_the_words_of_a_turn_are_those_of_the_turned_sensor(axis, angle_deg):
    """Sensor axes, turned with the sensor, stand in the rows of the matrix."""
    turned = Rotation.from_rotvec(np.radians(angle_deg) * np.eye(3)[axis - 1]).as_matrix().T.round()
    wiring = next(one for one in WIRINGS if np.array_equal(channels_from_body(one), turned))
    assert in_words(MAGNETOMETER, wiring) == f"magnetometer: turned {angle_deg} deg about axis {axis}"
