"""The words about a campaign: a few lines, and tables of the page."""

from dataclasses import replace

import numpy as np

from sim.campaign.definition.campaign import StatisticsSection
from sim.campaign.report import text
from sim.campaign.report.analysis import analyse
from sim.campaign.report.documents import as_json
from sim.campaign.results.store import open_results


def test_lines_say_what_matters(campaign_of_40, analysis):
    lines = text.lines(campaign_of_40, analysis)
    assert lines[0] == "microsat: 40 runs of 0.02 orbits"
    assert lines[1] == "  success    25 of 40, 62.5 % (48.3 to 75.3 % with 90 % confidence)"
    assert lines[2].startswith(
        "  required   missed: pointing error, RMS over the last orbit, at most 60 deg: 25 of 40, "
    )
    assert lines[3] == "  scenario   settling of whole attitude, at most 3 orbits: not judged before orbit 4"
    assert lines[6].startswith(
        "  pointing error, RMS over the last orbit [deg]: 50 % 51.5 (42.5 to 60.5), 95 % 78.5 (75.5 to –)"
    )
    assert "depends on initial angle +0.97" in "\n".join(lines)
    assert "  worst runs 39 (78.5), 38 (77), 37 (75.5), 36 (74), 35 (72.5)" in lines
    assert lines[-1] == "  failed     2, first run 7: run 7: <too> fast"


def test_lines_say_why_runs_have_not_settled(campaign_of_40, unsettled):
    lines = [line for line in text.lines(campaign_of_40, unsettled) if "unsettled" in line]
    assert lines == [
        "  unsettled  5 of 12, as run 7: estimate, mismatch <of> 7",
        "  unsettled  1 of 12, as run 3: weak <of> 3",
    ]
    found = as_json(campaign_of_40, unsettled)["unsettled"]
    assert found[1] == {"causes": ["weak"], "runs": [3], "why": "weak <of> 3"}


def test_where_nothing_is_required_the_runs_keep_limits_and_are_no_success(small, done_row, tmp_path):
    campaign = replace(small, requirements=())
    with open_results(tmp_path, campaign) as results:
        results.add(done_row(3))
        found = analyse(campaign, results)
    lines = text.lines(campaign, found)
    assert lines[1].startswith("  limits     kept by 1 of 1, ")
    assert "success" not in "\n".join(lines)
    assert text.requirement_table(campaign, found).rows[-1][0] == "the limits of the coils"


def test_indices_are_judged_by_their_bounds(campaign_of_40, analysis):
    rows = {row[0][:3]: row for row in text.index_table(campaign_of_40, analysis).rows}
    assert [rows[name][1] for name in ("APE", "MPE", "RPE", "AKE")] == ["150", "170", "100", "–"]
    temporal, ensemble, mixed = rows["RPE"][2:]
    assert temporal == "153: missed"
    assert ensemble.startswith("156.8 ")
    assert ensemble.endswith("(bound –): missed")
    assert mixed.endswith("missed")
    assert rows["MPE"][2].endswith(": more runs must tell"), "a run that failed may be the worst"
    assert rows["MPE"][3].endswith("(bound –): more runs must tell")
    assert ":" not in rows["AKE"][4]
    lines = [line for line in text.lines(campaign_of_40, analysis) if "<= 150 deg" in line]
    assert len(lines) == 1
    assert lines[0].startswith("  APE <= 150 deg: temporal ")


def test_the_table_of_requirements_ends_with_all_of_them(campaign_of_40, analysis):
    rows = text.requirement_table(campaign_of_40, analysis).rows
    assert rows[0][:2] == ("pointing error, RMS over the last orbit, at most 60 deg", "25 of 40")
    assert rows[-1][0] == "all, and the limits of the coils"


def test_a_bound_that_takes_more_runs_is_a_dash(campaign_of_40, analysis):
    percentile = text.figure_table(analysis).rows[0][-2]
    assert percentile.endswith("to –)")
    assert "those of ensemble and mixed need 45 runs" in text.index_note(campaign_of_40, analysis)


def test_worst_runs_come_with_their_inputs(analysis):
    table = text.worst_table(analysis)
    assert table.head[:2] == ("run", "pointing error, RMS over the last orbit [deg]")
    assert table.rows[0][:3] == ("39", "78.5", "157")
    assert table.rows[0][table.head.index("initial angle [deg]")] == "39"


def test_runs_of_different_lengths_are_not_given_the_scenarios(campaign_of_40, analysis):
    orbits = np.linspace(0.0102, 0.0299, analysis.done)
    assert text.length(campaign_of_40, replace(analysis, orbits=orbits)) == "0.0102 to 0.0299 orbits"
    assert text.length(campaign_of_40, replace(analysis, orbits=np.array([0.03]))) == "0.03 orbits"
    rounded = np.array([0.02001, 0.01999])  # to whole ticks
    assert text.length(campaign_of_40, replace(analysis, orbits=rounded)) == "0.02 orbits"


def test_percentiles_that_round_to_the_same_have_columns_of_their_own(campaign_of_40, done_row, tmp_path):
    nearly = replace(campaign_of_40, statistics=StatisticsSection(probability=0.0500004))
    with open_results(tmp_path, nearly) as results:
        for run in range(30):
            results.add(done_row(run))
        found = analyse(nearly, results)
    head = text.figure_table(found).head
    assert head[3:6] == ("5 %", "5.00004 %", "50 %")
    shown = next(
        line for line in text.lines(nearly, found) if "pointing error, RMS" in line and "50 %" in line
    )
    assert "5.00004 % " in shown, "the percentile of the campaign, wherever it lies"
    assert ": 5 % " not in shown
    assert list(as_json(nearly, found)["figures"]["pointing_deg_rms_last_orbit"]["percentiles"]) == [
        "0.05", "0.0500004", "0.5",
    ]  # fmt: skip
