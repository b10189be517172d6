"""The firmware of docs/own-firmware.md: of the standard library alone, and judged sound as the page says."""

import ast
import json
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from torquer.cli.main import main

EXAMPLE = Path(__file__).parents[2] / "examples" / "tiny_firmware.py"
RATE = 'requirement=[{index="rate",at_most_degps=0.3,by_orbit=1.0,last_orbits=0.2}]'
FAST = ("initial.rate_degps=[0.8,-0.6,0.7]", "coils.levels_am2=[1.0,10.0,30.0]", RATE)


def judged(*words):
    software = f"{sys.executable} {EXAMPLE} {{port}}"
    done = CliRunner().invoke(main, ["judge", "microsat", "--flight-software", software, *words])
    return done


def test_it_needs_nothing_but_the_standard_library():
    tree = ast.parse(EXAMPLE.read_text(encoding="utf-8"))
    imported = {name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names}
    assert imported <= sys.stdlib_module_names
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]


@pytest.mark.long
@pytest.mark.slow
def test_it_brakes_a_tumble_and_nothing_is_held_against_it(tmp_path):
    out, junit = tmp_path / "run", tmp_path / "judge.xml"
    settings = [word for one in FAST for word in ("--set", one)]
    words = ("--profile", "detumble", "--orbits", "1", "--out", str(out), "--junit", str(junit), "--json")
    done = judged(*words, *settings)
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    assert (told["ok"], told["profile"], told["reasons"]) == (True, "detumble", [])
    assert {one["verdict"] for one in told["invariants"]} == {"kept", "not judged"}
    assert [one["verdict"] for one in told["requirements"]] == ["met"]
    assert 'failures="0"' in junit.read_text()
    assert "as it should be" in (out / "judge.html").read_text(encoding="utf-8")
    assert json.loads((out / "run.json").read_text())["flight_software"]["profile"] == "detumble"
    replayed = CliRunner().invoke(main, ["replay", str(out)])
    assert replayed.exit_code == 2
    assert "another flight software has flown" in replayed.stderr
    assert CliRunner().invoke(main, ["replay", str(out), "--plant"]).exit_code == 0
    assert CliRunner().invoke(main, ["check", str(out)]).exit_code == 0
    assert CliRunner().invoke(main, ["report", str(out)]).exit_code == 0


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ((), "which flight software"),
        (("--flight-software", "no-such-firmware"), "there is no program 'no-such-firmware'"),
        (("--flight-software", "true", "--pace", "slow"), "--pace slow"),
        (("--flight-software", "true", "--profile", "pointer"), "pointer"),
    ],
)
def test_bad_input_is_one_sentence_and_flies_nothing(tmp_path, monkeypatch, words, says):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(main, ["judge", "microsat", *words])
    assert (done.exit_code, done.stdout) == (2, "")
    assert says in str(done.stderr)
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "runs").exists()


@pytest.mark.long
def test_one_that_never_boots_is_judged(tmp_path):
    words = ("--flight-software", "sleep 60", "--boot-s", "1", "--out", str(tmp_path / "run"))
    done = CliRunner().invoke(main, ["judge", "microsat", *words])
    assert done.exit_code == 1
    assert "the flight software has not booted within 1 s" in done.stderr
    assert "not judged" in done.stdout


@pytest.mark.long
def test_one_that_ends_at_once_is_judged_with_its_last_words(tmp_path):
    words = ("--flight-software", "sh -c 'echo no bus here; exit 3'", "--out", str(tmp_path / "run"))
    done = CliRunner().invoke(main, ["judge", "microsat", *words])
    assert done.exit_code == 1
    assert "the flight software ended with exit code 3" in done.stderr
    assert "no bus here" in done.stderr


@pytest.mark.long
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="needs /proc")
def test_what_a_shell_has_started_is_ended_with_it(tmp_path):
    command = "sh -c 'sleep 300 & echo $!; wait'"
    words = ("--flight-software", command, "--boot-s", "1", "--out", str(tmp_path / "run"))
    assert CliRunner().invoke(main, ["judge", "microsat", *words]).exit_code == 1
    child = int((tmp_path / "run" / "flight-software.log").read_text())
    deadline = time.monotonic() + 10.0
    while Path(f"/proc/{child}").exists() and _state(child) != "Z" and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not Path(f"/proc/{child}").exists() or _state(child) == "Z"


def _state(pid):
    """That of a process of Linux: Z, it has ended and waits to be noticed."""
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
