"""Of many element sets the nearest is taken, whatever stands between them."""

import pytest
from recorded_samples import TLE

from sim.commissioning.recorded.element_sets import nearest_elements
from sim.errors import HarnessError

LINES = TLE.read_text().splitlines()
OTHER = (
    "1 25544U 98067A   20062.59097222  .00016717  00000-0  10270-3 0  9003",
    "2 25544  51.6442 147.1064 0004607  95.6506 329.8285 15.49249062  2422",
)


@pytest.mark.parametrize(
    ("unix_s", "epoch"), [(1702e6, 1702321485), (1711e6, 1710438527), (1800e6, 1713270618)]
)
def test_the_nearest_is_taken(unix_s, epoch):
    found = nearest_elements(TLE, unix_s)
    assert found.epoch_unix_s == pytest.approx(epoch, abs=90000)
    assert found.age_days(found.epoch_unix_s + 86400.0 * 1.5) == 1.5
    distances = [
        abs(nearest_elements(TLE, other).epoch_unix_s - unix_s) for other in (1702e6, 1711e6, 1800e6)
    ]
    assert abs(found.epoch_unix_s - unix_s) == min(distances)


def test_names_comments_and_blank_lines_do_not_matter(tmp_path):
    path = tmp_path / "tle.txt"
    path.write_text("# sets\n\nSAT A\n" + "\n".join(LINES[1:3]) + "\n\n0 SAT A\n" + "\n".join(LINES[4:6]))
    assert nearest_elements(path, 1711e6).epoch_unix_s == nearest_elements(TLE, 1711e6).epoch_unix_s


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ([], "there is no two-line element set in it"),
        (LINES[1:2], "after line 1 its second element line is missing"),
        ([LINES[1][:-1] + "0", LINES[2]], "line 1: element line 1 has checksum 0 but adds up to 7"),
        ([*LINES[1:3], *OTHER], "it holds sets of 2 satellites (25544, 52191): keep one"),
        ([LINES[1][:-3], LINES[2]], "line 1 is no element line of 69 characters"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path, lines, said):
    path = tmp_path / "tle.txt"
    path.write_text("\n".join(lines))
    with pytest.raises(HarnessError) as error:
        nearest_elements(path, 1712e6)
    assert said in str(error.value)


def test_a_missing_file_is_said_to_be_so(tmp_path):
    with pytest.raises(HarnessError, match="cannot be read"):
        nearest_elements(tmp_path / "none.txt", 0.0)
