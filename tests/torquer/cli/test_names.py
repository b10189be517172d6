"""Options have the names that other tools have taught, beside their own; docs/names.md says which."""

import re
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from torquer.cli.main import COMMANDS, main

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "names.md").read_text(encoding="utf-8")


def options_of(name):
    command = main.get_command(click.Context(main), name)
    return {tuple(option.opts): option for option in command.params if isinstance(option, click.Option)}


def with_option(word):
    """The commands that have an option of this name, each with all its names."""
    return [(name, opts) for name in COMMANDS for opts in options_of(name) if word in opts]


@pytest.mark.parametrize(
    ("long", "names"),
    [
        ("--out", {"-o"}),
        ("--workers", {"-n"}),
        ("--junit", {"--junit-xml", "--junitxml"}),
        ("--quiet", {"-q"}),
        ("--verbose", {"-v"}),
    ],
)
def test_an_option_has_its_short_and_its_learnt_names_in_every_command(long, names):
    found = with_option(long)
    assert len(found) > 2
    for name, opts in found:
        assert names <= {*opts}, name


def test_no_two_options_of_a_command_share_a_name():
    for name in COMMANDS:
        words = [word for opts in options_of(name) for word in opts]
        assert len(words) == len(set(words)), name


def test_what_selects_is_called_only_and_the_former_name_still_selects():
    assert {name for name, _ in with_option("--only")} == {"faults", "validate"}
    assert ("faults", ("--only", "--row")) in with_option("--row")


def test_the_version_is_said_by_both_names():
    short, long = (CliRunner().invoke(main, [word]) for word in ("-V", "--version"))
    assert short.exit_code == 0
    assert short.stdout == long.stdout


def test_the_page_names_options_and_commands_that_there_are():
    words = {word for name in COMMANDS for opts in options_of(name) for word in opts} | {
        "-h",
        "-V",
        "--version",
    }
    here = " ".join(
        line.split("|")[3] for line in PAGE.splitlines() if line.startswith("| ") and "---" not in line
    )
    named = {word for word in re.findall(r"`(--?[a-z][a-z-]*)", here, re.IGNORECASE)}
    assert len(named) > 8
    assert named <= words
