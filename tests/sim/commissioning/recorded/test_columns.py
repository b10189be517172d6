"""Columns say quantity, axis and unit, in any order; what is missing is named."""

import pytest

from sim.commissioning.recorded.columns import places

HEAD = [
    "row",
    "mag_z_nt",
    "utc_unix_s",
    "mag_x_nt",
    "gyro_y_radps",
    "mag_y_nt",
    "gyro_x_radps",
    "gyro_z_radps",
]


def test_each_quantity_is_found_by_its_name():
    found = places([*HEAD, "sun_cell_2_raw", "sun_cell_left_ma", "temperature_degc"])
    assert found.time == 2
    assert found.field == (3, 5, 1)
    assert found.gyro == (6, 4, 7)
    assert found.cells == {"2": 8, "left": 9}
    assert found.temperature == 10
    assert found.unused == ("row",)
    assert found.gyro_factor == pytest.approx(57.29577951)


@pytest.mark.parametrize(("unit", "factor"), [("nt", 1.0), ("ut", 1e3), ("mg", 100.0), ("t", 1e9)])
def test_the_unit_of_the_field_is_in_its_name(unit, factor):
    assert places(["utc_unix_s", *(f"mag_{axis}_{unit}" for axis in "xyz")]).field_factor == factor


def test_gyros_cells_and_temperature_may_be_absent():
    found = places(["utc_unix_s", "mag_x_nt", "mag_y_nt", "mag_z_nt"])
    assert (found.gyro, found.cells, found.temperature, found.unused) == (None, {}, None, ())


@pytest.mark.parametrize(
    ("head", "said"),
    [
        (["mag_x_nt", "mag_y_nt"], "there is no column 'utc_unix_s'; line 1 names 'mag_x_nt, mag_y_nt'"),
        (["utc_unix_s;mag_x_nt"], "there is no column 'utc_unix_s'"),
        (["utc_unix_s;mag_x_nt"], "line 1 names 'utc_unix_s;mag_x_nt'"),
        (["utc_unix", "mag_x_nt", "mag_y_nt", "mag_z_nt"], "(did you mean 'utc_unix'?)"),
        (["utc_unix_s", "mag_x_nt", "mag_y_nt"], "there is no column 'mag_z_nt'"),
        (["utc_unix_s", "mag_x_nt", "mag_y_nt", "mag_z_ut"], "there is no column 'mag_z_nt'"),
        (["utc_unix_s", "b_x"], "there is no column 'mag_x_nt'; units of it are nt, ut, mg, t"),
        (["utc_unix_s", "utc_unix_s"], "there are two columns 'utc_unix_s'"),
        (HEAD[:-1], "there is no column 'gyro_z_radps'"),
    ],
)
def test_what_is_missing_is_named(head, said):
    with pytest.raises(ValueError, match="column") as error:
        places(head)
    assert said in str(error.value)
