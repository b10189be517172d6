"""A folder that was received, with symbolic links in it: no command writes anywhere but in the folder."""

import os

import pytest

from sim.campaign.definition.campaign_file import load_campaign
from sim.campaign.one_run import keep_run, run_folder
from sim.campaign.results.store import LOCK, RESULTS, open_results, read_results
from sim.errors import HarnessError
from sim.record import run_dir
from sim.scenario.schema import load

TEMPORARY = [f".{name}.{os.getpid()}" for name in run_dir.RESULTS]
"""Names that an earlier version gave to what it wrote."""


@pytest.fixture
def elsewhere(tmp_path):
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    return folder


def content(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def planted(run, elsewhere):
    """Each file of the run behind a link, and links by names that might be written."""
    for path in [*run.iterdir()]:
        path.rename(elsewhere / path.name)
        path.symlink_to(elsewhere / path.name)
    for name in TEMPORARY:
        (elsewhere / name[1:]).write_text("precious")
        (run / name).symlink_to(elsewhere / name[1:])
    return content(elsewhere)


@pytest.mark.long
def test_a_report_replaces_links_and_leaves_what_they_lead_to(run, elsewhere, torquer):
    before = planted(run, elsewhere)
    assert torquer("report", run).code == 0
    assert content(elsewhere) == before
    assert not any((run / name).is_symlink() for name in run_dir.RESULTS)
    assert (run / run_dir.REPORT).read_text().startswith("<!DOCTYPE html>")


@pytest.mark.long
def test_no_figure_is_drawn_through_a_link(run, elsewhere, torquer):
    (run / "figures").symlink_to(elsewhere)
    before = (run / run_dir.REPORT).stat().st_mtime_ns
    drawn = torquer("report", run, "--figures", "svg")
    assert (drawn.code, content(elsewhere)) == (2, {})
    assert (run / run_dir.REPORT).stat().st_mtime_ns == before, "nothing was done"
    (run / "figures").unlink()
    (run / "figures").mkdir()
    (run / "figures" / "pointing.svg").symlink_to(elsewhere / "new")
    assert torquer("report", run, "--figures", "svg").code == 0
    assert content(elsewhere) == {}
    assert (run / "figures" / "pointing.svg").is_file()


@pytest.mark.long
@pytest.mark.parametrize("name", [run_dir.REPORT, run_dir.SUMMARY])
def test_a_link_to_nothing_makes_nothing_elsewhere(name, run, elsewhere, torquer):
    (run / name).unlink()
    (run / name).symlink_to(elsewhere / "new")
    assert torquer("report", run).code == 0
    assert content(elsewhere) == {}
    assert (run / name).is_file()


@pytest.mark.parametrize("name", run_dir.FILES)
def test_nothing_is_flown_into_a_folder_with_a_link(name, elsewhere, tmp_path):
    run = tmp_path / "run"
    run.mkdir()
    (run / name).symlink_to(elsewhere / "new")
    with pytest.raises(HarnessError, match="already holds a run: choose another --out"):
        run_dir.begin(run, load("microsat"), 1, 10, "virtual", run_dir.Pace())
    assert content(elsewhere) == {}
    assert [path.name for path in run.iterdir()] == [name]


@pytest.mark.parametrize(
    "words", [("export", "run", "--out", "out.csv"), ("check", "run", "--junit", "out.xml")]
)
def test_a_result_takes_the_place_of_a_link(words, run, elsewhere, torquer, monkeypatch):
    monkeypatch.chdir(run.parent)
    (elsewhere / "there").write_text("<?xml?><testsuites/>")
    (run.parent / words[-1]).symlink_to(elsewhere / "there")
    assert torquer(*words, *(("--force",) if words[0] == "export" else ())).code == 0
    assert content(elsewhere) == {"there": b"<?xml?><testsuites/>"}
    assert not (run.parent / words[-1]).is_symlink()


@pytest.fixture
def campaign():
    return load_campaign("microsat", {"runs": 2, "orbits": 0.002}, {})


@pytest.mark.long
@pytest.mark.parametrize("end", ["", "-wal", "-shm", "-journal"])
@pytest.mark.parametrize("name", [RESULTS, LOCK])
def test_no_database_is_written_through_a_link(name, end, campaign, elsewhere, tmp_path):
    folder = tmp_path / "campaign"
    folder.mkdir()
    with open_results(folder, campaign):
        pass
    path = folder / f"{name}{end}"
    path.unlink(missing_ok=True)
    path.symlink_to(elsewhere / "new")
    with pytest.raises(HarnessError, match=f"{name}{end} is a symbolic link"), open_results(folder, campaign):
        pass
    if name == RESULTS and not end:
        with pytest.raises(HarnessError, match=r"has no results\.sqlite"), read_results(folder):
            pass
    assert content(elsewhere) == {}


@pytest.mark.parametrize("name", ["runs", "runs/0"])
def test_no_run_is_kept_behind_a_link(name, campaign, elsewhere, tmp_path):
    (elsewhere / run_dir.BUS_LOG).write_text("precious")
    path = tmp_path / "campaign" / name
    path.parent.mkdir(parents=True)
    path.symlink_to(elsewhere)
    with pytest.raises(HarnessError, match=f"{name} is a symbolic link"):
        keep_run(run_folder(tmp_path / "campaign", 0), campaign, campaign.draw(0))
    assert content(elsewhere) == {run_dir.BUS_LOG: b"precious"}
