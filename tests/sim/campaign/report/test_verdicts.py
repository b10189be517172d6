"""A campaign is judged once: terminal, page, JSON, JUnit and exit code say the same."""

import json
from dataclasses import replace

import pytest

from sim.campaign.command import FlownCampaign
from sim.campaign.definition.campaign import IndexLimits
from sim.campaign.definition.requirements import FigureRequirement
from sim.campaign.report import text
from sim.campaign.report.documents import suites
from sim.campaign.report.page import write_page
from sim.campaign.report.values import as_json
from sim.campaign.report.verdicts import meets, verdicts
from sim.junit import junit_xml
from sim.statistics.proportion import clopper_pearson

MISSED = (
    "missed: pointing_deg_rms_last_orbit <= 60: "
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
