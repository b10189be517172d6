"""A campaign is judged once: terminal, page, JSON, JUnit and exit code say the same."""

import json
from dataclasses import replace

import pytest

from sim.campaign.command import FlownCampaign
from sim.campaign.definition.campaign import IndexLimits
from sim.campaign.definition.requirements import FigureRequirement
from sim.campaign.report import text
from sim.campaign.report.analysis import analyse
from sim.campaign.report.documents import as_json, suites
from sim.campaign.report.page import write_page
from sim.campaign.report.verdicts import meets, verdicts
from sim.campaign.results.store import open_results
from sim.junit import junit_xml
from sim.statistics.proportion import clopper_pearson

MISSED = (
    "missed: pointing error, RMS over the last orbit, at most 60 deg: "
    "25 of 40, 62.5 % (48.3 to 75.3 % with 90 % confidence), to be 95 %"
)


@pytest.mark.parametrize(
    ("count", "total", "met"), [(94, 100, False), (95, 100, None), (100, 100, True), (40, 40, None)]
)
def test_a_requirement_is_met_by_its_lower_bound_and_missed_by_the_part_itself(small, count, total, met):
    assert meets(clopper_pearson(count, total, 0.9), small) is met


def flown(campaign, analysis, tmp_path):
    quiet = replace(analysis, failures={})
    return FlownCampaign(tmp_path, campaign, quiet, (), ())


@pytest.mark.long
def test_a_missed_requirement_is_said_everywhere(campaign_of_40, analysis, tmp_path):
    done = flown(replace(campaign_of_40, index=IndexLimits()), analysis, tmp_path)
    assert done.complaints == [MISSED]
    assert not done.ok
    assert f"  required   {MISSED}" in text.lines(done.campaign, done.analysis)
    assert text.requirement_table(done.campaign, done.analysis).rows[0][-1] == "missed"
    assert json.loads(json.dumps(as_json(done.campaign, done.analysis)))["missed"] == [MISSED]
    xml = junit_xml("x", suites(done.verdicts, done.analysis, done.broken))
    assert xml.count("<failure") == 1
    write_page(tmp_path / "page.html", done.campaign, done.analysis, "0")
    assert "1 of its limits missed" in (tmp_path / "page.html").read_text()


def test_a_limit_on_an_index_counts_like_a_requirement(campaign_of_40, analysis, tmp_path):
    easy = {FigureRequirement("pointing_deg_rms_last_orbit", at_most=1e3): clopper_pearson(4000, 4000, 0.9)}
    done = flown(campaign_of_40, replace(analysis, by_requirement=easy), tmp_path)
    assert [one.met for one in done.verdicts if one.group == "requirement"] == [True]
    missed = [one for one in done.verdicts if one.met is False]
    assert missed
    assert {one.group for one in missed} == {"index"}
    assert done.complaints == [str(one) for one in missed]
    xml = junit_xml("x", suites(done.verdicts, done.analysis, done.broken))
    assert xml.count("<failure") == len(missed)


def test_what_more_runs_must_tell_is_no_failure(campaign_of_40, analysis, tmp_path):
    nearly = {FigureRequirement("pointing_deg_rms_last_orbit", at_most=1e3): clopper_pearson(40, 40, 0.9)}
    unlimited = replace(campaign_of_40, index=IndexLimits())
    done = flown(unlimited, replace(analysis, by_requirement=nearly), tmp_path)
    assert [one.met for one in verdicts(unlimited, done.analysis)] == [None]
    assert done.ok
    xml = junit_xml("x", suites(done.verdicts, done.analysis, done.broken))
    assert ("<failure" in xml, xml.count("<skipped")) == (False, 1)
    assert any("more runs must tell: " in line for line in text.lines(unlimited, done.analysis))


def test_where_no_run_was_flown_no_limit_is_met_and_the_coils_are_not_judged(small, tmp_path, failed_row):
    with open_results(tmp_path, small) as results:
        for run in range(3):
            results.add(failed_row(run))
        found = analyse(small, results)
    done = FlownCampaign(tmp_path, small, found, (0, 1, 2), ())
    limits = [one for one in done.verdicts if one.group == "index"]
    assert len(limits) == 9, "three limits under three interpretations"
    assert {(one.met, one.found) for one in limits} == {(False, "it falls on runs that failed")}
    tests = {case.name: case for case in suites(done.verdicts, found, ())["runs"]}
    coils = tests["every run kept the limits of the coils"]
    assert (coils.failure, coils.skipped) == ("", "no run was flown")
    assert any("no value" in line for line in text.lines(small, found))
    json.dumps(as_json(small, found), allow_nan=False)


@pytest.mark.long
def test_a_figure_that_few_runs_have_is_drawn_and_told(small, tmp_path, done_row):
    with open_results(tmp_path, small) as results:
        for run in range(20):
            row = done_row(run)
            known = {"converged_at_s": 100.0 + run} if run < 8 else {}
            results.add(replace(row, cells=row.cells | known))
        found = analyse(small, results)
    percentiles = json.loads(json.dumps(as_json(small, found), allow_nan=False))["figures"]["converged_at_s"]
    assert (percentiles["without"], percentiles["percentiles"]["0.95"]["value"]) == (12, None)
    assert any("estimate converged after [s]: 50 % no value" in line for line in text.lines(small, found))
    write_page(tmp_path / "page.html", small, found, "0")
    assert "12 of 20 runs have none" in (tmp_path / "page.html").read_text()
