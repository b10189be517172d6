"""``--json``: one document on stdout, with the keys that docs/cli.md states; ``--junit``: the verdicts."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from torquer.cli.main import main

ROOT = Path(__file__).resolve().parents[3]
MICROSAT = ROOT / "sim/scenario/shipped/microsat.toml"
PAGE = (ROOT / "docs" / "cli.md").read_text(encoding="utf-8")
HEAD = ["command", "torquer_version", "schema_version", "exit_code", "warnings"]
SHAPES = {
    "sil": {"run": str, "report": str, "summary": dict},
    "report": {"run": str, "report": str, "summary": dict, "binding": list},
    "check": {
        "ok": bool,
        "limits": dict,
        "statuses": int,
        "dipole_statuses": int,
        "unreported_s": float,
        "span_s": float,
        "pulses": dict,
        "max_pulse_s": float | None,
        "min_gap_s": dict,
        "duty": dict,
        "complete": bool,
        "genuine": bool,
        "violations": list,
        "mismatches": list,
        "notes": list,
    },
    "replay": {
        "ok": bool,
        "lines": list,
        "bit_exact": bool,
        "command_exact": bool,
        "ticks": int,
        "frames": int,
        "first_bit_difference": str | None,
        "first_command_difference": str | None,
        "complete": bool,
    },
    "scenarios": {"scenarios": list},
    "new": {"file": str, "name": str, "pointing_rms_deg": float},
    "doctor": {"ok": bool, "findings": list},
    "faults": {"rows": list},
    "validate": {"wall_s": float, "page": str | None, "claims": list},
}
"""The keys after the head, with their types."""
BOX = ("--altitude-km", "550", "--inclination-deg", "97.6", "--inertia-kgm2", "0.01", "0.04", "0.05")


def run(capsys, *words):
    """(exit code, stdout, stderr) of a command line."""
    with pytest.raises(SystemExit) as ended:
        main.main(list(map(str, words)), prog_name="torquer")
    return ended.value.code or 0, *capsys.readouterr()


def document(capsys, *words, code=0):
    """The document of a command that ends with this exit code."""
    found, out, err = run(capsys, *words, "--json")
    assert found == code, err
    values = json.loads(out)
    assert list(values)[: len(HEAD)] == HEAD
    assert (values["command"], values["exit_code"]) == (words[0], code)
    return values


def has_shape(values, name):
    shape = SHAPES[name]
    assert set(values) == {*HEAD, *shape}
    assert [key for key, kind in shape.items() if not isinstance(values[key], kind)] == []


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A short run."""
    path = tmp_path_factory.mktemp("runs") / "run"
    with pytest.raises(SystemExit) as ended:
        main.main(["sil", "microsat", "--bus", "virtual", "--orbits", "0.05", "--out", str(path), "--quiet"])
    assert not ended.value.code
    return path


@pytest.fixture
def broken(flown, tmp_path):
    """Its log alone, in which a coil reports a level that there is not."""
    log = (flown / "bus.log").read_text().splitlines(keepends=True)
    (tmp_path / "bus.log").write_text("".join(log[:200]))
    return tmp_path / "bus.log"


@pytest.mark.parametrize("name", SHAPES)
def test_the_page_states_every_key(name):
    (row,) = re.findall(rf"(?m)^\| `{name}` \| (.*) \|$", PAGE)
    for key in SHAPES[name]:
        assert f"`{key}`" in row or f"{name}.json" in row


@pytest.mark.long
def test_a_flight(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    values = document(
        capsys, "sil", "microsat", "--bus", "virtual", "--orbits", "0.01", "--out", "r", "--junit", "r.xml"
    )
    has_shape(values, "sil")
    assert values["summary"] == json.loads(Path("r/summary.json").read_text())
    flight, requirements = ElementTree.parse("r.xml").getroot()
    assert [(case.get("name"), len(case)) for case in flight] == [
        ("limits of the coils", 0),
        ("replay exact", 0),
        ("no second sender", 0),
        ("run complete", 0),
    ]
    judged = values["summary"]["requirements"]
    assert [[part.tag for part in case] for case in requirements] == [["properties", "skipped"]] * len(judged)
    assert [case[1].get("message") for case in requirements] == [one["text"] for one in judged]


@pytest.mark.long
@pytest.mark.slow
def test_a_run_judged_again(capsys, flown):
    has_shape(document(capsys, "report", flown), "report")
    has_shape(document(capsys, "check", flown), "check")
    has_shape(document(capsys, "replay", flown), "replay")
    values = document(capsys, "replay", flown, "--plant")
    assert (values["ok"], values["lines"][0][:17]) == (True, "plant reproduced:")


@pytest.mark.long
def test_a_log_that_fails(capsys, broken, tmp_path):
    values = document(capsys, "check", broken, "--junit", tmp_path / "check.xml", code=0)
    assert values["ok"]
    (tmp_path / "scenario.toml").write_text("[coils]\nbackoff = 'shared'\n")
    values = document(capsys, "check", broken, "--junit", tmp_path / "check.xml", code=1)
    assert (values["ok"], values["complete"]) == (False, False)
    failures = {
        case.get("name"): case[0].get("message")
        for case in ElementTree.parse(tmp_path / "check.xml").iter("testcase")
        if len(case)
    }
    assert failures == {"complete": "the log is incomplete"}


@pytest.mark.long
def test_what_needs_no_flight(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    has_shape(document(capsys, "scenarios"), "scenarios")
    has_shape(document(capsys, "new", "mine", *BOX), "new")
    has_shape(document(capsys, "doctor"), "doctor")
    has_shape(document(capsys, "faults", "--list"), "faults")
    values = document(capsys, "validate", "--only", "reference.igrf14", "--quick", "--junit", "v.xml")
    has_shape(values, "validate")
    cases = list(ElementTree.parse("v.xml").iter("testcase"))
    assert [case.get("name") for case in cases] == [claim["id"] for claim in values["claims"]]


def test_warnings_stand_in_the_document_and_on_stderr(capsys):
    code, out, err = run(capsys, "size", "microsat", "--set", "coils.backoff_s=99.5", "--json")
    (warning,) = json.loads(out)["warnings"]
    assert warning.startswith("coils.backoff_s = 99.5 is not a whole number of ticks")
    assert err == f"torquer: warning: {warning}\n"
    assert code == 0


@pytest.mark.long
@pytest.mark.parametrize(("orbits", "told"), [(0.005, True), (0.006, False)])
def test_a_flight_too_short_for_a_telecommand_says_so(capsys, tmp_path, orbits, told):
    """The scenario's own flight is shorter than either."""
    late = tmp_path / "late.toml"
    late.write_text(MICROSAT.read_text() + '[[telecommand]]\nat_s = 32\nmessage = "TC_CLEAR"\n')
    fly = ("sil", late, "--bus", "virtual", "--out", tmp_path / "run", "--json")
    _, out, err = run(capsys, *fly, "--set", "time.orbits=0.001", "--orbits", orbits)
    sentence = "telecommand[0], TC_CLEAR at 32 s, will not be sent: the last tick is at"
    assert [warning.startswith(sentence) for warning in json.loads(out)["warnings"]] == [True] * told
    assert (sentence in err) is told


@pytest.mark.parametrize("words", [["check", "nowhere"], ["sil", "nowhere"], ["size", "--mass-kg", "1"]])
def test_an_error_leaves_stdout_empty(words, capsys):
    code, out, err = run(capsys, *words, "--json")
    assert (code, out, err.count("\n")) == (2, "", 1)


@pytest.mark.long
def test_quiet_and_verbose(capsys, flown, broken):
    assert run(capsys, "check", flown, "--quiet") == (0, "", "")
    code, out, err = run(capsys, "check", flown, "-v")
    assert (code, "OK: limits kept" in out) == (0, True)
    assert re.search(r"check: torquer [\d.]+, Python 3", err)
    assert re.search(r"check: exit code 0 after \d+\.\d s", err)
    (broken.parent / "scenario.toml").write_text("[coils]\nbackoff = 'shared'\n")
    code, out, _ = run(capsys, "check", broken, "-q")
    assert (code, "it is incomplete" in out) == (1, True)
