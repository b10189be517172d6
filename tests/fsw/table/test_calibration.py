"""The calibration of a table: nothing where it is left out, else what it says, in the core's terms."""

import numpy as np
import pytest

from fsw.core.gate.calibration import NO_CALIBRATION
from fsw.core.laws.plan.pulse_model import AXES
from fsw.input.schema import TableError
from fsw.table.calibration import largest_field_nt
from fsw.table.config import flight_config
from fsw.table.table import flight_table

SWAPPED = [[0.0, -0.9, 0.05], [1.1, 0.03, 0.0], [0.02, 0.0, 1.2]]
"""Output 1 along axis 2, output 2 against axis 1."""
FIELD = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]
IDENTITY = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]


def config(**calibration):
    return flight_config(flight_table({"calibration": calibration}, "table.toml"))


def test_left_out_it_counts_for_nothing():
    plain = flight_table({}, "table.toml")
    assert plain.crc == 0 ^ flight_table({"calibration": {}}, "table.toml").crc
    assert flight_config(plain).calibration is NO_CALIBRATION
    assert flight_config(plain).own_field is None
    assert flight_config(plain).coils.pulses.coil_axes == AXES


def test_identity_costs_nothing():
    same = config(
        magnetometer={"offset_nt": [0.0, 0.0, 0.0], "matrix": IDENTITY},
        sun={"matrix": IDENTITY},
        coils={"matrix": IDENTITY},
    )
    assert same.calibration is NO_CALIBRATION
    assert same.coils.pulses.coil_axes == AXES


def test_what_is_given_counts_in_the_crc():
    plain = flight_table({}, "table.toml").crc
    given = flight_table({"calibration": {"magnetometer": {"offset_nt": [1.0, 0.0, 0.0]}}}, "table.toml").crc
    assert given != plain


def test_the_range_of_the_magnetometer_counts_by_itself():
    plain, said = (
        flight_table({"calibration": {"magnetometer": {"offset_nt": [1.0, 0.0, 0.0]} | more}}, "table.toml")
        for more in ({}, {"range_nt": 65000.0})
    )
    assert plain.crc != said.crc, "a key that is left out is in no table of before"
    assert config(magnetometer={"range_nt": 40000.0}).calibration.magnetometer.range_nt == 40000.0
    assert config(magnetometer={"offset_nt": [1.0, 0.0, 0.0]}).calibration.magnetometer.range_nt == 65000.0
    with pytest.raises(TableError, match=r"calibration.magnetometer.range_nt = 70000.0 is not allowed"):
        config(magnetometer={"range_nt": 70000.0})
    with pytest.raises(TableError, match=r"range_nt = 65.0 is not allowed"):
        config(magnetometer={"range_nt": 65.0})


def test_a_field_below_the_largest_saturates_no_axis_whatever_its_direction():
    offset, matrix = (
        np.array([31000.0, -24000.0, 900.0]),
        np.array([[0.96, 0.05, 0.0], [-0.04, 1.04, 0.02], [0.1, 0.0, 1.01]]),
    )
    strength = largest_field_nt(tuple(offset), tuple(map(tuple, matrix)), 60000.0)
    directions = np.random.default_rng(5).normal(size=(20000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    readings = offset + strength * directions @ np.linalg.inv(matrix).T
    assert 59900.0 < np.abs(readings).max() <= 60000.0


def test_coils_are_split_into_outputs_and_axes():
    found = config(coils={"matrix": SWAPPED})
    assert found.calibration.outputs.axis == (1, 0, 2)
    assert found.calibration.outputs.sign == (1, -1, 1)
    # along axis 1 output 2 in the other sense, along axis 2 output 1
    assert found.coils.pulses.coil_axes == ((0.9, -0.03, -0.0), (0.0, 1.1, 0.02), (0.05, 0.0, 1.2))
    commanded_along_1 = np.array(SWAPPED) @ (0.0, -1.0, 0.0)
    assert found.coils.pulses.coil_axes[0] == pytest.approx(commanded_along_1)


def test_a_current_without_a_level_has_the_sense_of_its_output():
    assert config().fdir.coils.stray_axes == AXES
    found = config(coils={"matrix": SWAPPED}).fdir.coils.stray_axes
    assert found == ((-0.9, 0.03, 0.0), (0.0, 1.1, 0.02), (0.05, 0.0, 1.2))


def test_the_field_of_the_coils_is_by_axis_and_late_by_whole_ticks():
    found = config(coils={"matrix": SWAPPED, "field_nt_per_am2": FIELD, "field_delay_s": 1.4}).own_field
    commanded_along_1 = np.array(FIELD) @ (0.0, -1.0, 0.0)
    assert np.array(found.field_nt_per_am2)[:, 0] == pytest.approx(commanded_along_1)
    assert (found.newest, found.oldest) == (1, 2)


@pytest.mark.parametrize(
    ("delay_s", "ages"),
    [(0.0, (0, 0)), (0.04, (0, 0)), (0.5, (0, 1)), (0.97, (1, 1)), (1.0, (1, 1)), (2.0, (2, 2))],
)
def test_a_delay_near_whole_ticks_is_one(delay_s, ages):
    found = config(coils={"field_nt_per_am2": FIELD, "field_delay_s": delay_s}).own_field
    assert (found.newest, found.oldest) == ages


@pytest.mark.parametrize(
    ("section", "values", "says"),
    [
        ("magnetometer", {"offset_nt": [3e5, 0.0, 0.0]}, "offset_nt must be three numbers"),
        (
            "magnetometer",
            {"matrix": [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]},
            "matrix must be regular",
        ),
        ("magnetometer", {"matrix": [[9.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]}, "0.2 to 5 long"),
        ("coils", {"matrix": [[1.0, 1.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 1.0]]}, "a column for each coil"),
        ("coils", {"field_delay_s": 1.0}, "field_delay_s needs field_nt_per_am2"),
        ("sun", {"matrix": [[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]}, "orthonormal"),
    ],
)
def test_a_planted_error_is_told(section, values, says):
    with pytest.raises(TableError, match=rf"calibration\.{section}.*{says}"):
        flight_table({"calibration": {section: values}}, "table.toml")


def test_a_continuous_driver_has_no_own_field_in_a_sample_but_axes():
    coils = {"driver": "continuous", "max_dipole_am2": 9.0}
    with pytest.raises(TableError, match="samples while it is off"):
        flight_table({"coils": coils, "calibration": {"coils": {"field_nt_per_am2": FIELD}}}, "table.toml")
    dipoles = flight_config(
        flight_table({"coils": coils, "calibration": {"coils": {"matrix": SWAPPED}}}, "table.toml")
    ).coils.dipoles
    assert np.array(dipoles.body_from_coils) @ np.array(dipoles.coils_from_body) == pytest.approx(np.eye(3))
    commanded_along_1 = np.array(SWAPPED) @ (0.0, -1.0, 0.0)
    assert np.array(dipoles.body_from_coils)[:, 0] == pytest.approx(commanded_along_1)
