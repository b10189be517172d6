"""The code of docs/own-law.md does what the page says."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import torquer

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "own-law.md").read_text(encoding="utf-8")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The files of the page, each beginning with a comment that is its name."""
    for block in re.findall(r"```(?:python|toml)\n(# (\w+\.\w+)\n.*?)```", PAGE, re.S):
        (tmp_path / block[1]).write_text(block[0])
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sim.report.conclude.write_report", lambda path, *rest: path.write_text(""))
    return tmp_path


@pytest.mark.parametrize(
    "path", [*ROOT.glob("docs/*.md"), *ROOT.glob("examples/*/*.py")], ids=lambda path: path.name
)
def test_laws_that_are_shown_control_by_an_attitude_that_is_usable(path):
    """As those that ship: one that is not valid in a shadow is controlled by all the same."""
    assert "inputs.attitude.valid" not in path.read_text(encoding="utf-8")


@pytest.mark.long
def test_its_law_flies_with_the_gain_of_the_page(folder):
    run = torquer.fly("microsat", law="my_law.py:damp", orbits=0.04, out=folder / "run", set=GAIN)
    assert run.ok
    assert run.replay().ok


GAIN = {"control.gains.damp.damping_nms_per_t2": 3e6}


@pytest.mark.long
@pytest.mark.slow
def test_its_script_flies_and_replays(folder):
    done = subprocess.run(
        [sys.executable, "script.py"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    (run,) = (folder / "runs").iterdir()
    assert torquer.load(run).record["law_object"]["qualname"] == "idle"


def test_its_effects_fly(folder):
    shipped = Path(__file__).parents[2] / "sim" / "scenario" / "shipped" / "microsat.toml"
    sections = (folder / "effects.toml").read_text()
    (folder / "sat.toml").write_text(shipped.read_text(encoding="utf-8") + sections)
    run = torquer.fly(folder / "sat.toml", orbits=0.005, out=folder / "run")
    assert run.ok
    assert [effect.parameters for effect in run.scenario.effect] == [{"torque_nm": 2e-6}, {}]


@pytest.mark.long
@pytest.mark.usefixtures("folder")
def test_its_test_holds_on_a_short_flight(fly):
    (code,) = re.findall(r"```python\n(def test_my_law.*?)```", PAGE, re.S)
    for length, short in (
        ("orbits=1,", "orbits=0.05,"),
        ('"by_orbit": 1.0', '"by_orbit": 0.05, "last_orbits": 0.05'),
        ("0.06", "0.09"),
    ):
        assert length in code
        code = code.replace(length, short)
    found = {}
    exec(code, found)
    found["test_my_law_damps"](fly)
