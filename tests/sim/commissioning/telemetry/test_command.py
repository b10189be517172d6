"""``torquer telemetry``: words, document, page and exit codes; bad input is one sentence."""

import json
import re
import tomllib
from math import nan

import pytest
from click.testing import CliRunner
from recorded_samples import DATA, TLE

from sim.commissioning.telemetry.command import telemetry
from sim.errors import HarnessError
from torquer.cli.main import main

PASS = DATA / "s3_20240426T041442Z.csv"
CALIBRATION = DATA / "calibration.toml"


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """A minute of a pass: fast to follow, too short to be believed."""
    path = tmp_path_factory.mktemp("short") / "short.csv"
    path.write_text("\n".join(PASS.read_text().splitlines()[:71]) + "\n")
    return path


def run(*arguments):
    return CliRunner().invoke(main, ["telemetry", *map(str, arguments)])


def test_the_document_has_the_keys_that_are_documented(short):
    result = run(short, "--tle", TLE, "--calibration", CALIBRATION, "--json")
    assert result.exit_code == 1
    found = json.loads(result.stdout)
    assert found["command"] == "telemetry"
    assert found["converged"] is False
    assert found["rows"] == 70
    for key in ("field_norm_nt_rms", "field_direction_deg_rms", "rate_y_degps_mean", "gyro_y_degps_mean"):
        assert isinstance(found[key], float)
    assert set(found["coast_deg_rms"]) == {"10", "30", "60", "120"}
    assert found["coast_deg_rms"]["120"] is None
    assert found["sun_azimuth_deg"] == {"median": None, "rms": None, "rows": 0}


@pytest.mark.long
def test_the_rate_is_told_about_the_axis_of_the_spin_whichever_that_is(short, tmp_path):
    head, *rows = short.read_text().splitlines()
    after = dict(zip("xyz", "yzx", strict=True))
    turned_head = re.sub(r"\b(mag|gyro)_([xyz])_", lambda found: f"{found[1]}_{after[found[2]]}_", head)
    turned, page = tmp_path / "turned.csv", tmp_path / "page.html"
    turned.write_text("\n".join([turned_head, *rows]) + "\n")
    values = tomllib.loads(CALIBRATION.read_text())["calibration"]["magnetometer"]
    place = [2, 0, 1]
    offset_nt = [values["offset_nt"][one] for one in place]
    matrix = [[values["matrix"][one][other] for other in place] for one in place]
    known = tmp_path / "turned.toml"
    known.write_text(f"[calibration.magnetometer]\noffset_nt = {offset_nt}\nmatrix = {matrix}\n")
    said = run(turned, "--tle", TLE, "--calibration", known, "--page", page)
    assert re.search(r"rate about z: 6\d\.\d+ deg/s, by the gyro, not used, 64\.", said.stdout)
    assert "Rate about z" in page.read_text()
    found = json.loads(run(turned, "--tle", TLE, "--calibration", known, "--json").stdout)
    assert found["motions_degps"] == pytest.approx([65.5] * len(found["motions_degps"]), abs=2.0)


@pytest.mark.long
def test_the_words_say_what_was_not_used_and_the_page_is_written(short, tmp_path):
    page = tmp_path / "page.html"
    result = run(short, "--tle", TLE, "--calibration", CALIBRATION, "--page", page)
    assert result.exit_code == 1
    assert "by the gyro, not used, 64." in result.stdout
    assert "not converged: " in result.stdout
    text = page.read_text()
    assert "Not claimed: the absolute attitude" in text
    assert "<svg" in text
    assert "short" in text


@pytest.mark.long
@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("offset_nt = [98000.0, -29000.0, -28000.0]", "calibrated"),
        ("matrix = [[1.01, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]", "calibrated"),
        ("", "not calibrated"),
    ],
)
def test_the_page_says_whether_samples_are_calibrated(short, tmp_path, text, said):
    page, calibration = tmp_path / "page.html", tmp_path / "c.toml"
    calibration.write_text(f"[calibration.magnetometer]\n{text}\n")
    run(short, "--tle", TLE, "--calibration", calibration, "--page", page)
    assert (" not calibrated" in page.read_text()) is (said == "not calibrated")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("none.csv", "--tle", TLE), "none.csv: cannot be read (No such file or directory)"),
        ((PASS, "--tle", PASS), "there is no two-line element set in it"),
        ((PASS,), "Missing option '--tle'"),
        ((PASS, "--tle", TLE, "--calibration", TLE), "not TOML"),
        ((TLE, "--tle", TLE), "there is no column 'utc_unix_s'"),
        ((PASS, "--tle", TLE, "--start", "3"), "3.0 is not in the range"),
        ((PASS, "--tle", TLE, "--page", "/proc/none/x.html"), "cannot be written"),
    ],
)
def test_bad_input_is_one_sentence(arguments, said):
    result = run(*arguments)
    assert result.exit_code == 2
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert result.stdout == ""


@pytest.mark.parametrize("read", ["telemetry", "element sets", "calibration"])
def test_the_page_takes_the_place_of_nothing_that_is_read(short, tmp_path, read):
    copies = {
        "telemetry": (tmp_path / "q.csv", short),
        "element sets": (tmp_path / "t.txt", TLE),
        "calibration": (tmp_path / "c.toml", CALIBRATION),
    }
    for copy, original in copies.values():
        copy.write_bytes(original.read_bytes())
    recorded, elements, calibration = (copy for copy, _ in copies.values())
    page = copies[read][0]
    result = run(recorded, "--tle", elements, "--calibration", calibration, "--page", page)
    assert (result.exit_code, result.stdout) == (2, "")
    assert f"--page {page} and the {read} {page} are the same file: name another by --page" in result.stderr
    assert all(copy.read_bytes() == original.read_bytes() for copy, original in copies.values())


@pytest.mark.parametrize("start_s", [nan, 0.0, -20.0])
def test_a_start_of_no_time_is_refused(start_s):
    with pytest.raises(HarnessError, match="the filter starts from a positive number of seconds"):
        telemetry(PASS, TLE, None, None, start_s)


def test_old_elements_are_warned_of(short, tmp_path):
    old = tmp_path / "old.txt"
    old.write_text("\n".join(TLE.read_text().splitlines()[:3]))
    result = run(short, "--tle", old, "--calibration", CALIBRATION)
    assert "the nearest element set is 136 days away: its field may be off" in result.stderr


def test_a_pass_that_is_not_calibrated_and_not_followed_is_told_how_to(short):
    advice = "torquer calibrate finds what --calibration takes off them"
    assert advice in run(short, "--tle", TLE).stdout
    assert advice not in run(short, "--tle", TLE, "--calibration", CALIBRATION).stdout
