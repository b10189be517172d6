"""A user's coil board: its checks and flight are verdicts, a busy computer is not held against it."""

import json
import sys
from itertools import count
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner
from pauses import run_undisturbed

from sim.conformance import command as conformance
from sim.errors import HarnessError
from sim.flight.node_command import parse_command
from sim.judge import board as judged
from sim.judge.board import (
    CoilBoardUnderTest,
    board_json,
    board_page,
    board_suites,
    board_values,
    check_board,
    flight_verdicts,
    fly_with_board,
)
from sim.judge.invariants import RULES
from sim.scenario.schema import load, parse_settings
from torquer.cli.main import main

QUICK = ("coils.backoff_s=2.0", 'knowledge="perfect"', "flight.modes.settle_s=1.0")
"""The first pulse comes after 30 s."""
STUB = (
    f"{sys.executable} -m torquer board coil "
    "--bus {bus} --tick-hz {tick_hz} --pulse-s 3 --backoff-s BACKOFF "
    "--backoff {backoff} --levels-ma 25 100 400"
)
BUSY = "this computer was late"


@pytest.fixture
def scenario():
    return load("microsat", parse_settings(QUICK))


def stub(backoff_s="2", armed=True):
    return CoilBoardUnderTest(parse_command(STUB.replace("BACKOFF", backoff_s), "--board"), "loop", armed)


def names(found):
    return [one.name for one in found if one.failure]


@pytest.fixture
def few_checks(monkeypatch):
    """The checks that take seconds."""
    few = [one for one in conformance.CHECKS if one.run.__name__ in ("boot", "noise", "boot_lockout")]
    monkeypatch.setattr(conformance, "CHECKS", few)


@pytest.mark.long
@pytest.mark.paced
def test_a_sound_board_keeps_the_checks(few_checks, scenario, tmp_path):
    found = check_board(stub(), scenario, tmp_path)
    assert names(found) == []
    assert [one.name for one in found] == ["boot", "noise", "boot_lockout"]


@pytest.mark.long
@pytest.mark.paced
def test_one_of_a_short_back_off_does_not(few_checks, scenario, tmp_path):
    found = check_board(stub("0.5"), scenario, tmp_path)
    assert "boot" in names(found)


@pytest.mark.long
@pytest.mark.slow
def test_what_drives_coils_is_not_checked_unarmed(few_checks, scenario, tmp_path):
    found = check_board(stub(armed=False), scenario, tmp_path)
    assert [bool(one.skipped) for one in found] == [False, False, True]


@pytest.mark.long
@pytest.mark.paced
def test_a_flight_with_it_is_audited(scenario, tmp_path):
    found = fly_with_board(stub(), None, scenario, tmp_path, 38.0, 1)
    assert names(found) == []
    flown = json.loads((tmp_path / "flight" / "hil.json").read_text())
    assert flown["real"] == ["coil"]
    assert flown["messages"]["COIL_FIRE"] > 0


@pytest.mark.long
@pytest.mark.paced
@pytest.mark.parametrize(
    ("mistake", "broken"), [("", []), ("long", ["pulses in flight", "software: asks within limits"])]
)
def test_a_flight_software_of_ones_own_flies_with_it_and_is_judged(tmp_path, firmware, mistake, broken):
    tumbling = load("microsat", parse_settings((*QUICK, "initial.rate_degps=[1,1,1]")))
    folders = count()
    found = run_undisturbed(
        lambda: fly_with_board(stub(), firmware(mistake), tumbling, tmp_path / str(next(folders)), 25.0, 1),
        lambda found: names(found) == broken,
    )
    assert names(found) == broken
    assert {one.name for one in found} > {f"software: {rule}" for rule in RULES}


@pytest.mark.long
def test_one_that_does_not_boot_is_told(scenario, tmp_path):
    dead = CoilBoardUnderTest(parse_command("sh -c 'echo burnt; exit 4'", "--board"), "loop", False)
    with pytest.raises(HarnessError, match="the board ended with exit code 4: burnt"):
        check_board(dead, scenario, tmp_path)
    mute = CoilBoardUnderTest(parse_command("sleep 30", "--board"), "loop", False, boot_s=1.0)
    with pytest.raises(HarnessError, match="the board sends no COIL_BOOT within 1 s of its start"):
        check_board(mute, scenario, tmp_path)


def test_what_a_command_may_name(scenario):
    assert board_values(scenario, 5.0) == {
        "tick_hz": "1",
        "pulse_ms": "3000",
        "backoff_ms": "2000",
        "backoff": "shared",
        "levels_ma": "25,100,400",
        "deadman_ms": "5000",
    }


@pytest.fixture
def flown(monkeypatch):
    """The verdicts of a flight with these numbers and this audit."""

    def of(coil=0, sun=0, slips=0, pulses=1, violations=(), missing="", armed=True, ended=()):
        def check(path, backoff, ticks_alone):
            check.ticks_alone = ticks_alone
            return SimpleNamespace(pulses=[0] * pulses, violations=violations, missing=missing)

        monkeypatch.setattr(judged, "check", check)
        samples = {"coil": coil, "magnetometer": 0, "sun": sun}
        numbers = {"missing_samples": samples, "slips": slips, "ticks": 100, "ended": dict(ended)}
        verdicts = flight_verdicts(Path("run"), numbers, 2, armed)
        return {one.name: one for one in verdicts}, check.ticks_alone

    return of


def test_a_broken_limit_and_a_missing_status_are_its_own(flown):
    found, ticks_alone = flown(coil=5, violations=("t=3 s: too long",))
    assert found["limits in flight"].failure == "t=3 s: too long"
    assert found["in time"].failure == "in 5 ticks of 100 there is no status"
    assert not ticks_alone
    assert flown(missing="COIL_STATUS")[0]["limits in flight"].failure == "no COIL_STATUS"
    assert flown(ended={"coil": "gone"})[0]["in time"].failure == "gone"


@pytest.mark.parametrize("late", [{"sun": 5}, {"slips": 5}])
def test_where_all_were_late_nothing_is_told_of_its_time(flown, late):
    found, ticks_alone = flown(coil=5, **late)
    assert (found["in time"].failure, found["in time"].skipped) == ("", BUSY)
    assert ticks_alone


def test_without_a_pulse_an_armed_flight_shows_nothing(flown):
    assert flown(pulses=0)[0]["pulses in flight"].failure
    unarmed = flown(pulses=0, armed=False)[0]["pulses in flight"]
    assert (unarmed.failure, bool(unarmed.skipped)) == ("", True)


def test_page_json_and_junit_tell_the_same(flown):
    found = list(flown(coil=5, pulses=0, armed=False)[0].values())
    assert board_json(found)["ok"] is False
    (suite,) = board_suites(found).values()
    assert [bool(one.failure) for one in suite] == [False, False, True]
    assert [bool(one.skipped) for one in suite] == [False, True, False]
    page = board_page("microsat", "./board", found)
    assert "✗ 1 failed" in page
    assert "there is no status" in page


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--board", "no-such-board"), "there is no program 'no-such-board'"),
        (("--board", "sh", "--flight-software", "sh"), "it drives the coils of the board, give --arm"),
        (("--flight-software", "sh", "--paced", "--pace", "lockstep"), "--paced, --pace lockstep: both say"),
        (("--flight-software", "sh", "--pace", "realtime:5", "--paced"), "--paced, --pace realtime:5: both"),
        (("--arm", "--flight-software", "sh"), "--arm"),
    ],
)
def test_bad_input_is_one_sentence(tmp_path, monkeypatch, words, says):
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(main, ["judge", "microsat", *words])
    assert (done.exit_code, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert says in done.stderr


def test_a_continuous_board_is_refused(tmp_path):
    with pytest.raises(HarnessError, match="a pulsed board is judged"):
        check_board(stub(), load("detumble3u"), tmp_path)
