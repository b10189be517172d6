"""A user law by the commands: as processes, failing, in campaigns and comparisons, and installed."""

import json
import shutil
import sqlite3
import sys
from pathlib import Path

import pytest

from fsw.input import own_code
from sim.campaign.results.store import RESULTS

pytestmark = pytest.mark.long

EXAMPLE = Path(__file__).parents[2] / "examples" / "projected_pd"
SHORT = (
    *("--orbits", "0.04", "--set", "flight.modes.settle_s=20.0"),
    *("--set", "flight.modes.slow_degps=2.0", "--set", "flight.modes.fast_degps=4.0"),
)
BAD = """
from fsw.own_law import Demand

def law(inputs, memory, setpoint, config):
    return Demand() if inputs.tick < 200 else 1 / 0
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current directory, with the example's law and a bad one."""
    shutil.copy(EXAMPLE / "projected_pd.py", tmp_path)
    (tmp_path / "bad.py").write_text(BAD)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sim.report.conclude.write_report", lambda path, *rest: path.write_text(""))
    return tmp_path


LAW = "projected_pd.py:projected_pd"


@pytest.mark.slow
def test_two_processes_fly_what_one_does(torquer, folder, bus):
    assert torquer("sil", "microsat", *SHORT, "--bus", "loop", "--law", LAW, "--out", "two").code == 0
    assert torquer("sil", "microsat", *SHORT, "--bus", "virtual", "--law", LAW, "--out", "one").code == 0
    assert bus("one").frames == bus("two").frames
    mpc = torquer("sil", "microsat", *SHORT, "--bus", "virtual", "--out", "mpc")
    assert mpc.code == 0
    assert bus("mpc").frames != bus("one").frames
    refused = torquer("replay", "one")
    assert (refused.code, "--law" in refused.sentence) == (2, True)
    assert torquer("check", "one").code == 0
    assert torquer("replay", "one", "--law", LAW).code == 0
    report = torquer("report", "one", "--law", "bad.py:law")
    assert (report.code, "the run flew another law" in report.sentence) == (2, True)


@pytest.mark.parametrize("bus", ["virtual", "loop"])
def test_a_law_that_fails_fails_the_flight_without_a_traceback(torquer, folder, bus):
    ended = torquer("sil", "microsat", *SHORT, "--bus", bus, "--law", "bad.py:law", "--out", "run")
    assert ended.code == 1
    assert "the law law of bad.py, tick 200: it fails: line 5: ZeroDivisionError" in ended.err
    assert "Traceback" not in ended.err
    assert not json.loads((folder / "run" / "run.json").read_text())["complete"]


@pytest.mark.parametrize(
    ("law", "what"),
    [
        ("none.py:law", "none.py: cannot be read (No such file or directory)"),
        ("bad.py:lwa", "bad.py: there is no lwa in it"),
        ("bad.py", "--law bad.py: which law of the file? Write bad.py:NAME"),
        ("nobodys", "or the entry point of a package"),
    ],
)
def test_a_law_that_cannot_be_flown_leaves_nothing(torquer, folder, law, what):
    ended = torquer("sil", "microsat", "--bus", "virtual", "--law", law, "--out", "run")
    assert (ended.code, ended.err.count("\n")) == (2, 1)
    assert what in ended.err
    assert not (folder / "run").exists()


def test_workers_of_a_campaign_fly_it(torquer, folder, monkeypatch):
    monkeypatch.setattr("sim.campaign.report.page.write_page", lambda path, *rest: path.write_text(""))
    words = ("--runs", "3", "--orbits", "0.04", "--workers", "2", "--out", "camp", "--law", LAW)
    assert torquer("campaign", "microsat", *words).code == 0
    with sqlite3.connect(folder / "camp" / RESULTS) as connection:
        assert connection.execute("SELECT status FROM runs").fetchall() == [("done",)] * 3
    again = torquer("sil", "--from", "camp", "--run", "1", "--bus", "virtual", "--out", "again")
    assert again.code == 0
    assert "bit for bit" in again.out
    wrong = torquer("campaign", "microsat", "--law", "bad.py:lwa", "--out", "wrong")
    assert (wrong.code, wrong.err.count("\n")) == (2, 1)


def test_it_is_compared_with_those_of_the_table(torquer, folder):
    words = ("--laws", "projected_pd,pd", "--driver", "pulsed", "--orbits", "0.02", "--workers", "1")
    assert torquer("compare", "microsat", *words, "--law", LAW, "--out", "compared").code == 0
    rows = json.loads((folder / "compared" / "compare.json").read_text())["rows"]
    assert {(row["law"], row["aim"], row["failure"]) for row in rows} == {
        ("projected_pd", "three_axis", ""),
        ("pd", "three_axis", ""),
    }


def test_a_comparison_fails_where_it_fails(torquer, folder):
    words = ("--laws", "law", "--driver", "pulsed", *SHORT, "--workers", "1", "--law", "bad.py:law")
    ended = torquer("compare", "microsat", *words, "--out", "failed")
    assert ended.code == 1
    assert "torquer: law (pulsed) was not flown: the law law of bad.py, tick 200: it fails" in ended.err


def test_an_installed_law_flies_by_its_name(torquer, folder, monkeypatch):
    info = folder / "projected_pd-0.1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: projected-pd\nVersion: 0.1.0\n")
    (info / "entry_points.txt").write_text("[torquer.laws]\nprojected_pd = projected_pd:projected_pd\n")
    monkeypatch.syspath_prepend(str(folder))
    own_code.find("projected_pd", folder, "torquer.laws")
    gains = ("--set", "control.gains.projected_pd.damping_nms=0.01")
    flown = torquer(
        "sil", "microsat", *SHORT, *gains, "--bus", "loop", "--law", "projected_pd", "--out", "run"
    )
    sys.modules.pop("projected_pd", None)
    assert flown.code == 0, flown.err
    assert 'law = "projected_pd"' in (folder / "run" / "scenario.toml").read_text()
    assert torquer("replay", "run", "--law", "projected_pd").code == 0
    assert torquer("replay", "run").code == 2
    sys.modules.pop("projected_pd", None)
