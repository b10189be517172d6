"""The commands of the quick start and of the tutorial do what they say, in order, on short orbits."""

import re
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner

from torquer.cli.main import main

DOCS = Path(__file__).resolve().parents[2] / "docs"
SHORT = (
    (r"--orbits [\d.]+", "--orbits 0.02"),
    (r"(?m)^orbits = [\d.]+", "orbits = 0.02"),
    (r"(?m)^runs = \d+", "runs = 4"),
    ("at_s=3000", "at_s=30"),
    ("at_s=9000", "at_s=60"),
    ("lasts_s=6000", "lasts_s=30"),
    (r"(?m)^pointing_deg = 5.0$", "pointing_deg = 180.0"),
)
"""What makes the flights of a page short, and what such flights can meet; nothing else is different."""


def shortened(page):
    text = (DOCS / page).read_text(encoding="utf-8")
    for pattern, short in SHORT:
        text = re.sub(pattern, short, text)
    return text


def files(text):
    """Name and content of the files that a page shows, each beginning with a comment that is its name."""
    return [
        (name, body)
        for body, name in re.findall(r"```(?:python|toml)\n(# (\w[\w-]*\.\w+)\n.*?)```", text, re.S)
    ]


def commands(text):
    blocks = re.findall(r"```console\n(.*?)```", text, re.S)
    return re.findall(r"(?m)^\$ torquer (.*)$", "\n".join(blocks))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sim.report.conclude.write_report", lambda path, *rest: path.write_text(""))
    return tmp_path


@pytest.mark.long
@pytest.mark.parametrize(("page", "least"), [("quickstart.md", 3), ("tutorial.md", 11)])
@pytest.mark.slow
def test_its_commands_run(page, least, folder):
    text = shortened(page)
    for name, body in files(text):
        (folder / name).write_text(body, encoding="utf-8")
    told = commands(text)
    assert len(told) >= least
    for command in told:
        done = CliRunner().invoke(main, shlex.split(command))
        assert done.exit_code == 0, f"torquer {command}\n{done.output}"


def labels(lines):
    """What stands at the beginning of the lines of a summary; None for those that are left out."""
    return [None if line.strip() == "..." else line[2:13].strip() for line in lines if line.startswith("  ")]


def test_the_quick_start_shows_the_lines_that_are_printed(folder):
    text = shortened("quickstart.md")
    (shown,) = re.findall(r"```console\n\$ torquer sil .*\n((?:.*\n)*?)report: ", text)
    done = CliRunner().invoke(main, shlex.split(commands(text)[0]))
    printed = labels(done.output.splitlines())
    begin, end = (list(part) for part in _around(labels(shown.splitlines())))
    assert len(begin) > 3
    assert printed[: len(begin)] == begin
    assert printed[len(printed) - len(end) :] == end


def _around(told):
    place = told.index(None)
    return told[:place], told[place + 1 :]


@pytest.mark.long
def test_the_python_of_the_quick_start_runs(folder):
    (code,) = re.findall(r"```python\n(.*?)```", (DOCS / "quickstart.md").read_text(encoding="utf-8"), re.S)
    exec(code.replace("orbits=4", "orbits=0.02"), {})
