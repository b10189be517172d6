"""What a command says, and where."""

import json
from fractions import Fraction
from math import inf, nan
from pathlib import Path

import pytest

from sim.console import (
    Console,
    answer,
    counted,
    current,
    detail,
    document,
    fail,
    plain,
    print_document,
    say,
    speaking,
    warn,
)


def said(console, capsys):
    """(stdout, stderr) of everything that can be said."""
    with speaking(console):
        say("result")
        say("broken", failed=True)
        detail("step")
        warn("doubt")
        fail("why")
    return capsys.readouterr()


@pytest.mark.parametrize(
    ("modes", "out", "err"),
    [
        ({}, "result\nbroken\n", "torquer: warning: doubt\ntorquer: why\n"),
        ({"quiet": True}, "broken\n", "torquer: why\n"),
        ({"verbose": True}, "result\nbroken\n", "step\ntorquer: warning: doubt\ntorquer: why\n"),
        ({"as_json": True}, "", "torquer: warning: doubt\ntorquer: why\n"),
    ],
    ids=lambda value: "-".join(value) if isinstance(value, dict) else "",
)
def test_each_mode_says_its_part(modes, out, err, capsys):
    assert said(Console("sil", **modes), capsys) == (out, err)


def test_without_a_command_all_lines_are_said(capsys):
    say("result")
    assert capsys.readouterr().out == "result\n"
    assert current() == Console()


def test_a_console_ends_with_its_command():
    with speaking(Console("sil", quiet=True)):
        assert current().quiet
    assert not current().quiet


def test_a_document_has_the_same_head_for_every_command(capsys):
    with speaking(Console("check", as_json=True)) as console:
        answer({"ok": True})
        answer({"duty": 0.5})
        warn("doubt")
        print_document(console, 1)
    values = json.loads(capsys.readouterr().out)
    assert list(values) == [
        "command",
        "torquer_version",
        "schema_version",
        "exit_code",
        "warnings",
        "ok",
        "duty",
    ]
    assert (values["command"], values["exit_code"], values["warnings"]) == ("check", 1, ["doubt"])


def test_a_document_is_json_whatever_it_holds():
    values = plain(
        {"a": inf, "b": nan, "c": Fraction(1, 4), "d": Path("x/y"), 5: (1, None), "e": {"f": -inf}}
    )
    assert values == {"a": None, "b": None, "c": 0.25, "d": "x/y", "5": [1, None], "e": {"f": None}}
    json.dumps(document(Console("x", answer=values), 0), allow_nan=False)


def test_what_cannot_be_printed_is_escaped(capsys):
    fail("a\nb\x1b[31m")
    assert capsys.readouterr().err == "torquer: a\\nb\\x1b[31m\n"


@pytest.mark.parametrize(("number", "text"), [(0, "0 runs"), (1, "1 run"), (2, "2 runs")])
def test_one_thing_has_no_plural(number, text):
    assert counted(number, "run") == text
