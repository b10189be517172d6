"""``torquer calibrate`` of a run: what it writes, of a poor log too, and what it leaves as it is."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from click.testing import CliRunner

from fsw.wire.candump_line import format_line, format_time
from fsw.wire.messages import Sync
from sim.commissioning.calibrate.flown import command
from sim.commissioning.calibrate.flown.coil_field import coil_response
from sim.commissioning.calibrate.flown.joint_fit import FitPrior, joint_fit
from sim.commissioning.calibrate.flown.run_fit import RunCalibration
from sim.commissioning.calibrate.flown.wiring import RIGHT
from sim.scenario.schema import load
from torquer.cli.main import main

RESPONSE = np.array([[1800.0, -300.0, 90.0], [-700.0, 40.0, 2500.0], [250.0, -1900.0, -600.0]])
SCENARIO = tomli_w.dumps(load("microsat").model_dump(mode="json", exclude_none=True))


def run(*arguments):
    return CliRunner().invoke(main, ["calibrate", *map(str, arguments)])


def write_run(folder, unix_s=1_742_428_800):
    """A run directory with a log of ten SYNC."""
    folder.mkdir()
    ticks = [
        format_line(format_time(tick * 10**6), "can0", Sync(tick, unix_s + tick).encode())
        for tick in range(10)
    ]
    (folder / "bus.log").write_text("".join(ticks))
    (folder / "scenario.toml").write_text(SCENARIO)
    return folder


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture
def a_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return write_run(tmp_path / "flown")


@pytest.fixture(scope="session")
def good(observed, pulsed):
    """A calibration that lacks the dipoles of the coils alone."""
    field = joint_fit(observed(noise_nt=50.0, sun_noise=0.002), FitPrior(np.eye(3), 0.1, 1e5))
    response = coil_response(pulsed(RESPONSE, 1.4, noise_nt=200.0), (0.5, 2.0, 8.0))
    return RunCalibration(
        wiring=RIGHT,
        field=field,
        response=response,
        field_nt_per_am2=field.matrix @ response.nt_per_am2,
        field_sigma=response.sigma,
        coils=None,
        widened=1.0,
        tick=np.arange(len(field.residual_nt)),
        residual_nt=field.residual_nt,
        left_out=0.0,
        strongest_nt=48000.0,
        measurable_nt=60000.0,
    )


@pytest.fixture
def calibrated_as(monkeypatch):
    """Makes every log one that tells this calibration."""
    return lambda found: monkeypatch.setattr(command, "calibrated", lambda samples, table: found)


def poor(found):
    return replace(found, field=replace(found.field, covariance=1e8 * found.field.covariance))


@pytest.mark.long
def test_tables_and_page_are_written(a_run, good, calibrated_as):
    calibrated_as(good)
    result = run(a_run, "--out", "c.toml", "--page", "c.html")
    assert result.exit_code == 1, "the dipoles are not determined"
    assert "written: c.toml" in result.stdout
    text = Path("c.toml").read_text()
    assert "[calibration.magnetometer]" in text
    assert "[calibration.magnetometer]" in Path("c.html").read_text()


@pytest.mark.long
def test_a_log_too_poor_for_the_tables_still_gives_page_and_document(a_run, good, calibrated_as):
    calibrated_as(poor(good))
    result = run(a_run, "--out", "c.toml", "--page", "c.html")
    assert result.exit_code == 1
    assert "c.toml: no table is written: the offset is known within" in result.stdout
    assert not Path("c.toml").exists()
    assert "Not determined by this log" in Path("c.html").read_text()
    told = run(a_run, "--out", "c.toml", "--json")
    assert told.exit_code == 1
    found = json.loads(told.stdout)
    assert (found["told"], found["out"]) == (False, None)
    assert run(a_run).exit_code == 1


def test_tables_by_which_no_satellite_could_fly_are_not_written(a_run, good, calibrated_as):
    calibrated_as(replace(good, field=replace(good.field, matrix=1e-5 * good.field.matrix)))
    result = run(a_run, "--out", "c.toml")
    assert result.exit_code == 1
    assert (
        "c.toml: no table is written, as none could fly by it: calibration.magnetometer: matrix"
        in result.stdout
    )
    assert not Path("c.toml").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("flown", "--out", "flown/scenario.toml"), "the run's scenario.toml flown/scenario.toml"),
        (("flown", "--page", "flown/bus.log"), "the log flown/bus.log"),
        (("flown/bus.log", "--scenario", "mine.toml", "--out", "mine.toml"), "the scenario mine.toml"),
        (("flown", "--out", "x", "--page", "x"), "--out x"),
    ],
    ids=["of the run", "log", "scenario", "both"],
)
def test_no_file_takes_the_place_of_another(a_run, tmp_path, words, said):
    (tmp_path / "mine.toml").write_bytes((a_run / "scenario.toml").read_bytes())
    before = contents(tmp_path)
    result = run(*words)
    assert (result.exit_code, result.stdout) == (2, "")
    assert f" and {said} are the same file: name another by --" in result.stderr
    assert contents(tmp_path) == before


def test_a_log_of_a_time_without_a_field_model_is_named(tmp_path):
    late = write_run(tmp_path / "late", 2_000_000_000)
    result = run(late)
    assert (result.exit_code, result.stdout) == (2, "")
    assert f"{late}/bus.log: the log is of 2033-05-18 03:33:20 to " in result.stderr
    assert "the IGRF-14 table covers 1900 to 2030" in result.stderr
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "words",
    [("--tle", "t.txt"), ("--inertia-ratios", "1,1,1"), ("--parameters", "12")],
    ids=lambda words: words[0],
)
def test_what_belongs_to_recorded_telemetry_is_refused(a_run, words):
    result = run(a_run, *words)
    assert result.exit_code == 2
    assert f"{words[0]}: {a_run} is no PASS.csv" in result.stderr
