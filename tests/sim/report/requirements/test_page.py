"""The page of requirements against runs: each run by a name of its own, with a link to its report."""

from pathlib import Path

from sim.report.requirements.matrix import JudgedRun, matrix
from sim.report.requirements.page import judged_runs, write_matrix_page

APE = {"id": "R-1", "index": "ape", "what": "attitude", "limit": 1.0, "unit": "deg", "by_orbit": 5.0}
MET, FAILED = APE | {"measured": 0.5, "verdict": "met"}, APE | {"measured": 2.0, "verdict": "failed"}


def test_runs_of_one_name_are_told_apart_and_their_links_go_from_the_page(tmp_path):
    folders = [tmp_path / "x" / "run", tmp_path / "y" / "run", tmp_path / "a run"]
    runs = judged_runs([(folder, {"requirements": []}) for folder in folders], tmp_path / "page.html")
    assert [run.name for run in runs] == [str(folders[0]), str(folders[1]), "a run"]
    assert [run.page for run in runs] == ["x/run/report.html", "y/run/report.html", "a%20run/report.html"]


def page_of(tmp_path: Path, *requirements) -> str:
    runs = [JudgedRun(f"run_{place}", [one], "r/report.html") for place, one in enumerate(requirements)]
    write_matrix_page(tmp_path / "page.html", matrix(runs), runs)
    return (tmp_path / "page.html").read_text()


def test_it_shows_verdicts_and_links(tmp_path):
    page = page_of(tmp_path, MET, FAILED)
    for words in (
        "1 of 1 requirement missed by a run",
        '<a href="r/report.html">run_<wbr>1</a>',
        '<td class="good" data-head="run_0"><a href="r/report.html">✓ 0.5 (+0.5)</a></td>',
        "✗ 2 (-1)",
    ):
        assert words in page


def test_green_is_what_was_judged_alone(tmp_path):
    assert "no run misses one" in page_of(tmp_path, MET)
    unjudged = page_of(tmp_path, APE | {"measured": None, "verdict": "not judged"})
    assert "no run misses one" not in unjudged
    assert '<li class="note">! not judged</li>' in unjudged
