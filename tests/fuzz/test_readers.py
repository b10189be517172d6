"""Whatever a file holds that a command reads: it is used, or refused in one sentence; never a traceback.

Forty mutations of each kind of file, as a rule; ``make fuzz`` gives ten thousand. A command that is refused
ends with exit code 2, one whose verdict is that a log is cut or altered with 1; each in 5 s.
"""

import hashlib
import json
import os
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from judged_commands import judged, torquer

import fsw.__main__
import hil_stub.__main__
from fsw.input import command_line
from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.one_run import Keep, RunTask
from sim.campaign.results.store import open_results
from sim.report import conclude
from sim.scenario.schema import load
from sim.validate.reference.reference import CHECKS, ELEMENTS
from sim.validate.reference.reference_table import DATA

ROOT = Path(__file__).resolve().parents[2]
MUTATIONS = int(os.environ.get("TORQUER_FUZZ_MUTATIONS", "40"))
fuzzed = settings(max_examples=MUTATIONS, deadline=None, suppress_health_check=list(HealthCheck))
few = settings(fuzzed, max_examples=max(5, MUTATIONS // 10))


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A run of 30 ticks; its files as bytes, by name."""
    path = tmp_path_factory.mktemp("flown") / "run"
    assert torquer("sil", "--seed", 7, "--orbits", 0.005, "--bus", "virtual", "--out", path)[0] == 0
    told = json.loads((path / "run.json").read_text())
    (path / "run.json").write_text(json.dumps({**told, "digests": {}}))  # which would tell before it is read
    return {file.name: file.read_bytes() for file in path.iterdir() if file.name != "report.html"}


@pytest.fixture
def run(flown, tmp_path):
    """A copy of that run, to be altered."""
    folder = tmp_path / "run"
    folder.mkdir()
    for name, content in flown.items():
        (folder / name).write_bytes(content)
    return folder


@pytest.fixture
def no_charts(monkeypatch):
    """They take a second."""
    monkeypatch.setattr("sim.report.charts.sections.sections", lambda *given: [])


CHECK, REPLAY, PLANT, REPORT = ("check",), ("replay",), ("replay", "--plant"), ("report",)
READ_BY = {
    "run.json": (REPLAY, PLANT, REPORT),
    "scenario.toml": (CHECK, REPLAY, PLANT, REPORT),
    "bus.log": (CHECK, REPLAY, PLANT, REPORT),
    "bus.log.index": (CHECK, REPLAY, PLANT, REPORT),
    "truth.h5": (REPORT,),
}


@pytest.mark.long
@pytest.mark.parametrize("name", READ_BY)
@pytest.mark.usefixtures("no_charts")
@pytest.mark.slow
def test_a_file_of_a_run(run, flown, mutated, name):
    @fuzzed
    @given(mutated(flown[name]), st.sampled_from(READ_BY[name]))
    def mutate(content, words):
        command, *options = words
        (run / name).write_bytes(content)
        if name == "scenario.toml":
            told = {**json.loads(flown["run.json"]), "scenario_sha256": hashlib.sha256(content).hexdigest()}
            (run / "run.json").write_text(json.dumps(told))
        torquer(command, run, *options)
        for other in set(flown) - {name}:  # report has written some anew
            (run / other).write_bytes(flown[other])

    mutate()


@pytest.mark.long
@pytest.mark.usefixtures("no_charts")
def test_run_json_with_any_key_gone_or_of_another_type(run, flown):
    """Each key that is read, at any depth, without one and with a value of each other type."""
    required = [
        "schema_version",
        "torquer_version",
        "scenario",
        "scenario_sha256",
        "flight_table_crc",
        "seed",
    ]
    required += ["ticks", "bus", "pace", "pace_factor", "platform", "complete"]
    nested = [("platform", "python"), ("platform", "machine"), ("flown", "ticks"), ("flown", "wall_s")]
    for path in [*((key,) for key in required), *nested]:
        for value in (GONE, None, True, -1, 10**400, 1.5, "x", "\ud800", [], {}):
            told = json.loads(flown["run.json"])
            change(told, path, value)
            (run / "run.json").write_text(json.dumps(told))
            code, _, said = torquer("report", run)
            if value is GONE and path[0] in required:
                assert code == 2
                assert path[-1] in said
                assert "run.json" in said
                assert torquer("replay", run)[0] == 2


GONE = object()


def change(told, path, value):
    for key in path[:-1]:
        told = told[key]
    told[path[-1]] = value
    if value is GONE:
        del told[path[-1]]


@pytest.mark.long
def test_histories_that_no_plant_has(run, flown):
    """Well-formed files with any numbers in them, which are drawn."""
    numbers = st.sampled_from(
        [0.0, -0.0, 1.0, -1.0, 1e-300, 5e-324, 1e15, -1e15, 1e16, 1e300, np.nan, np.inf]
    )

    @few
    @given(st.lists(st.tuples(st.integers(0, 10**6), st.integers(0, 10**6), numbers), min_size=1, max_size=6))
    def write(altered):
        (run / "truth.h5").write_bytes(flown["truth.h5"])
        with h5py.File(run / "truth.h5", "r+") as file:
            names = []
            file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
            for which, row, value in altered:
                dataset = file[names[which % len(names)]]
                dataset[row % len(dataset)] = value
        torquer("report", run)

    write()


@pytest.mark.long
@fuzzed
@given(st.data())
def test_a_scenario(mutated, scenario_file, data):
    name = data.draw(st.sampled_from(["microsat", "cubesat3u", "posat1", "kalman-1u"]))
    whole = (ROOT / "sim" / "scenario" / "shipped" / f"{name}.toml").read_bytes()
    scenario_file.write_bytes(data.draw(mutated(whole)))
    fly(scenario_file, scenario_file)


def fly(scenario_file, *words):
    """Three ticks or more."""
    out = scenario_file.parent / "out"
    shutil.rmtree(out, ignore_errors=True)
    return torquer("sil", *words, "--orbits", "0.0005", "--bus", "virtual", "--out", out)


@pytest.fixture
def scenario_file(tmp_path, monkeypatch):
    """Where a scenario is written to; its flights have no report."""
    monkeypatch.setattr(conclude, "write_report", lambda path, *rest: None)
    return tmp_path / "mine.toml"


def leaves(values, above=()):
    for key, below in values.items():
        yield from leaves(below, (*above, key)) if isinstance(below, dict) else [(*above, key)]


SHIPPED = load("microsat").model_dump(mode="json")
KEYS = [
    *sorted(".".join(key) for key in leaves(SHIPPED)),
    "orbit.altitude_km", "flight.modes.recover_s", "flight.uncertainty.torque_nm",
    "flight.fdir.false_alarm_days",
    "flight.telemetry.attitude_s", "flight.coils.levels_am2", "flight.body.inertia_kgm2",
    "control.gains.lqr.rate", "disturbance.drag.density_scale", "sensors.sun.fov_half_deg",
]  # fmt: skip
NUMBERS = st.sampled_from([
    "0", "1", "-1", "3", "1e-18", "-1e-18", "1e15", "-1e15", "1e12", "1e9", "1e6", "1e3", "0.001", "1e308",
    "5e-324", "nan", "inf", "-inf", "9" * 6000, "0x" + "f" * 6000, "1e400", "true", "'x'", "[]", "{}",
    "1979-05-27", "9999-12-31", "2100-01-01T00:00:00Z", "0001-01-01T00:00:00Z",
    "2030-06-01T00:00:00.5Z", '"\\u0000"', "[" * 50000,
])  # fmt: skip


@pytest.mark.long
@fuzzed
@given(
    st.lists(st.tuples(st.sampled_from(KEYS), st.sampled_from([1, 1, 3, 9]), NUMBERS), min_size=1, max_size=3)
)
def test_settings_of_any_magnitude(scenario_file, chosen):
    shown = {1: "{0}", 3: "[{0}, {0}, {0}]", 9: "[[{0}, 0, 0], [0, {0}, 0], [0, 0, {0}]]"}
    given_settings = [f"{key}={shown[count].format(number)}" for key, count, number in chosen]
    words = [word for setting in given_settings for word in ("--set", setting)]
    fly(scenario_file, "microsat", *words)


TLE = SHIPPED["orbit"]["tle"] or load("posat1").model_dump()["orbit"]["tle"]


@pytest.mark.long
@fuzzed
@given(st.data())
def test_orbit_elements(mutated, scenario_file, data):
    lines = [data.draw(mutated(line.encode())).decode("latin-1") for line in TLE]
    if data.draw(st.booleans()):
        lines = [sealed(line) for line in lines]
    fly(scenario_file, "microsat", "--set", f"orbit.tle={json.dumps(lines)}")


def sealed(line):
    """The line with the checksum that it needs."""
    return line[:68] + str(sum(int(c) if c in "0123456789" else c == "-" for c in line[:68]) % 10)


CAMPAIGN = """
scenario = "microsat"
runs = 2
orbits = 0.0005

[[disperse]]
key = "sensors.magnetometer.bias_nt"
distribution = "normal"
mean = 0.0
sigma = [10.0, 20.0, 30.0]

[[disperse]]
keys = ["initial.angle_deg", "initial.axis.2"]
distribution = "correlated"
mean = [40.0, 1.0]
covariance = [[1.0, 0.01], [0.01, 0.1]]
"""


@pytest.mark.long
@pytest.mark.parametrize("name", ["campaign.toml", "results.sqlite"])
@pytest.mark.slow
def test_a_campaign_of_which_a_run_flies_again(mutated, scenario_file, tmp_path, name):
    folder, out = tmp_path / "campaign", tmp_path / "out"
    folder.mkdir()
    campaign = load_campaign(str(write(tmp_path / "file.toml", CAMPAIGN)), {}, {})
    campaign.write(folder)
    with open_results(folder, campaign) as results:
        results.add(RunTask(campaign, Keep.NONE, folder).fly(0))
    whole = (folder / name).read_bytes()

    @fuzzed
    @given(mutated(whole))
    def mutate(content):
        for left in folder.glob("results.sqlite-*"):
            left.unlink()
        (folder / name).write_bytes(content)
        shutil.rmtree(out, ignore_errors=True)
        torquer("sil", "--from", folder, "--run", 0, "--bus", "virtual", "--out", out)

    assert torquer("sil", "--from", folder, "--run", 0, "--bus", "virtual", "--out", out)[0] == 0
    mutate()


@pytest.mark.long
def test_a_flight_table(mutated, tmp_path):
    whole = (ROOT / "fsw" / "flight.toml").read_bytes()

    @fuzzed
    @given(mutated(whole))
    def mutate(content):
        (tmp_path / "table.toml").write_bytes(content)
        words = ["--table", str(tmp_path / "table.toml"), "--bus", "none"]
        code, _, said = judged(lambda: command_line.run(fsw.__main__.main, "fsw", words))
        assert (code, said.startswith("fsw: ")) == (2, True)

    mutate()


SCRIPT = b"""[[step]]
t_s = 0
field_nt = [20000.0, 0, -30000]
sun = [1, 0, 0]

[[step]]
t_s = 12.5
field_nt = false
sun = [0.0, 0.6, 0.8]
"""


@pytest.mark.long
@pytest.mark.parametrize("name", ["script.toml", "bus.log"])
@pytest.mark.parametrize("sensor", ["magnetometer", "sun"])
def test_a_stimulus(mutated, flown, tmp_path, name, sensor):
    @fuzzed
    @given(mutated(SCRIPT if name == "script.toml" else flown["bus.log"]))
    def mutate(content):
        (tmp_path / name).write_bytes(content)
        words = [sensor, "--bus", "none", "--stimulus", str(tmp_path / name)]
        assert judged(lambda: hil_stub.__main__.main(words))[0] == 2

    mutate()


def write(path, text):
    path.write_text(text)
    return path


@pytest.mark.long
@pytest.mark.parametrize("pattern", [*CHECKS, ELEMENTS])
def test_reference_data(mutated, tmp_path, pattern):
    """The first rows of each file; the header is of the check, so that it is altered too."""
    whole = sorted(DATA.glob(pattern))[-1]
    lines = whole.read_bytes().splitlines(keepends=True)
    names = next((place for place, line in enumerate(lines) if not line.startswith(b"#")), 0)
    head = b"".join(lines[: names + 4])

    @(few if pattern == "floquet.csv" else fuzzed)
    @given(mutated(head))
    def mutate(content):
        (tmp_path / whole.name).write_bytes(content)
        torquer("validate", "--reference", tmp_path, "--workers", "1")

    mutate()
