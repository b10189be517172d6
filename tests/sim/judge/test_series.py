"""Many flights: what is told of all of them, and whose files stay."""

import json
from pathlib import Path

import pytest

from sim.campaign.definition.campaign_file import load_campaign
from sim.errors import HarnessError
from sim.fault_table.rows.table import choose_rows
from sim.judge.command import judge_campaign, judge_faults
from sim.judge.population import population_cases, population_verdicts
from sim.judge.series import JudgedCase, KeptFiles, SeriesCase
from sim.judge.series_render import case_line, series_json, series_page, series_suites, tally_line
from sim.report.requirements.judge import Outcome
from sim.scenario.schema import load

TUMBLERS = str(Path(__file__).with_name("tumblers.toml"))
TUMBLER = str(Path(__file__).with_name("tumbler.toml"))
CAMPAIGN = load_campaign(TUMBLERS, {}, {})
RATE = {"id": "RATE", "index": "rate", "what": None, "text": "", "reasons": []}


def case(name, outcome=Outcome.MET, requirement="met", refused=0, **rules):
    summary = {"isolated": [], "requirements": [], "pulses": {"refused": refused}}
    found = {"answers": Outcome.MET} | rules
    return JudgedCase(
        SeriesCase(name, None), outcome, f"of {name}", found, [RATE | {"verdict": requirement}], summary
    )


def verdicts(*flown):
    return {one.name: (one.met, one.found) for one in population_verdicts(CAMPAIGN, flown)}


def test_runs_are_those_of_the_campaign():
    cases = list(population_cases(CAMPAIGN))
    assert [one.name for one in cases] == ["0", "1", "2", "3"]
    assert len({one.seed for one in cases}) == 4
    assert len({one.scenario.initial.rate_degps for one in cases}) == 4


def test_no_run_may_break_a_rule():
    assert verdicts(*map(case, "abc"))["answers"] == (True, "in 3 runs")
    broken = verdicts(case("a"), case("b", answers=Outcome.FAILED))
    assert broken["answers"] == (False, "broken in 1 of 2 runs")


def test_what_no_run_was_judged_by_has_no_verdict():
    unjudged = case("a", requirement="not judged", answers=Outcome.NOT_JUDGED)
    assert set(verdicts(unjudged)) == {"pulses_refused <= 0"}


def test_a_requirement_is_met_by_the_part_of_the_campaign():
    many = [case(f"{run}") for run in range(100)]
    assert verdicts(*many)["RATE"][0] is True
    assert verdicts(*many[:4])["RATE"][0] is None  # more runs must tell
    assert verdicts(*many[:4], case("x", requirement="failed"))["RATE"][0] is False


def test_requirements_of_the_campaign_are_judged_by_the_summary():
    assert verdicts(case("a"), case("b", refused=2))["pulses_refused <= 0"][0] is False


def test_text_page_json_and_junit_tell_the_same():
    flown = [
        case("sound"),
        case("torn", Outcome.FAILED),
        JudgedCase(SeriesCase("bit-flip", None, about="bit flip"), Outcome.NOT_JUDGED, "no memory", {}),
    ]
    assert tally_line(flown) == "1 kept, 1 broken, 1 not applicable"
    assert case_line(flown[2]).split() == ["not", "applicable", "bit-flip", "no", "memory", "(bit", "flip)"]
    values = series_json(flown)
    assert values["tally"] == {"kept": 1, "broken": 1, "not applicable": 1}
    (suite,) = series_suites(flown).values()
    assert [(one.failure, one.skipped) for one in suite] == [("", ""), ("of torn", ""), ("", "no memory")]
    page = series_page("tumblers", "./firmware", flown)
    assert "✗ 1 of 3 broken" in page
    assert "no memory" in page


@pytest.mark.long
@pytest.mark.slow
def test_files_of_what_is_broken_stay_and_others_go(firmware, tmp_path):
    rows = choose_rows(("mag-frozen-passing", "bit-flip"))
    out, told = tmp_path / "sound", []
    assert judge_faults(firmware(), load(TUMBLER), rows, 1, 1, out, KeptFiles.FAILURES, told.append).ok
    assert [one.name for one in told] == ["mag-frozen-passing", "bit-flip"]
    assert sorted(path.name for path in out.iterdir()) == ["judge.html", "judge.json"]
    assert json.loads((out / "judge.json").read_text())["tally"] == {
        "kept": 1,
        "broken": 0,
        "not applicable": 1,
    }
    torn = tmp_path / "torn"
    broken = judge_faults(firmware("long"), load(TUMBLER), rows[:1], 1, 1, torn, KeptFiles.FAILURES, print)
    assert broken.failures[0].startswith("mag-frozen-passing: asks within limits")
    assert (torn / "mag-frozen-passing" / "judge.html").is_file()
    with pytest.raises(HarnessError, match="already holds a judgement"):
        judge_faults(firmware(), load(TUMBLER), rows[:1], 1, 1, out, KeptFiles.FAILURES, print)


@pytest.mark.long
@pytest.mark.slow
def test_a_campaign_is_flown_run_by_run(firmware, tmp_path):
    short = load_campaign(TUMBLERS, {"orbits": 0.05, "runs": 2}, {})
    assert judge_campaign(firmware(), short, tmp_path / "all", KeptFiles.ALL, print).ok
    assert sorted(path.name for path in (tmp_path / "all").iterdir()) == [
        "0",
        "1",
        "judge.html",
        "judge.json",
    ]
    assert not judge_campaign(firmware("order"), short, tmp_path / "torn", KeptFiles.FAILURES, print).ok
