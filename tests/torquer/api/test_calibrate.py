"""``torquer.calibrate``: by a run and by recorded telemetry, for programs."""

import json

import pytest
from recorded_samples import DATA, TLE

import torquer

PASS = DATA / "s3_20240426T041442Z.csv"


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    """Three minutes of a pass."""
    path = tmp_path_factory.mktemp("short") / "short.csv"
    path.write_text("\n".join(PASS.read_text().splitlines()[:181]) + "\n")
    return path


@pytest.mark.long
def test_telemetry_is_calibrated_as_by_the_command(short, command, tmp_path):
    found = torquer.calibrate(short, tle=TLE, out=tmp_path / "a.toml")
    words = ("calibrate", short, "--tle", TLE, "--out", tmp_path / "b.toml")
    result = command(*words)
    assert result.stdout.replace("b.toml", "a.toml") == f"{found}\n"
    assert result.exit_code == int(not found.ok)
    assert (tmp_path / "a.toml").read_bytes() == (tmp_path / "b.toml").read_bytes()
    assert found.written == tmp_path / "a.toml"
    assert set(found.magnetometer["b_x"]) == {"value", "sigma", "told"}


@pytest.mark.long
@pytest.mark.slow
def test_a_run_is_calibrated_as_by_the_command(command, tmp_path):
    run = torquer.fly("microsat", set={"control.law": "phasing"}, orbits=0.2, out=tmp_path / "run")
    found = torquer.calibrate(run, out=tmp_path / "mine.toml")
    result = command("calibrate", run.path, "--json")
    printed = json.loads(result.stdout)
    values = json.loads(json.dumps({**found.values, "out": None}))
    assert printed | values == printed
    assert len(found.magnetometer["matrix"]) == 3


@pytest.mark.parametrize(
    ("source", "given", "sentence"),
    [
        (PASS, {}, "recorded telemetry needs --tle FILE"),
        (PASS, {"tle": TLE}, "recorded telemetry needs --out FILE"),
        (PASS, {"scenario": "microsat"}, "--scenario: recorded telemetry in .* without a scenario"),
        (PASS, {"tle": TLE, "out": TLE}, "are the same file"),
        (PASS, {"tle": TLE, "out": "a.toml", "inertia_ratios": (1.0, 1.0, 3.0)}, "no body has the moments"),
        ("run", {"tle": TLE, "parameters": 12}, "--tle, --parameters: run is no PASS.csv"),
        ("run", {"parameters": 10}, "calibrate: parameters"),
        ("run", {}, "run does not exist"),
    ],
)
def test_a_wrong_argument_is_one_sentence(source, given, sentence, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(torquer.InputError, match=sentence) as caught:
        torquer.calibrate(source, **given)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())
