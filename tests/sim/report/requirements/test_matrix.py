"""Requirements against runs: one row a requirement, one cell a run, and no verdict that no run has given."""

from pathlib import Path

import pytest

from sim.report.requirements.matrix import (
    JudgedRun,
    judged_runs,
    matrix,
    matrix_json,
    matrix_lines,
    matrix_table,
    write_matrix_page,
)

APE = {"id": "REQ-01", "index": "ape", "what": "attitude", "limit": 1.0, "unit": "deg", "by_orbit": 5.0}
DUTY = {"id": None, "index": "duty", "what": None, "limit": 20.0, "unit": "%", "by_orbit": 5.0}


def judged(one, measured, verdict=None):
    return one | {
        "measured": measured,
        "verdict": verdict or ("met" if measured <= one["limit"] else "failed"),
    }


RUNS = [
    JudgedRun("a", [judged(APE, 0.4), judged(DUTY, 12.0)], "a/report.html"),
    JudgedRun("b", [judged(DUTY, 25.0), judged(APE, 1.5)]),
    JudgedRun("short", [judged(APE, None, "not judged")]),
    JudgedRun("bare", []),
]


def test_a_requirement_is_one_row_wherever_it_stands_in_its_run():
    ape, duty = matrix(RUNS)
    assert (ape.words, duty.words) == ("REQ-01: APE of whole attitude", "duty")
    assert [cell and cell.measured for cell in ape.cells] == [0.4, 1.5, None, None]
    assert [cell and cell.margin for cell in ape.cells] == [
        pytest.approx(0.6),
        pytest.approx(-0.5),
        None,
        None,
    ]
    assert ape.cells[3] is None
    assert duty.cells[2:] == (None, None)


def test_a_run_that_was_not_judged_counts_neither_way():
    ape, duty = matrix(RUNS)
    assert (ape.share, duty.share) == ("1 of 2, 1 not judged", "1 of 2")
    (only,) = matrix(RUNS[2:])
    assert only.share == "not judged"
    assert matrix_lines([only], RUNS[2:])[0] == "REQ-01: APE of whole attitude, at most 1 deg: not judged"


def test_without_a_name_another_limit_is_another_requirement():
    runs = [JudgedRun("a", [judged(DUTY, 12.0)]), JudgedRun("b", [judged(DUTY | {"limit": 5.0}, 12.0)])]
    assert [row.limit for row in matrix(runs)] == ["at most 20 %", "at most 5 %"]


def test_under_one_name_each_run_is_judged_by_its_own_limit():
    runs = [JudgedRun("a", [judged(APE, 0.4)]), JudgedRun("b", [judged(APE | {"limit": 0.3}, 0.4)])]
    (row,) = matrix(runs)
    assert row.limit == "at most 0.3 or 1 deg"
    assert [cell.verdict for cell in row.cells] == ["met", "failed"]


def test_equal_ones_without_a_name_stay_apart():
    both = JudgedRun("a", [judged(DUTY, 12.0), judged(DUTY, 13.0)])
    assert [[cell.measured for cell in row.cells] for row in matrix([both])] == [[12.0], [13.0]]


def test_the_table_has_a_column_a_run_with_a_link_where_there_is_a_page():
    table = matrix_table(matrix(RUNS), RUNS)
    assert [(str(cell), cell.href) for cell in table.head[3:5]] == [("a", "a/report.html"), ("b", "")]
    cells = table.rows[0][3:]
    assert cells == ("✓ 0.4 (+0.6)", "✗ 1.5 (-0.5)", "not judged", "–")
    assert [cell.href for cell in cells[:2]] == ["a/report.html", ""], (
        "the heads are not seen on a narrow screen"
    )
    assert [cell.kind for cell in cells[:3]] == ["good", "bad", "note"]


def test_the_lines_name_runs_figures_and_units():
    assert matrix_lines(matrix(RUNS), RUNS) == [
        "REQ-01: APE of whole attitude, at most 1 deg: met by 1 of 2, 1 not judged",
        "  met: 0.4 deg, margin 0.6 deg  (a)",
        "  FAILED: 1.5 deg, margin -0.5 deg  (b)",
        "  not judged  (short)",
        "duty, at most 20 %: met by 1 of 2",
        "  met: 12 %, margin 8 %  (a)",
        "  FAILED: 25 %, margin -5 %  (b)",
    ]


def test_the_document_has_what_each_run_says():
    ape, _ = matrix_json(matrix(RUNS), RUNS)
    assert (ape["id"], ape["unit"], ape["met"], ape["failed"], ape["not_judged"]) == (
        "REQ-01",
        "deg",
        1,
        1,
        1,
    )
    assert [one["run"] for one in ape["runs"]] == ["a", "b", "short"]
    assert ape["runs"][1] == {
        "run": "b", "verdict": "failed", "measured": 1.5, "limit": 1.0, "margin": -0.5,
    }  # fmt: skip


def test_what_never_settled_is_missed_without_a_value():
    settling = APE | {"index": "settling", "unit": "orbits"}
    runs = [JudgedRun("a", [judged(settling, None, "failed")])]
    assert matrix_table(matrix(runs), runs).rows[0][3] == "✗ no value"
    assert matrix_lines(matrix(runs), runs)[1] == "  FAILED  (a)"


# --- The page of requirements against runs: each run by a name of its own, with a link to its report

NAMED = {"id": "R-1", "index": "ape", "what": "attitude", "limit": 1.0, "unit": "deg", "by_orbit": 5.0}
MET, FAILED = NAMED | {"measured": 0.5, "verdict": "met"}, NAMED | {"measured": 2.0, "verdict": "failed"}


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
    unjudged = page_of(tmp_path, NAMED | {"measured": None, "verdict": "not judged"})
    assert "no run misses one" not in unjudged
    assert '<li class="note">! not judged</li>' in unjudged
