"""A recorded pass is read whole, or one sentence says what and where is wrong."""

import numpy as np
import pytest

from sim.commissioning.recorded.recorded_pass import read_pass
from sim.errors import HarnessError

HEAD = "utc_unix_s,mag_x_ut,mag_y_ut,mag_z_ut,gyro_x_degps,gyro_y_degps,gyro_z_degps,sun_cell_2_raw,note"
ROWS = (
    "1700000000,1.5,-2,3,0.1,0.2,0.3,7,0",
    "1700000001,1.6,,3,0.1,0.2,0.3,8,0",
    "1700000001,1.7,-2,3,0.1,0.2,0.3,9,0",
    "1700000004,1.8,-2,3,0.1,0.2,,,0",
    "1700000005,1.9,-2,3,0.1,0.2,0.3,11,0",
)


def written(folder, *rows, head=HEAD):
    path = folder / "a.csv"
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


def test_units_are_converted_and_empty_fields_are_no_numbers(tmp_path):
    found = read_pass(written(tmp_path, *ROWS))
    np.testing.assert_array_equal(found.utc_unix_s - 1.7e9, [0, 1, 1, 4, 5])
    np.testing.assert_allclose(found.mag_nt[0], [1500.0, -2000.0, 3000.0])
    assert np.isnan(found.mag_nt[1, 1])
    assert np.isnan(found.gyro_degps[3, 2])
    np.testing.assert_array_equal(found.cells["2"], [7, 8, 9, np.nan, 11])
    assert (found.name, found.unused, found.temperature_degc) == ("a", ("note",), None)
    assert found.middle_unix_s == 1.7e9 + 2.5


def test_columns_that_mean_nothing_here_may_hold_anything(tmp_path):
    rows = [row[:-1] + text for row, text in zip(ROWS, ("NOMINAL", "", "inf", "12:00", "0"), strict=True)]
    found, plain = (read_pass(written(tmp_path, *one)) for one in (rows, ROWS))
    assert found.unused == ("note",)
    np.testing.assert_array_equal(found.mag_nt, plain.mag_nt)


def test_a_cell_in_two_units_is_refused(tmp_path):
    with pytest.raises(HarnessError, match="there are two columns of cell '2', 'sun_cell_2_ma' is one of"):
        read_pass(written(tmp_path, *ROWS, head=HEAD.replace("note", "sun_cell_2_ma")))


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (
            (ROWS[0], "1700000002,x,2,3,0,0,0,0,0", *ROWS[3:]),
            "line 3, column 'mag_x_ut': 'x' is no finite number",
        ),
        ((ROWS[0], "1700000002,inf,2,3,0,0,0,0,0", *ROWS[3:]), "'inf' is no finite number"),
        ((ROWS[0], "1700000002,1,2,3", *ROWS[3:]), "line 3 has 4 fields, the first line 9"),
        (
            (ROWS[0], "", ROWS[3], ROWS[1]),
            "line 5, column 'utc_unix_s': 1700000001 after 1700000004; times must not go back",
        ),
        ((ROWS[0], ",1,2,3,0,0,0,0,0", ROWS[1]), "column 'utc_unix_s': an empty field"),
        (ROWS[:2], "2 rows are too few"),
        ((*ROWS[:2], "1800000000,1.5,-2,3,0.1,0.2,0.3,7,0"), "the rows span 1157 days"),
        ([row.replace(",-2,", ",,") for row in ROWS], "fewer than 3 rows have a field sample"),
        (3 * ROWS[:1], "all field samples are equal"),
    ],
)
def test_bad_rows_are_named(tmp_path, rows, said):
    with pytest.raises(HarnessError) as error:
        read_pass(written(tmp_path, *rows))
    assert str(error.value).startswith(str(tmp_path / "a.csv"))
    assert said in str(error.value)
    assert error.value.exit_code == 2


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "it is empty"),
        (b"\xff\xfe\x00", "it begins with the mark of UTF-16-LE, and is cut"),
        (b"utc_unix_s,mag_x_nt\n1,2\n", "there is no column 'mag_y_nt'"),
        (b'utc_unix_s,"mag\n', "there is no column"),
    ],
)
def test_a_file_that_is_none_is_said_to_be_none(tmp_path, content, said):
    path = tmp_path / "a.csv"
    path.write_bytes(content)
    with pytest.raises(HarnessError) as error:
        read_pass(path)
    assert said in str(error.value)


def test_a_missing_file_and_a_folder_are_said_to_be_so(tmp_path):
    for path, said in ((tmp_path / "none.csv", "No such file"), (tmp_path, "Is a directory")):
        with pytest.raises(HarnessError) as error:
            read_pass(path)
        assert said in str(error.value)
