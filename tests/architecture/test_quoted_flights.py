"""What the pages quote of flights is what these flights do."""

import json
import re
import shlex
from math import inf
from pathlib import Path

import pytest
from click.testing import CliRunner

from torquer.cli.main import main

DOCS = Path(__file__).resolve().parents[2] / "docs"
pytestmark = [pytest.mark.long, pytest.mark.slow]
"""Whole flights, as long as the pages say."""


def page(name):
    return (DOCS / name).read_text(encoding="utf-8")


def fly(command, failed=False):
    """The lines that a command prints, flown in one process."""
    again = command if "--bus" in command or command.startswith("campaign") else f"{command} --bus virtual"
    done = CliRunner().invoke(main, shlex.split(again))
    assert done.exit_code == int(failed), f"torquer {command}\n{done.output}"
    return done.output.splitlines()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sim.report.conclude.write_report", lambda path, *rest: path.write_text(""))
    return tmp_path


@pytest.mark.parametrize(
    ("name", "where", "failed"),
    [
        ("quickstart.md", r"\$ torquer (sil .*)", False),
        ("verdicts.md", r"the first lines of `torquer (sil .*?)`", True),
    ],
)
def test_a_summary_is_the_one_that_its_command_prints(name, where, failed, folder):
    shown = re.search(r"microsat, seed .*\n((?:  .*\n)+)", page(name)).group(1).splitlines()
    printed = fly(re.search(where, page(name)).group(1), failed)
    assert [line for line in shown if line.strip() != "..." and line not in printed] == []


class TestTutorial:
    """The flights of the tutorial, with its own files."""

    @pytest.fixture
    def flown(self, folder):
        """The summary of the flight into a folder, by its name."""
        text = page("tutorial.md")
        for body, name in re.findall(r"```(?:python|toml)\n(# (\w[\w-]*\.\w+)\n.*?)```", text, re.S):
            (folder / name).write_text(body, encoding="utf-8")

        def summary(name, failed=False):
            command = re.search(rf"(?m)^\$ torquer (sil .*--out {name}\b.*)$", text).group(1)
            fly(command, failed)
            return json.loads((folder / name / "summary.json").read_text())

        return summary

    @pytest.mark.parametrize("name", ["broken", "mended", "stiffer"])
    def test_when_a_flight_settles(self, name, flown):
        after = flown(name)["controlled"]["settle_orbits"]
        assert f"after {after:.2f} orbits" in " ".join(page("tutorial.md").split())

    def test_how_soon_the_reversed_coil_is_known(self, flown):
        (found,) = [e for e in flown("broken")["events"] if e["text"] == "coil 1 isolated: reversed"]
        assert f"after {(found['t_s'] - 3000.0) / 60.0:.0f} minutes" in page("tutorial.md")

    def test_the_first_flight_of_the_law_settles_too_late(self, flown):
        settled = flown("upright", failed=True)["controlled"].get("settle_orbits", inf)
        assert settled > 3.0

    @pytest.mark.timeout(1200)
    def test_all_runs_of_the_campaign_meet_its_requirement(self, flown):
        assert "All 20 meet it here" in page("tutorial.md")
        (share,) = [line for line in fly("campaign campaign.toml --out series") if "  success " in line]
        assert "20 of 20" in share
