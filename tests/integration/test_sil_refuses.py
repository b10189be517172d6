"""What ``torquer sil`` refuses: one sentence on stderr, exit code 2, nothing written."""

import socket
from importlib import resources

import pytest

SIL = ("sil", "--orbits", "0.001")


@pytest.fixture
def refused(torquer, tmp_path, monkeypatch):
    """The sentence with which a command is refused, once it is sure that nothing came of it."""

    def run(*words):
        monkeypatch.chdir(tmp_path)
        before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")}
        done = torquer(*words)
        assert done.code == 2
        assert done.out == ""
        assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")} == before
        return done.sentence

    return run


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("nowhere",), ["nowhere", "microsat", "cubesat3u", "posat1"]),
        (("nowhere.toml",), ["nowhere.toml"]),
        (("--orbits", "-1"), ["--orbits", "-1"]),
        (("--orbits", "0"), ["--orbits", "0"]),
        (("--orbits", "nan"), ["--orbits", "nan"]),
        (("--orbits", "inf"), ["--orbits", "inf"]),
        (("--orbits", "1e12"), ["--orbits", "1e+12"]),
        (("--orbits", "many"), ["--orbits", "many"]),
        (("--seed", "-1"), ["--seed", "-1"]),
        (("--seed", "1.5"), ["--seed", "1.5"]),
        (("--pace", "fast"), ["--pace", "fast"]),
        (("--pace", "realtime:0"), ["--pace", "realtime:0"]),
        (("--pace", "realtime:-2"), ["--pace", "realtime:-2"]),
        (("--pace", "realtime:nan"), ["--pace", "realtime:nan"]),
        (("--pace", "realtime:"), ["--pace", "realtime:"]),
        (("--pace", "lockstep:2"), ["--pace", "lockstep:2"]),
        (("--bus", "can0"), ["can0"]),
        (("--bus", "virtual:1"), ["virtual"]),
        (("--bus", "loop:0"), ["loop:0"]),
        (("--bus", "loop:70000"), ["loop:70000"]),
        (("--bus", "loop:"), ["loop:"]),
        (("--bus", "socketcan"), ["socketcan"]),
        (("--bus", "socketcan:nowhere0"), []),
        (("--bus", "slcan:/dev/nowhere0"), []),
        (("--set", "time.tick_hz"), ["--set time.tick_hz", "KEY=VALUE"]),
        (("--set", "=3"), ["--set =3"]),
        (("--set", "time..tick_hz=3"), ["--set time..tick_hz=3"]),
        (("--set", "time.tick_hz=0"), ["time.tick_hz", "0", "1"]),
        (("--set", "time.tick_hz=fast"), ["time.tick_hz", "fast"]),
        (("--set", "time.tick_hz=1.5"), ["time.tick_hz", "1.5"]),
        (("--set", "orbit.along_track_km=1e5"), ["orbit.along_track_km", "20000"]),
        (("--set", "disturbance.torque_daily_part=2"), ["disturbance.torque_daily_part", "1"]),
        (("--set", "disturbance.remanence_part=-1"), ["disturbance.remanence_part", "0"]),
        (("--set", "flight.uncertainty.torque_nm=30"), ["[flight]: uncertainty.torque_nm = 30", "1.165e-05"]),
        (("--set", "sensors.sun.albedo=maybe"), ["sensors.sun.albedo", "maybe"]),
        (("--set", "time.tik_hz=1"), ["time.tik_hz", "not a known key"]),
        (("--set", "time=1"), ["time"]),
        (("--set", "time.epoch_utc=yesterday"), ["epoch_utc", "yesterday"]),
        (("--set", "orbit.altitude_km=100"), ["orbit.altitude_km", "100", "150"]),
        (("--set", "orbit.tle=[]"), ["orbit.tle"]),
        (("--set", 'orbit.tle=["1 2", "2 1"]'), ["orbit"]),
        (("--set", "body.inertia_kgm2=[1,1,3]"), ["body", "inertia_kgm2"]),
        (("--set", "coils.pulse_s=3.1"), ["coils.pulse_s", "3.1", "3"]),
        (("--set", "coils.backoff=none"), ["coils.backoff", "none", "shared", "per_coil"]),
        (("--set", "coils.levels_am2=[1,2]"), ["coils.levels_am2"]),
        (("--set", "sensors.sun.noise_deg=nan"), ["sensors.sun.noise_deg", "nan"]),
        (("--set", "initial.axis=[0,0,0]"), ["initial", "axis"]),
        (("--set", "flight.modes.near_deg=500"), ["[flight]", "modes.near_deg", "500", "180"]),
        (("--set", "knowledge=some"), ["knowledge", "some", "filter", "perfect"]),
        (("--set", "name=../../x"), ["name", "../../x", "letters, digits, '.', '_' and '-'"]),
        (("--set", "name=/tmp/x"), ["name", "/tmp/x"]),
        (("--set", r'name="a\u0000b"'), ["name", r"a\x00b"]),
        (("--set", "name=.."), ["name", ".."]),
        (("--set", f"name={'a' * 300}"), ["name", "at most 100"]),
        (("../scenarios/microsat",), ["no scenario", "../scenarios/microsat"]),
        (("--nothing",), ["--nothing"]),
        (("microsat", "posat1"), ["posat1"]),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else None,
)
def test_a_wrong_option_is_named(words, named, refused):
    sentence = refused(*SIL, *words)
    assert [name for name in named if name not in sentence] == []


def test_an_unknown_command_is_named(refused):
    assert "sail" in refused("sail")


def test_all_faults_of_a_scenario_file_are_named(refused, tmp_path):
    scenario = tmp_path / "mine.toml"
    scenario.write_text('name = "mine"\n[time]\ntick_hz = 0\n[body]\ninertia = 3\n')
    sentence = refused(*SIL, str(scenario))
    for fault in ("mine.toml", "time.tick_hz", "body.inertia is not a known key", "control is missing"):
        assert fault in sentence


def test_a_scenario_that_is_no_toml_is_named(refused, tmp_path):
    (tmp_path / "mine.toml").write_text("[time\n")
    assert "mine.toml" in refused(*SIL, "mine.toml")


@pytest.mark.parametrize(
    "words", [SIL, ("compare", "--orbits", "0.001"), ("design",), ("hil", "--seconds", "1")]
)
def test_a_name_that_leads_elsewhere_is_named_with_its_file(words, refused, tmp_path):
    """It becomes a part of the path of what is written."""
    scenario = resources.files("sim.scenario.shipped").joinpath("microsat.toml").read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(scenario.replace('name = "microsat"', 'name = "../../x"'))
    sentence = refused(*words, "mine.toml")
    assert "mine.toml: name: '../../x' is not allowed: allowed are letters, digits" in sentence


@pytest.mark.parametrize("content", ["run.json", "bus.log"])
def test_a_run_is_not_overwritten(content, refused, tmp_path):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / content).write_text("kept")
    assert f"{tmp_path / 'run'} already holds a run" in refused(*SIL, "--out", tmp_path / "run")


def test_a_file_is_no_run_directory(refused, tmp_path):
    (tmp_path / "file").write_text("kept")
    assert str(tmp_path / "file") in refused(*SIL, "--out", tmp_path / "file")


@pytest.mark.parametrize("bus", ["loop", "virtual", "socketcan:nowhere0"])
def test_a_directory_that_cannot_be_made_is_named(bus, refused):
    where = "/dev/null" if bus.startswith("s") else "/dev/null/run"
    assert bus.startswith("s") or "/dev/null/run" in refused(*SIL, "--bus", bus, "--out", where)


@pytest.mark.long
@pytest.mark.slow
def test_a_port_that_others_use_is_named(refused):
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        assert str(port) in refused(*SIL, "--bus", f"loop:{port}")
