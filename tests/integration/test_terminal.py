"""On a terminal nothing of a foreign file moves the cursor or colours anything, and our own bars work."""

import json
import os
import pty
import sqlite3
import subprocess
import sys
from contextlib import closing, suppress

import pytest

from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.one_run import Keep, RunTask
from sim.campaign.results.store import RESULTS, open_results

pytestmark = pytest.mark.long

HOSTILE = "\x1b[31mred\x1b]0;title\x07\x9b2J\u202etxt\r"
"""Colours, a title of the window, a screen wiped by C1, text that runs backwards, a line begun again."""
RAW = ("\x1b[31m", "\x1b]0", "\x07", "\x9b", "\u202e", "\rOK")


def on_terminal(*words):
    """Exit code, and all that a terminal would be sent."""
    master, slave = pty.openpty()
    command = [sys.executable, "-m", "torquer", *map(str, words)]
    process = subprocess.Popen(
        command, stdin=slave, stdout=slave, stderr=slave, env={**os.environ, "TERM": "xterm"}
    )
    os.close(slave)
    sent = b""
    with suppress(OSError):  # the other end is closed
        while piece := os.read(master, 65536):
            sent += piece
    os.close(master)
    return process.wait(), sent.decode()


def check_harmless(sent):
    assert not [raw for raw in RAW if raw in sent]
    assert r"\x1b[31mred\x1b]0;title\x07\x9b2J\u202etxt\r" in sent


def test_a_foreign_run_json_is_shown_escaped(run):
    path = run / "run.json"
    content = json.loads(path.read_text())
    content["platform"]["algebra"] = HOSTILE
    content["torquer_version"] = HOSTILE
    path.write_text(json.dumps(content))
    code, sent = on_terminal("replay", run)
    assert code == 0
    assert not [raw for raw in RAW if raw in sent]


def test_so_is_a_name_of_a_file(run):
    named = run.with_name(f"run{HOSTILE}")
    run.rename(named)
    code, sent = on_terminal("report", named)
    assert code == 0
    check_harmless(sent)


def test_so_are_foreign_results(tmp_path):
    campaign = load_campaign("microsat", {"runs": 1, "orbits": 0.002}, {})
    campaign.write(tmp_path)
    with open_results(tmp_path, campaign) as results:
        results.add(RunTask(campaign, Keep.NONE, tmp_path).fly(0))
    with closing(sqlite3.connect(tmp_path / RESULTS)) as connection, connection:
        connection.execute("UPDATE runs SET status = 'failed', failure = ?, success = 0", (HOSTILE,))
        connection.execute("DELETE FROM profiles")
    code, sent = on_terminal("campaign", tmp_path)
    assert code == 1
    check_harmless(sent)


@pytest.mark.slow
def test_our_own_bar_is_drawn(tmp_path):
    code, sent = on_terminal(
        "sil", "microsat", "--orbits", "0.2", "--bus", "virtual", "--out", tmp_path / "run"
    )
    assert code == 0
    assert "\x1b[" in sent
    assert "flying microsat" in sent
    assert "\N{BOX DRAWINGS HEAVY HORIZONTAL}" in sent
