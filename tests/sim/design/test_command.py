"""``torquer design`` by its command line."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from sim.design import command
from sim.design.theory.floquet import degree_of_stability, monodromy
from sim.design.theory.linear import Gains, closed_loop
from sim.scenario.schema import load
from sim.validate.reference.reference_table import DATA
from torquer.cli.main import main

REFERENCE = DATA / "floquet.csv"


@pytest.fixture
def design(capsys, tmp_path, monkeypatch):
    """Runs ``torquer design ARGUMENTS...`` in an empty directory: (exit code, stdout, stderr)."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        with pytest.raises(SystemExit) as ended:
            main.main(["design", *map(str, arguments)], prog_name="torquer")
        result = capsys.readouterr()
        return ended.value.code or 0, result.out, result.err

    return run


@pytest.fixture
def as_searched(monkeypatch, searched):
    """The command with its analysis already done; a function to change what it found."""
    analysis = searched[1]

    def found(**changes):
        def analyse(body, pulsing, given, watch):
            if given is None:
                return replace(analysis, **changes)
            chosen = changes.get("chosen", analysis.chosen)
            return replace(analysis, search=None, chosen=replace(chosen, gains=given))

        monkeypatch.setattr(command, "analyse", analyse)

    found()
    return found


def reference_case(name):
    lines = [line for line in REFERENCE.read_text().splitlines() if not line.startswith("#")]
    return next(row for row in csv.DictReader(lines) if row["name"] == name)


@pytest.mark.long
def test_given_gains_as_json_are_those_of_the_reference(design):
    row = reference_case("1U_gg_unstable_weak")
    code, out, err = design(
        "microsat", "--gains", row["k_omega"], row["k_a"], "--json",
        "--set", f"body.inertia_kgm2=[{row['A']}, {row['B']}, {row['C']}]",
        "--set", f"orbit.altitude_km={float(row['altitude_km'])}",
        "--set", f"orbit.inclination_deg={row['inclination_deg']}",
    )  # fmt: skip
    result = json.loads(out)
    assert code == 0
    assert all(line.startswith("torquer: warning: ") for line in err.splitlines())
    assert result["degree_of_stability"] == pytest.approx(float(row["degree_of_stability"]), abs=1e-7)
    for k, (re, im) in enumerate(result["multipliers"][:4], start=1):
        assert complex(re, im) == pytest.approx(
            complex(float(row[f"mult_{k}_re"]), float(row[f"mult_{k}_im"])), abs=1e-7, rel=1e-7
        )
    assert not list(Path().iterdir())


@pytest.mark.long
@pytest.mark.slow
def test_the_best_gains_are_printed_and_drawn(design, as_searched):
    code, out, _ = design("microsat", "--out", "here")
    assert code == 0
    assert "pictures: here/gains.png, here/robustness.png" in out
    assert json.loads(Path("here/design.json").read_text())["stabilised"]
    for name in ("gains.png", "robustness.png"):
        pixels = imread(Path("here") / name)
        assert min(pixels.shape[:2]) > 500
        assert len(np.unique(pixels.reshape(-1, pixels.shape[2]), axis=0)) > 100
    assert {path.name for path in Path("here").iterdir()} == {
        "gains.png",
        "robustness.png",
        "design.html",
        "design.json",
    }


def test_what_is_written_flies_with_the_degree_that_was_printed(design, as_searched, searched, scenario_file):
    code, out, _ = design(scenario_file, "--write", "--json")
    assert code == 0
    control = load(str(scenario_file)).control
    loop = closed_loop(searched[1].body, Gains(control.k_w, control.k_a))
    printed = json.loads(out)["degree_of_stability"]
    assert float(degree_of_stability(monodromy(loop))) == pytest.approx(printed, abs=1e-3)


def test_given_gains_are_written_as_they_are(design, as_searched, scenario_file):
    code, out, err = design(scenario_file, "--gains", "5.5e6", "1200", "--write", "--json")
    assert (code, err, json.loads(out)["written"]) == (0, "", str(scenario_file))
    control = load(str(scenario_file)).control
    assert (control.k_w, control.k_a) == (5.5e6, 1200.0)


def test_given_gains_that_do_not_stabilise_are_not_written(design, as_searched, searched, scenario_file):
    as_searched(chosen=replace(searched[1].chosen, degree=0.1))
    before = scenario_file.read_text()
    code, out, err = design(scenario_file, "--gains", "0", "0", "--write")
    assert (code, out) == (2, "")
    assert f"--gains 0 0: they do not stabilise mine; {scenario_file} is kept" in err
    assert scenario_file.read_text() == before


def test_where_no_gains_stabilise_that_is_the_verdict_and_nothing_is_written(
    design, as_searched, searched, scenario_file
):
    found = searched[1].search
    as_searched(search=replace(found, steady=replace(found.steady, worst_degree=0.1)))
    before = scenario_file.read_text()
    code, out, _ = design(scenario_file, "--write", "--json")
    assert code == 1
    assert json.loads(out)["stabilised"] is False
    assert scenario_file.read_text() == before


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("nowhere",), "there is no scenario 'nowhere'"),
        (("microsat", "--write"), "--write microsat: gains are not written into a scenario that ships"),
        (("microsat", "--gains", "nan", "1"), "--gains nan: is not a finite number"),
        (("microsat", "--gains", "1e6", "-1"), "--gains: K_A = -1 is not allowed: for this body 0 to "),
        (("microsat", "--gains", "1e30", "1"), "--gains: K_W = 1e+30 is not allowed"),
        (("microsat", "--gains", "1e6"), "--gains"),
        (("microsat", "--gains", "x", "1"), "'x' is not a valid float"),
        (("microsat", "--set", "body.inertia_kgm2=[1.0, 2.0, 9.0]"), "inertia"),
        (("gone.toml", "--write"), "gone.toml: cannot be read"),
    ],
)
def test_bad_input_is_one_sentence(design, arguments, sentence):
    code, out, err = design(*arguments)
    assert (code, out) == (2, "")
    assert err.count("\n") == 1
    assert sentence in err


def test_a_folder_that_cannot_be_made_is_one_sentence(design, as_searched):
    Path("file").write_text("")
    code, _, err = design("microsat", "--out", "file/here")
    assert code == 2
    assert "file/here: cannot be written" in err
