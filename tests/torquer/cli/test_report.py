"""``torquer report``: of several runs their requirements against each other, beside the reports rebuilt."""

import json
from xml.etree import ElementTree

import pytest

from torquer.cli.main import main

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Two flights of an orbit in one folder: one meets what is expected of it, one does not."""
    folder = tmp_path_factory.mktemp("runs")
    for name, most in (("loose", 170), ("tight", 0.001)):
        code(
            "sil", "microsat", "--bus", "virtual", "--orbits", 1.01, "--set", "initial.angle_deg=5",
            "--set", "requirement=[]", "--expect", f"ape<{most}", "--out", folder / name, "-q",
        )  # fmt: skip
    return folder


def code(*words):
    """The exit code of a command line."""
    with pytest.raises(SystemExit) as ended:
        main.main(list(map(str, words)), prog_name="torquer")
    return ended.value.code


@pytest.mark.slow
def test_several_runs_make_a_page_of_requirements_beside_them(runs, capsys):
    assert code("report", runs / "loose", runs / "tight") == 1
    said = capsys.readouterr()
    assert "met by 1 of 1" in said.out
    assert "tight: the flight failed: a requirement is missed" in said.err
    page = (runs / "requirements.html").read_text()
    assert 'href="loose/report.html"' in page
    assert 'href="tight/report.html"' in page


@pytest.mark.slow
def test_the_document_and_junit_have_every_run(runs, tmp_path, capsys):
    page, junit = tmp_path / "p.html", tmp_path / "j.xml"
    assert code("report", runs / "loose", runs / "tight", "--out", page, "--junit", junit, "--json") == 1
    values = json.loads(capsys.readouterr().out)
    assert [one["run"] for one in values["runs"]] == [str(runs / "loose"), str(runs / "tight")]
    assert [one["met"] for one in values["requirements"]] == [1, 0]
    assert values["page"] == str(page)
    suites = [suite.get("name") for suite in ElementTree.parse(junit).getroot()]
    assert suites == ["loose: flight", "loose: requirements", "tight: flight", "tight: requirements"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("loose", "loose/"), "is named twice"),
        (("loose", "nowhere"), "nowhere"),
        (("loose", "--out", "x.html"), "--out is for several runs"),
    ],
)
def test_what_makes_no_page_is_refused_before_any_work(runs, capsys, monkeypatch, words, said):
    monkeypatch.chdir(runs)
    before = (runs / "loose" / "report.html").stat().st_mtime_ns
    assert code("report", *words) == 2
    assert said in capsys.readouterr().err
    assert (runs / "loose" / "report.html").stat().st_mtime_ns == before
