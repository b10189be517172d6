"""The help of every command: examples that are command lines, and lines that say the same in both places."""

import shlex

import click
import pytest

from torquer.cli.main import COMMANDS, GROUPS, main

LINES = {name: line for group in GROUPS.values() for name, line in group.items()}


def command(name):
    return main.get_command(click.Context(main), name)


def examples():
    for name in COMMANDS:
        for line in (command(name).epilog or "").splitlines():
            if line.strip().startswith("torquer "):
                yield pytest.param(name, line.strip(), id=line.strip().partition("  #")[0])


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_ends_its_help_with_two_to_four_examples(name):
    lines = [parameter.values[1] for parameter in examples() if parameter.values[0] == name]
    assert 2 <= len(lines) <= 4


@pytest.mark.parametrize(("name", "line"), list(examples()))
def test_every_example_is_a_command_line(name, line):
    before_pipe = line.partition(" > ")[0]
    program, first, *words = shlex.split(before_pipe, comments=True)
    assert (program, first) == ("torquer", name)
    found = command(name)
    context = found.make_context(name, words)
    if isinstance(found, click.Group):
        board, *rest = context._protected_args + context.args
        found.get_command(context, board).make_context(board, rest)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_can_be_quiet_and_verbose(name):
    options = {word for one in command(name).params for word in one.opts}
    assert {"-q", "--quiet", "-v", "--verbose"} <= options


@pytest.mark.parametrize(
    "name",
    [
        "sil",
        "check",
        "replay",
        "report",
        "scenarios",
        "design",
        "calibrate",
        "telemetry",
        "compare",
        "campaign",
        "faults",
        "validate",
        "hil",
        "doctor",
        "size",
        "new",
    ],
)
def test_what_programs_may_read_has_json(name):
    assert "--json" in {word for one in command(name).params for word in one.opts}


@pytest.mark.parametrize("name", ["sil", "report", "check", "validate", "faults", "campaign"])
def test_what_judges_has_junit(name):
    assert "--junit" in {word for one in command(name).params for word in one.opts}


@pytest.mark.parametrize("name", COMMANDS)
def test_the_line_of_a_command_is_short(name):
    assert LINES[name].endswith(".")
    assert len(LINES[name]) < 78
