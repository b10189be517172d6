"""What each piece of evidence admits, by itself."""

import numpy as np
import pytest

from sim.commissioning.calibrate.flown.coil_axes import CoilAxes
from sim.commissioning.calibrate.flown.coil_field import CoilResponse
from sim.commissioning.calibrate.flown.wiring import RIGHT, WIRINGS, body_from_outputs, channels_from_body
from sim.commissioning.phasing.judge import by_coil_field, by_field_around, by_torque, wirings_of

EVEN = 2000.0 * np.eye(3)
UNEVEN = np.array([[1000.0, 0.0, 0.0], [0.0, 2000.0, 0.0], [0.0, 0.0, 4500.0]])


def response(sensor, coils, field, sigma=10.0, pulses=(2, 2, 2)):
    d = channels_from_body(sensor) @ field @ body_from_outputs(coils)
    return CoilResponse(d, np.full((3, 3), sigma), pulses, 0.0, 0.01, 200.0, np.zeros((0, 3)), np.zeros(0))


def dipoles(matrix, sigma):
    return CoilAxes(np.array(matrix), np.diag(np.square(sigma).ravel()), 0.0)


@pytest.mark.parametrize("sensor", WIRINGS[::5])
def test_an_even_field_of_the_coils_leaves_one_wiring_of_the_coils_for_each_of_the_sensor(sensor):
    pairs = by_coil_field(response(sensor, (2, -3, 1), EVEN), EVEN)
    assert (sensor, (2, -3, 1)) in pairs
    assert len(pairs) == 48
    assert len({one for one, _ in pairs}) == 48


def test_an_uneven_one_leaves_the_senses_alone():
    """Sizes tell the axes; of each the two senses can be wrong together."""
    pairs = by_coil_field(response((3, -1, 2), (2, -3, 1), UNEVEN), UNEVEN)
    assert len(pairs) == 8
    assert {tuple(map(abs, sensor)) for sensor, _ in pairs} == {(3, 1, 2)}


def test_an_output_that_was_not_fired_admits_anything():
    two = by_coil_field(response(RIGHT, RIGHT, UNEVEN, pulses=(2, 2, 0)), UNEVEN)
    assert (RIGHT, (1, 2, -3)) in two
    assert (RIGHT, (1, -2, 3)) not in two


def test_a_field_around_tells_the_sensor_if_the_offset_is_small():
    b = np.array([6600.0, 21000.0, -10200.0])
    reading = channels_from_body((-2, 3, 1)) @ b + (900.0, -700.0, 400.0)
    assert by_field_around(reading, b, 1000.0) == [(-2, 3, 1)]
    assert len(by_field_around(reading, b, 60000.0)) == 48
    assert by_field_around(2.0 * reading, b, 1000.0) == []


def test_torques_tell_the_axes_of_the_coils():
    found = by_torque(dipoles([[0.05, -1.1, 0.1], [0.9, 0.1, 0.0], [0.0, 0.0, 0.7]], np.full((3, 3), 0.05)))
    assert wirings_of(found) == [(2, -1, 3)]


def test_what_no_torque_shows_stays_open():
    """Of output 3 only the component along axis 1 is known: it is not along it."""
    sigma = np.array([[0.05, 0.05, 0.05], [0.05, 0.05, 1.2], [0.05, 0.05, 1.2]])
    found = by_torque(dipoles([[0.0, -1.0, 0.0], [1.0, 0.0, 0.3], [0.0, 0.0, -0.2]], sigma))
    assert set(wirings_of(found)) == {(2, -1, 3), (2, -1, -3)}


def test_a_coil_that_does_nothing_is_dead_and_fits_no_axis():
    found = by_torque(dipoles([[1.0, 0.02, 0.0], [0.0, 0.01, 0.0], [0.0, -0.03, 1.0]], np.full((3, 3), 0.05)))
    assert [one.dead for one in found] == [False, True, False]
    assert wirings_of(found) == []
