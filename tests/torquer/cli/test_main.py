"""The ``torquer`` command: every command is there, and asking for help loads only what help needs."""

import json
import subprocess
import sys

import click
import pytest
from click.testing import CliRunner

from torquer.cli.main import COMMANDS, GROUPS, main

LOAD_AND_LIST = """
import json, sys
from torquer.cli.main import main
try:
    main(WORDS, prog_name="torquer")
except SystemExit as ended:
    sys.stdout.flush()
    print(json.dumps([ended.code or 0, sorted(sys.modules)]))
"""


@pytest.mark.parametrize("name", COMMANDS)
def test_each_command_is_in_the_module_of_its_name_and_has_help(name):
    command = main.get_command(click.Context(main), name)
    assert isinstance(command, click.Command)
    done = CliRunner().invoke(command, ["--help"])
    assert done.exit_code == 0
    assert done.output.startswith("Usage: ")
    assert command.get_short_help_str()


def test_a_command_that_is_not_in_the_table_is_refused():
    assert main.get_command(click.Context(main), "options") is None


@pytest.mark.parametrize("words", [["--help"], []], ids=["--help", "no words"])
def test_help_lists_all_commands_and_loads_no_numerics(words):
    script = LOAD_AND_LIST.replace("WORDS", repr(words))
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    *text, loaded = done.stdout.splitlines()
    code, modules = json.loads(loaded)
    assert code == 0
    begin, end = text.index("Fly:"), next(n for n, line in enumerate(text) if "a help of its own" in line)
    assert [line.split()[0] for line in text[begin:end] if line[2:3].strip() and line[0] == " "] == list(
        COMMANDS
    )
    assert [line[:-1] for line in text[begin:end] if line.endswith(":")] == list(GROUPS)
    assert {"numpy", "matplotlib"}.isdisjoint(modules)


@pytest.mark.parametrize("stream", ["stdin", "stdout", "stderr"])
def test_a_standard_stream_that_is_closed_is_no_error(stream, monkeypatch):
    monkeypatch.setattr(sys, stream, None)
    with pytest.raises(SystemExit) as ended:
        main(["scenarios", "--json"], prog_name="torquer")
    assert ended.value.code == 0
    assert not getattr(sys, stream).isatty()
