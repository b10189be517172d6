"""Requirements of the scenario over a campaign: shares of the runs judged, and each of a few runs."""

import numpy as np
import pytest

from sim.campaign.report.analysis import analyse
from sim.campaign.report.scenario_requirements import run_tables, share_json, share_lines, share_table
from sim.campaign.results.store import open_results


def test_a_share_is_of_the_runs_that_are_judged_and_a_failed_one_does_not_meet_it(analysis):
    settling, ape, _ = analysis.shares
    assert settling.met is None
    assert (settling.unjudged, settling.tightest) == (38, None)
    assert (ape.met.count, ape.met.total) == (19, 40), "20 + 1.5 run < 50, without run 7 that failed"
    assert ape.unjudged == 0


def test_the_least_margin_names_its_run(analysis):
    ape = analysis.shares[1]
    assert ape.runs[ape.tightest] == 39
    assert ape.margins[ape.tightest] == pytest.approx(50.0 - 78.5)


def test_the_table_has_shares_figures_and_margin(analysis):
    rows = share_table(analysis.shares).rows
    assert rows[0][:3] == ("settling of whole attitude", "at most 3 orbits", "not judged")
    assert rows[1][:4] == ("APE of whole attitude", "at most 50 deg", "19 of 40", "47.50 %")
    assert rows[1][-1] == "-28.5 deg, run 39"
    assert rows[2][-1] == "–", "AKE was not scored in these runs"


def test_the_lines_and_the_document_say_the_same(campaign_of_40, analysis):
    lines = share_lines(analysis.shares, campaign_of_40)
    assert lines[0] == "  scenario   settling of whole attitude, at most 3 orbits: not judged before orbit 4"
    assert lines[1].startswith(
        "  scenario   APE of whole attitude, at most 50 deg: met by 19 of 40, 47.5 % ("
    )
    assert lines[1].endswith("least margin -28.5 deg, run 39")
    settling, ape, _ = share_json(analysis.shares)
    assert (settling["met"], settling["least_margin_run"]) == (None, None)
    assert (ape["met"]["count"], ape["least_margin"], ape["least_margin_run"]) == (19, -28.5, 39)


def test_many_runs_have_no_columns(analysis, tmp_path):
    assert run_tables(analysis.shares, tmp_path) == []


def test_a_few_runs_have_a_column_each_and_link_to_what_is_kept(small, done_row, failed_row, tmp_path):
    with open_results(tmp_path, small) as results:
        for run in (0, 2, 5):
            results.add(done_row(run))
        results.add(failed_row(1))
        found = analyse(small, results)
    kept = tmp_path / "runs" / "2"
    kept.mkdir(parents=True)
    (kept / "report.html").write_text("")
    (table,) = run_tables(found.shares, tmp_path)
    assert [(str(name), name.href) for name in table.head[3:]] == [
        ("run 0", ""), ("run 2", "runs/2/report.html"), ("run 5", ""),
    ]  # fmt: skip
    assert table.rows[1][3] == "✓ 20 (+30)"
    assert table.rows[2][3:] == ("–",) * 3


def test_a_limit_that_was_drawn_is_that_of_each_run(small, done_row, tmp_path):
    with open_results(tmp_path, small) as results:
        for run in (0, 2):
            row = done_row(run)
            row.cells["requirements_1_limit"] = 30.0 + run
            results.add(row)
        ape = analyse(small, results).shares[1]
    assert np.array_equal(ape.margins, [10.0, 9.0])
    assert ape.limit == "at most 30 or 32 deg"
