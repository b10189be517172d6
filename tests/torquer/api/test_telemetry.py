"""``torquer.telemetry``: the filter over a recorded pass, for programs."""

import json

import pytest
from recorded_samples import DATA, TLE

import torquer

CALIBRATION = DATA / "calibration.toml"


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """A minute of a pass: fast to follow, too short to be believed."""
    path = tmp_path_factory.mktemp("short") / "short.csv"
    rows = (DATA / "s3_20240426T041442Z.csv").read_text().splitlines()
    path.write_text("\n".join(rows[:71]) + "\n")
    return path


def test_it_is_what_the_command_prints(short, command):
    found = torquer.telemetry(short, tle=TLE, calibration=CALIBRATION)
    words = ("telemetry", short, "--tle", TLE, "--calibration", CALIBRATION)
    assert command(*words).stdout == f"{found}\n"
    printed = json.loads(command(*words, "--json").stdout)
    assert printed | json.loads(json.dumps(found.values)) == printed
    assert not found.ok
    assert found.reason in str(found)
    assert found.rate_degps[1] == pytest.approx(64.0, abs=3.0)


@pytest.mark.long
def test_the_page_is_written(short, tmp_path):
    found = torquer.telemetry(short, tle=TLE, calibration=CALIBRATION, page=tmp_path / "pass.html")
    assert str(found).endswith(f"page: {tmp_path / 'pass.html'}")
    assert (tmp_path / "pass.html").is_file()


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"tle": "none.txt"}, "none.txt: cannot be read"),
        ({"start_s": 3.0}, "telemetry: start_s"),
        ({"page": TLE}, "are the same file"),
    ],
)
def test_a_wrong_argument_is_one_sentence(short, given, sentence):
    before = TLE.read_bytes()
    with pytest.raises(torquer.InputError, match=sentence) as caught:
        torquer.telemetry(short, **{"tle": TLE} | given)
    assert "\n" not in str(caught.value)
    assert TLE.read_bytes() == before
