"""What is drawn is listed by the section of the scenario, each number with its distribution."""

from dataclasses import replace

from sim.campaign.report.drawn import drawn_tables


def test_each_section_has_its_list(campaign_of_40, analysis):
    tables = {table.caption: table for table in drawn_tables(campaign_of_40, analysis)}
    assert list(tables) == sorted(tables)
    assert {"body", "coils", "disturbance", "initial", "magnetometer", "onboard table estimator", "sun"} == {
        *tables
    }
    assert [row[:2] for row in tables["body"].rows] == [
        (f"body inertia, component {number} [kg m²]", "normal, times the scenario's") for number in (1, 2, 3)
    ]
    assert len(tables["disturbance"].rows) == 4, "three components and the length"
    assert tables["sun"].rows[0][1] == "correlated"


def test_a_text_has_its_choice_and_no_numbers(campaign_of_40, analysis):
    (row,) = next(one for one in drawn_tables(campaign_of_40, analysis) if one.caption == "coils").rows
    assert row == ("coils backoff", "choice of 2", "–", "–", "–")


def test_numbers_are_those_of_the_runs_that_were_flown(campaign_of_40, analysis):
    (row,) = next(one for one in drawn_tables(campaign_of_40, analysis) if one.caption == "initial").rows
    assert row == ("initial angle [deg]", "uniform", "0", "19.5", "39")


def test_nothing_drawn_is_no_list(campaign_of_40, analysis):
    assert drawn_tables(campaign_of_40, replace(analysis, input_words={})) == []
