"""``torquer campaign`` as a process: killed and resumed, its runs flown again, its results and page."""

import json
import re
import signal
import sqlite3
import subprocess
import sys
import time

import pytest
from click.testing import CliRunner

from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.one_run import Keep, RunTask
from sim.campaign.results.store import RESULTS
from torquer.cli.main import main

pytestmark = pytest.mark.long

RUNS = 12
FILE = f"""
scenario = "realsat"
runs = {RUNS}
orbits = 0.03
seed = 4
requirement.pointing_deg = 35.0

[[disperse]]
key = "initial.angle_deg"
distribution = "uniform"
low = 10.0
high = 70.0

[[disperse]]
key = "sensors.magnetometer.noise_nt"
distribution = "normal"
mean = 20.0
sigma = 20.0
"""


def torquer(*words):
    return CliRunner().invoke(main, [*map(str, words)])


@pytest.fixture
def no_report(monkeypatch):
    """It takes longer than these flights."""
    monkeypatch.setattr("sim.report.conclude.write_report", lambda path, *rest: path.write_text(""))
    monkeypatch.setattr("sim.campaign.report.page.write_page", lambda path, *rest: path.write_text(""))


def rows_in(folder):
    """Run, status and checksum of all runs."""
    connection = sqlite3.connect(f"file:{folder / RESULTS}?mode=ro", uri=True)
    try:
        return connection.execute(
            "SELECT run, status, frames_sha256, missed FROM runs ORDER BY run"
        ).fetchall()
    except sqlite3.OperationalError:  # not made yet
        return []
    finally:
        connection.close()


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    """(folder of a campaign whose process was killed and then resumed, its last output)."""
    path = tmp_path_factory.mktemp("campaign")
    file, folder = path / "some.toml", path / "out"
    file.write_text(FILE)
    words = ("campaign", file, "--workers", "2", "--out", folder)
    process = subprocess.Popen([sys.executable, "-m", "torquer.cli.main", *map(str, words)])
    while not (folder / RESULTS).exists() or not rows_in(folder):
        assert process.poll() is None
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert 0 < len(rows_in(folder)) < RUNS
    return folder, torquer("campaign", folder, "--workers", "1", "--keep", "failures")


@pytest.mark.slow
def test_a_killed_campaign_is_resumed_without_loss_or_repetition(campaign):
    folder, done = campaign
    task = RunTask(load_campaign(str(folder), {}, {}), Keep.NONE, folder)
    expected = [
        (row.run, row.status.value, row.cells.get("frames_sha256"), row.missed)
        for row in task.fly_all(range(RUNS))
    ]
    assert rows_in(folder) == expected
    flown = sqlite3.connect(folder / RESULTS).execute("SELECT count(*) FROM attempts").fetchone()
    assert flown == (RUNS,)
    assert "failed" in {status for _, status, *_ in expected}, "some noise is drawn below zero"
    assert done.exit_code == 1
    assert re.search(r"torquer: runs? [\d, and]+ failed", done.stderr)


def test_the_page_and_the_text_say_what_happened(campaign):
    folder, done = campaign
    assert f"realsat: {RUNS} runs of 0.03 orbits" in done.stdout
    assert "noise_nt = -" in done.stdout
    page = (folder / "campaign.html").read_text()
    for words in (
        "Clopper",
        "ECSS-E-ST-60-10C",
        "Worst runs over the rest",
        "Runs that failed",
        "initial angle [deg]",
    ):
        assert words in page
    assert "<script src" not in page
    assert "default-src 'none'" in page.replace("&#39;", "'"), "nothing is loaded from elsewhere"


@pytest.mark.slow
def test_a_scenario_whose_runs_differ_by_their_seed_alone_is_a_campaign(tmp_path):
    """Nothing is dispersed: there is no input to correlate with, and no picture of any."""
    ended = torquer(
        "campaign", "microsat", "--runs", "3", "--orbits", "0.02", "--workers", "1", "--out", tmp_path
    )
    assert ended.exit_code == 0, ended.output
    assert "3 of 3" in ended.output
    assert [status for _, status, *_ in rows_in(tmp_path)] == ["done"] * 3
    assert len({frames for _, _, frames, _ in rows_in(tmp_path)}) == 3
    assert "<svg" in (tmp_path / "campaign.html").read_text()


@pytest.mark.usefixtures("no_report")
@pytest.mark.parametrize("bus", ["virtual", "loop"])
def test_a_run_flies_again_equal_bit_for_bit(campaign, bus, tmp_path):
    folder, _ = campaign
    run, *_ = next(row for row in rows_in(folder) if row[1] == "done")
    done = torquer("sil", "--from", folder, "--run", run, "--bus", bus, "--out", tmp_path / "again")
    assert done.exit_code == 0, done.stderr
    assert f"equal to run {run} of {folder} bit for bit" in done.stdout


@pytest.mark.usefixtures("no_report")
def test_a_changed_result_is_noticed(campaign, tmp_path):
    folder, _ = campaign
    other = tmp_path / "other"
    other.mkdir()
    for name in ("campaign.toml", "scenario.toml", RESULTS):
        (other / name).write_bytes((folder / name).read_bytes())
    run, *_ = next(row for row in rows_in(folder) if row[1] == "done")
    with sqlite3.connect(other / RESULTS) as connection:
        connection.execute("UPDATE runs SET frames_sha256 = 'x', commands_sha256 = 'y'")
    done = torquer("sil", "--from", other, "--run", run, "--bus", "virtual", "--out", tmp_path / "again")
    assert done.exit_code == 1
    assert f"NOT equal to run {run}" in done.stdout


def test_missed_runs_were_kept(campaign):
    folder, _ = campaign
    kept = {int(path.name) for path in (folder / "runs").iterdir()}
    missed = {run for run, status, _, missed in rows_in(folder) if status == "done" and missed}
    assert kept <= missed  # the first rows were flown without --keep
    assert (folder / "runs" / str(max(kept)) / "bus.log").stat().st_size > 10_000


@pytest.mark.usefixtures("no_report")
def test_retry_flies_failed_runs_alone(campaign):
    folder, _ = campaign
    before = rows_in(folder)
    failed = [run for run, status, *_ in before if status == "failed"]
    done = torquer("campaign", folder, "--retry", "--workers", "1")
    assert f"{len(failed)} of {len(failed)} runs, {len(failed)} failed" in done.stderr
    assert rows_in(folder) == before


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--seed", "2"), "of its options only the number of runs can change"),
        (("--set", "control.k_w=1.0"), "of its options only the number of runs can change"),
    ],
)
def test_a_campaign_that_has_begun_does_not_change(campaign, words, sentence):
    folder, _ = campaign
    done = torquer("campaign", folder, *words)
    assert (done.exit_code, done.stdout) == (2, "")
    assert sentence in done.stderr


REFUSED = {
    "another seed": (
        ("campaign", "FILE", "--seed", "9", "--out", "OUT"),
        "holds the runs of another campaign",
    ),
    "no campaign": (("campaign", "EMPTY"), "has no campaign.toml"),
    "no such run": (("sil", "--from", "OUT", "--run", "12"), "has the runs 0 to 11"),
    "no number": (("sil", "--from", "OUT"), "--from DIR and --run NUMBER belong together"),
    "settings": (
        ("sil", "--from", "OUT", "--run", "1", "--seed", "3"),
        "--seed: with --from the run is as its campaign drew it",
    ),
    "nothing": (("sil", "--from", "EMPTY", "--run", "1"), "it has no campaign.toml"),
}


@pytest.mark.parametrize(("words", "sentence"), REFUSED.values(), ids=REFUSED)
def test_a_wrong_command_is_one_sentence(campaign, words, sentence, tmp_path):
    folder, _ = campaign
    (tmp_path / "empty").mkdir()
    places = {
        "OUT": folder,
        "FILE": folder.parent / "some.toml",
        "EMPTY": tmp_path / "empty",
        "NEW": tmp_path / "new",
    }
    done = torquer(*(places.get(word, word) for word in words))
    assert (done.exit_code, done.stdout) == (2, "")
    assert sentence in done.stderr
    assert done.stderr.startswith("torquer: ")
    assert done.stderr.count("\n") == 1


OF_DIFFERENT_LENGTHS = """
scenario = "microsat"
runs = 3
orbits = 0.02
index.ape = 1.0

[[disperse]]
key = "time.orbits"
distribution = "uniform"
low = 0.01
high = 0.06
"""


@pytest.mark.slow
def test_runs_of_different_lengths_have_a_page(tmp_path):
    (tmp_path / "some.toml").write_text(OF_DIFFERENT_LENGTHS)
    words = ("campaign", tmp_path / "some.toml", "--workers", "1", "--out", tmp_path / "out")
    ended = torquer(*words, "--junit", tmp_path / "junit.xml")
    assert ended.exit_code == 1, "an index is missed"
    heading = re.search(r"microsat: 3 runs of (0\.0\d+) to (0\.0\d+) orbits", ended.stdout)
    assert 0.01 <= float(heading[1]) < float(heading[2]) <= 0.06
    assert heading[0].removeprefix("microsat: ") in (tmp_path / "out" / "campaign.html").read_text().replace(
        "3 of 3 runs", "3 runs"
    )
    assert "<failure" in (tmp_path / "junit.xml").read_text()


def test_a_page_that_cannot_be_made_takes_no_verdict_with_it(campaign, monkeypatch):
    folder, _ = campaign

    def broken(*_):
        raise ValueError("no ink")

    monkeypatch.setattr("sim.campaign.report.page.write_page", broken)
    again = torquer("campaign", folder, "--json")
    assert again.exit_code == 1
    assert json.loads(again.stdout)["success"]["total"] == RUNS
    assert "campaign.html was not made: ValueError: no ink" in again.stderr
    assert not (folder / "campaign.html").exists()
