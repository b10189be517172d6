"""A recorded pass is read whole, or one sentence says what and where is wrong."""

import numpy as np
import pytest

from sim.commissioning.recorded.recorded_pass import in_longest_order, read_pass
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


class TestOfAFewRowsThatAreOfNoUse:
    """They are left out, with a word on each; more than a tenth are not."""

    GOOD = tuple(f"{1700000000 + n},{n % 7},-2,3,0.1,0.2,0.3,{n},0" for n in range(40))

    def read(self, folder, changed):
        rows = list(self.GOOD)
        for place, row in changed.items():
            rows[place] = row
        return read_pass(written(folder, *rows))

    @pytest.mark.parametrize("place", [0, 1, 20, 38, 39])
    @pytest.mark.parametrize(
        ("spoilt", "why"),
        [
            ("{t},x,-2,3,0.1,0.2,0.3,7,0", "with a field that is no number, or with fields missing"),
            ("{t},1,nan,3,0.1,0.2,0.3,7,0", "with a field that is no number, or with fields missing"),
            ("{t},1,-2", "with a field that is no number, or with fields missing"),
            (",1,-2,3,0.1,0.2,0.3,7,0", "without a time"),
            ("-999999,1,-2,3,0.1,0.2,0.3,7,0", None),
            ("0,1,-2,3,0.1,0.2,0.3,7,0", None),
            ("9e9,1,-2,3,0.1,0.2,0.3,7,0", None),
        ],
    )
    def test_one_is_as_if_it_had_not_been_there(self, tmp_path, place, spoilt, why):
        found = self.read(tmp_path, {place: spoilt.format(t=1700000000 + place)})
        np.testing.assert_array_equal(found.lines, [n + 2 for n in range(40) if n != place])
        np.testing.assert_array_equal(found.utc_unix_s - 1.7e9, [n for n in range(40) if n != place])
        (left_out,) = found.left_out
        assert left_out.lines == (place + 2,)
        assert left_out.why == why or why is None
        assert found.said_left_out() == f"1 of 40 rows left out: 1 {left_out.why} (line {place + 2})"

    def test_a_fill_value_over_a_stretch_too(self, tmp_path):
        for places in (range(4), range(17, 21), range(36, 40)):
            found = self.read(tmp_path, dict.fromkeys(places, "65535,1,-2,3,0.1,0.2,0.3,7,0"))
            assert set(found.lines) == {n + 2 for n in range(40) if n not in places}

    def test_a_row_out_of_order_costs_that_row_alone(self, tmp_path):
        found = self.read(tmp_path, {10: "1700000025,1,-2,3,0.1,0.2,0.3,7,0"})
        assert [(one.why, one.lines) for one in found.left_out] == [("whose time is out of order", (12,))]

    def test_a_row_that_is_there_twice_counts_once(self, tmp_path):
        found = read_pass(written(tmp_path, *(row for row in self.GOOD for _ in range(2))))
        assert found.said_left_out().startswith("40 of 80 rows left out: 40 that repeat another (lines 3, 5")
        np.testing.assert_array_equal(found.utc_unix_s - 1.7e9, range(40))

    def test_more_than_a_tenth_are_refused_with_their_number(self, tmp_path):
        for row, said in (
            (
                "x,1,-2,3,0.1,0.2,0.3,7,0",
                "line 2, column 'utc_unix_s': 'x' is no finite number; 5 of 40 rows",
            ),
            ("5,1,-2", "line 2 has 3 fields, the first line 9; 5 of 40 rows are like that"),
        ):
            with pytest.raises(HarnessError, match=said):
                self.read(tmp_path, dict.fromkeys(range(5), row))
        with pytest.raises(HarnessError, match="must not go back; 5 of 40 rows are like that"):
            self.read(tmp_path, dict.fromkeys(range(10, 15), "5,1,-2,3,0.1,0.2,0.3,7,0"))

    def test_sessions_hours_apart_are_kept(self, tmp_path):
        rows = [row.replace("17000000", "17000090", 1) if n > 19 else row for n, row in enumerate(self.GOOD)]
        assert read_pass(written(tmp_path, *rows)).left_out == ()

    @pytest.mark.parametrize(
        ("times_s", "left_out"),
        [((4, 1, 5, 6, 7), 1), ((1, 2, 3, 9, 4), 3), ((1, 2, 9, 3, 4), 2), ((1, 2, 3, 1, 4), 3)],
    )
    def test_of_two_orders_that_of_most_times_and_the_least_span_is_kept(self, times_s, left_out):
        kept = in_longest_order(np.array(times_s, dtype=float))
        assert np.flatnonzero(~kept).tolist() == [left_out]

    def test_of_all_orders_the_longest_is_kept_and_then_that_of_most_times(self):
        assert in_longest_order(np.array([1.0, 2, 1, 3])).tolist() == [True, True, False, True]
        assert in_longest_order(np.array([5.0, 1, 1, 2, 9, 3])).tolist() == [
            False,
            True,
            True,
            True,
            False,
            True,
        ]
