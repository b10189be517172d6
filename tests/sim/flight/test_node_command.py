"""A command is started with the address of the bus; one that cannot be is told before anything is flown."""

import sys

import pytest

from sim.errors import HarnessError
from sim.flight.node_command import NodeCommand, last_words, parse_command

PRINT = "import os, sys; print(*sys.argv[1:], os.environ['TORQUER_BUS'], os.environ['TORQUER_PORT'])"


def test_the_bus_stands_in_its_words_and_in_its_environment(tmp_path):
    command = NodeCommand((sys.executable, "-c", PRINT, "--bus={bus}", "{port}", "{else}"))
    command.start("loop:1234", {}, tmp_path / "said").wait()
    assert last_words(tmp_path / "said") == "--bus=loop:1234 1234 {else} loop:1234 1234"


def test_further_values_are_given_likewise(tmp_path):
    command = NodeCommand(("sh", "-c", "echo {tick_hz} $TORQUER_TICK_HZ"))
    command.start("loop:1", {"tick_hz": "10"}, tmp_path / "said").wait()
    assert last_words(tmp_path / "said") == "10 10"


def test_what_is_put_in_is_not_looked_through_for_names(tmp_path):
    command = NodeCommand(("echo", "{bus}", "{folder}"))
    command.start("loop:1", {"folder": "/tmp/{name}", "name": "x"}, tmp_path / "said").wait()
    assert last_words(tmp_path / "said") == "loop:1 /tmp/{name}"


def test_a_quoted_word_is_one_word():
    assert parse_command("sh -c 'exit 3'", "--flight-software").words == ("sh", "-c", "exit 3")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "the command is empty"),
        ("sh -c 'x", "no closing quotation"),
        ("no-such-program-here 1", "there is no program 'no-such-program-here' that can be executed"),
    ],
)
def test_what_is_no_command_is_told(text, says):
    with pytest.raises(HarnessError, match=says):
        parse_command(text, "--flight-software")


def test_last_words_are_short_and_none_of_a_silent_one(tmp_path):
    said = tmp_path / "said"
    assert last_words(said) == ""
    said.write_bytes(b"one\n" + b"x" * 5000 + b"\n\n")
    assert last_words(said) == "x" * 200
