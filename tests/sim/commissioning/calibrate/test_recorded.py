"""A pass that is made up, calibrated: sensors, cells and body come out as they were, and fly."""

import json
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from recorded_samples import AXES, DATA, FACES, MATRIX, OFFSET_NT, RATIOS, TLE, made_up

from sim.commissioning.calibrate.body import declared_axes, fit_body
from sim.commissioning.calibrate.command import as_toml
from sim.commissioning.calibrate.page import calibration_page
from sim.commissioning.calibrate.recorded import calibrate_pass
from sim.commissioning.recorded.calibration import PassCalibration, read_calibration
from sim.commissioning.telemetry.follow import Noise
from sim.commissioning.telemetry.spin import Spin
from torquer.cli.main import main


def zero_field(row):
    """The row with a field of zero, as a sensor sends that has lost its supply."""
    index, time, *values = row.split(",")
    return ",".join([index, time, "0", "0", "0", *values[3:]])


NOISE = Noise(field_nt=200.0)
DECLARED = np.array([0.93, 1.0, 0.31])


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    around = made_up(700, seed=5).along(tmp_path_factory.mktemp("pass"))
    return calibrate_pass(around, DECLARED, NOISE)


@pytest.mark.long
def test_the_magnetometer_is_found(calibrated):
    fit = calibrated.magnetometer
    assert fit.determined.all()
    assert np.abs((fit.offset_nt - OFFSET_NT) / fit.sigma[:3]).max() < 4.0
    np.testing.assert_allclose(fit.matrix, MATRIX, atol=0.02)
    assert fit.rms_nt == pytest.approx(150.0, rel=0.15)


@pytest.mark.long
def test_so_are_the_cells_by_the_motion_of_the_filter(calibrated):
    assert calibrated.judged.verdict.converged
    for cell in calibrated.cells:
        face, scale = FACES[cell.name]
        assert np.degrees(np.arccos(cell.face_body @ face / np.linalg.norm(face))) < 5.0
        assert cell.full_scale == pytest.approx(scale + 30.0, rel=0.1)


@pytest.mark.long
def test_and_the_axis_about_which_it_turns(calibrated):
    assert np.degrees(np.arccos(abs(calibrated.calibration.spin_axis @ AXES[:, 1]))) < 1.0
    np.testing.assert_allclose(calibrated.body.ratios, RATIOS, atol=0.01)


def test_the_file_says_what_was_found(calibrated, tmp_path):
    path = tmp_path / "c.toml"
    path.write_text(as_toml(calibrated, DECLARED))
    known = read_calibration(path)
    np.testing.assert_allclose(known.offset_nt, calibrated.magnetometer.offset_nt, atol=0.1)
    np.testing.assert_allclose(known.matrix, calibrated.magnetometer.matrix, atol=1e-6)
    np.testing.assert_allclose(known.inertia, calibrated.body.inertia, atol=1e-3)
    assert [cell.name for cell in known.cells] == [cell.name for cell in calibrated.cells if cell.determined]
    bounds = tomllib.loads(path.read_text())["uncertainty"]
    assert bounds["magnetometer_bias_nt"] >= 3.0 * calibrated.magnetometer.sigma[:3].max() * 0.99
    assert 0.0 < bounds["magnetometer_scale_percent"] <= 10.0


@pytest.mark.long
@pytest.mark.parametrize("unit", [1.0, 1e-4, 1e-6])
def test_full_scales_keep_their_digits_in_any_unit(calibrated, tmp_path, unit):
    def in_unit(cell):
        scaled = {
            name: unit * getattr(cell, name) for name in ("full_scale", "full_scale_sigma", "residual_rms")
        }
        return cell._replace(**scaled)

    found = replace(calibrated, cells=tuple(map(in_unit, calibrated.cells)))
    path = tmp_path / "c.toml"
    path.write_text(as_toml(found, DECLARED))
    told = [cell for cell in found.cells if cell.determined]
    assert told
    for known, cell in zip(read_calibration(path).cells, told, strict=True):
        assert known.full_scale == pytest.approx(cell.full_scale, rel=1e-3)
        shown = f"{cell.full_scale:.{cell.decimals}f}"
        assert float(shown) == pytest.approx(cell.full_scale, rel=5e-3)
        assert f">{shown}<" in calibration_page(found, "")


@pytest.mark.long
def test_the_file_can_be_read_whatever_the_name_of_the_pass(tmp_path):
    around = made_up(40).along(tmp_path)
    named = replace(around, recorded=replace(around.recorded, name="a\nb\x01"))
    found = calibrate_pass(named, np.ones(3), NOISE)
    path = tmp_path / "c.toml"
    path.write_text(as_toml(found, np.ones(3)))
    np.testing.assert_allclose(read_calibration(path).offset_nt, found.magnetometer.offset_nt, atol=0.1)


@pytest.mark.long
def test_the_page_shows_residuals_and_verdicts(calibrated):
    page = calibration_page(calibrated, "offset_nt = <1>")
    assert "|B| measured less modelled" in page
    assert "cannot be determined by |B|" in page
    assert "offset_nt = &lt;1&gt;" in page


@pytest.mark.long
def test_a_ratio_that_the_wobble_shows_is_corrected(tmp_path):
    truth = made_up(400)
    around = truth.along(tmp_path)
    known = PassCalibration(OFFSET_NT, MATRIX, (), np.eye(3))
    start = Spin(31.0, 0.0, truth.dcm[0], truth.omega_radps[0], np.zeros(3))
    off = DECLARED * (1.004, 1.0, 1.0)
    found = fit_body(around, known, off, AXES[:, 1], start, NOISE)
    assert found.ratios[1] == 1.0
    assert abs(found.ratios[0] - RATIOS[0]) < 0.5 * abs(off[0] - RATIOS[0]) or not found.determined[0]
    np.testing.assert_allclose(declared_axes(DECLARED, AXES[:, 1])[:, 1], AXES[:, 1], atol=1e-12)


class TestOfTheCommand:
    def run(self, *arguments):
        return CliRunner().invoke(main, ["calibrate", *map(str, arguments)])

    @pytest.mark.long
    def test_a_short_pass_says_what_it_cannot_tell(self, tmp_path):
        out = tmp_path / "c.toml"
        result = self.run(
            DATA / "s3_20240314T153551Z.csv", "--tle", TLE, "--out", out, "--parameters", "12", "--json"
        )
        found = json.loads(result.stdout)
        assert found["field_norm_nt_rms"] < 700.0
        assert found["magnetometer"]["turn_x"]["told"] is False
        assert read_calibration(out).offset_nt == pytest.approx(
            [found["magnetometer"][f"b_{axis}"]["value"] for axis in "xyz"], abs=0.1
        )
        told = all(one["told"] for name, one in found["magnetometer"].items() if not name.startswith("turn"))
        assert result.exit_code == (0 if told else 1)

    @pytest.mark.parametrize(
        ("arguments", "said"),
        [
            (("--inertia-ratios", "1,2"), "is not three positive numbers"),
            (("--inertia-ratios", "1,1,9"), "no body has the moments of inertia"),
            (("--parameters", "10"), "'10' is not one of '9', '12'"),
            (("--tle", "none.txt"), "none.txt: cannot be read"),
        ],
    )
    def test_bad_input_is_one_sentence_and_writes_nothing(self, tmp_path, arguments, said):
        out = tmp_path / "c.toml"
        result = self.run(DATA / "s3_20240314T153551Z.csv", "--tle", TLE, "--out", out, *arguments)
        assert result.exit_code == 2
        assert said in result.stderr
        assert len(result.stderr.splitlines()) == 1
        assert not out.exists()

    @pytest.mark.long
    def test_one_row_of_zeros_changes_nothing_and_is_told(self, tmp_path):
        lines = (DATA / "s3_20240426T041442Z.csv").read_text().splitlines()
        spoiled, without = tmp_path / "spoiled.csv", tmp_path / "without.csv"
        spoiled.write_text("\n".join([*lines[:100], zero_field(lines[100]), *lines[101:]]) + "\n")
        without.write_text("\n".join([*lines[:100], *lines[101:]]) + "\n")
        out = tmp_path / "c.toml"
        said = self.run(spoiled, "--tle", TLE, "--out", out)
        assert said.exit_code == 0
        assert (
            "1 of 200 rows left out: 1 whose field has not the strength of the orbit's (line 101)"
        ) in said.stdout
        found, right = (
            json.loads(self.run(path, "--tle", TLE, "--out", out, "--json").stdout)
            for path in (spoiled, without)
        )
        assert found["magnetometer"]["b_x"]["value"] == pytest.approx(103036.0, abs=10.0)
        assert found["magnetometer"]["b_x"]["sigma"] == pytest.approx(950.0, abs=10.0)
        assert found.pop("rows_left_out")[0]["lines"] == [101]
        assert right.pop("rows_left_out") == []
        assert found == right

    def test_too_few_rows_are_refused(self, tmp_path):
        path = tmp_path / "few.csv"
        path.write_text("\n".join(made_up(9).text.splitlines()) + "\n")
        result = self.run(path, "--tle", TLE, "--out", tmp_path / "c.toml")
        assert result.exit_code == 2
        assert "9 rows with a field sample cannot tell 9 numbers, 15 may" in result.stderr

    def test_rows_without_a_field_sample_do_not_count(self, tmp_path):
        head, *rows = made_up(20).text.splitlines()
        time_and_rest = [(row.split(",")[0], row.split(",", 4)[4]) for row in rows[14:]]
        path = tmp_path / "gaps.csv"
        path.write_text(
            "\n".join([head, *rows[:14], *(f"{t},,,,{rest}" for t, rest in time_and_rest)]) + "\n"
        )
        result = self.run(path, "--tle", TLE, "--out", tmp_path / "c.toml")
        assert result.exit_code == 2
        assert "14 rows with a field sample cannot tell 9 numbers" in result.stderr

    @pytest.mark.parametrize(
        ("files", "said"),
        [
            (("--out", "p.csv"), "--out p.csv and the telemetry p.csv are the same file"),
            (("--out", "t.txt"), "--out t.txt and the element sets t.txt are the same file"),
            (
                ("--out", "c.toml", "--page", "p.csv"),
                "--page p.csv and the telemetry p.csv are the same file",
            ),
            (("--out", "x", "--page", "./x"), "--page x and --out x are the same file"),
        ],
        ids=["telemetry", "elements", "page", "both"],
    )
    def test_no_file_takes_the_place_of_another(self, tmp_path, monkeypatch, files, said):
        monkeypatch.chdir(tmp_path)
        before = {"p.csv": (DATA / "s3_20240314T153551Z.csv").read_text(), "t.txt": TLE.read_text()}
        for name, text in before.items():
            (tmp_path / name).write_text(text)
        result = self.run("p.csv", "--tle", "t.txt", *files)
        assert (result.exit_code, result.stdout) == (2, "")
        assert said in result.stderr
        assert {path.name: path.read_text() for path in tmp_path.iterdir()} == before

    @pytest.mark.parametrize(
        ("option", "words"),
        [("--set", ("--set", "time.tick_hz=10")), ("--scenario", ("--scenario", "microsat"))],
    )
    def test_a_scenario_has_no_effect_and_is_refused(self, tmp_path, option, words):
        out = tmp_path / "c.toml"
        result = self.run(DATA / "s3_20240314T153551Z.csv", "--tle", TLE, "--out", out, *words)
        assert result.exit_code == 2
        assert f"{option}: recorded telemetry in " in result.stderr
        assert not out.exists()
