"""``torquer.judge``: the verdicts of the command, for programs."""

import json
import sys
from pathlib import Path

import pytest

import torquer

ROOT = Path(__file__).resolve().parents[3]
TINY = f"{sys.executable} {ROOT / 'examples' / 'tiny_firmware.py'} {{port}}"
TUMBLE = {"initial.rate_degps": [0.5, 0.5, 0.5]}


def test_a_flight_is_judged_as_the_command_does(command, tmp_path):
    judged = torquer.judge(
        "microsat",
        TINY,
        profile="detumble",
        orbits=0.05,
        set=TUMBLE,
        out=tmp_path / "a",
        junit=tmp_path / "a.xml",
    )
    done = command(
        *("judge", "microsat", "--flight-software", TINY, "--profile", "detumble", "--orbits", 0.05),
        *("--set", "initial.rate_degps=[0.5,0.5,0.5]", "--out", tmp_path / "b", "--json"),
    )
    assert (judged.ok, judged.failures) == (True, ())
    assert str(judged).startswith("microsat, seed 1, profile detumble: ")
    told = json.loads(done.stdout)
    assert told["invariants"] == [dict(one) for one in judged.document["invariants"]]
    assert judged.page == tmp_path / "a" / "judge.html"
    assert judged.page.is_file()
    assert (tmp_path / "a.xml").is_file()
    assert judged.run.path == tmp_path / "a"


def test_a_firmware_that_ends_at_once_is_told_and_no_error(tmp_path):
    judged = torquer.judge(
        "microsat", f"{sys.executable} -c 0", orbits=0.05, boot_s=5.0, out=tmp_path / "run"
    )
    assert not judged.ok
    assert judged.failures[0].startswith("flies to its end: ")
    assert repr(judged).startswith("<JudgedSoftware: flies to its end: ")


def test_rows_of_the_fault_table_are_told_one_by_one(tmp_path):
    told = []
    judged = torquer.judge(
        "microsat", TINY, faults=True, rows=["bit-flip"], out=tmp_path / "run", tell=told.append
    )
    assert [one.name for one in told] == [one.name for one in judged.found.flown]
    assert judged.ok
    assert judged.run is None
    assert "not applicable" in str(judged)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({}, "which flight software?"),
        ({"flight_software": TINY, "profile": "none"}, "judge: profile"),
        ({"flight_software": TINY, "pace": "fast"}, "--pace fast"),
        ({"flight_software": TINY, "rows": ["mag"]}, "--row: a flight without --faults has no such option"),
        (
            {"flight_software": TINY, "runs": 3},
            "--runs: a scenario, which is no campaign has no such option",
        ),
        ({"flight_software": TINY, "arm": True}, "--arm: without --board a judgement has no such option"),
        ({"flight_software": TINY, "board": TINY}, "it drives the coils of the board, give --arm"),
        ({"board": TINY, "faults": True}, "--faults: --board has no such option"),
        ({"flight_software": "./no-such-program"}, "there is no program"),
    ],
)
def test_what_would_do_nothing_is_refused_and_nothing_is_flown(given, sentence, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(torquer.InputError) as caught:
        torquer.judge("microsat", **given)
    assert sentence in str(caught.value)
    assert not list(tmp_path.iterdir())
