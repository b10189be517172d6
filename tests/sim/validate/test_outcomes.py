"""validation.json: what was computed is kept until it is computed again."""

import json
from math import inf, nan

import pytest

from sim.campaign.claim import Claim, ClaimOutcome, ClaimVerdict, Spread, Threshold
from sim.campaign.runner import StudyResult
from sim.errors import HarnessError
from sim.validate.outcomes import as_figures, as_text, read_record, with_record

CLAIM = Claim("a.b", "Least", "Somebody", "deg", high=2.0, threshold=Threshold.PAPER, wide="for this reason")
SPREAD = Spread(flights=12, meet=11, least=1.25, median=1.5, most=inf)
ROW = CLAIM.judge(1.5, "flight 7", SPREAD)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "validation.json"


def test_a_claim_that_was_judged_is_recorded_and_one_without_data_is_not(study):
    absent = ClaimOutcome(Claim("a.c", "No data", "Nobody", ""), ClaimVerdict.ABSENT)
    flown = StudyResult(study("a", [], has_flights=True), (CLAIM.judge(1.5), absent), (), 1.0)
    assert with_record({}, [flown], {"a"}) == {"a.b": CLAIM.judge(1.5)}


def test_the_new_outcome_stands_for_the_old_one_and_those_of_other_studies_stay(study):
    now = StudyResult(
        study("a", []), (Claim("a.b", "", "", "1").judge(1.9), Claim("a.0", "", "", "1").judge(1.0)), (), 1.0
    )
    found = with_record({"b.x": ROW, "a.b": ROW}, [now], {"a", "b"})
    assert list(found) == ["a.0", "a.b", "b.x"]
    assert found["b.x"] == ROW
    assert found["a.b"].ours == 1.9


def test_a_claim_that_its_study_no_longer_makes_does_not_stay(study):
    now = StudyResult(study("a", []), (Claim("a.b", "", "", "1").judge(1.0),), (), 1.0)
    before = {name: ROW for name in ("a.b", "a.gone", "a.part.c", "ab.c", "of_no_study.d")}
    assert list(with_record(before, [now], {"a", "a.part", "ab"})) == [
        "a.b",
        "a.part.c",
        "ab.c",
        "of_no_study.d",
    ]
    part = StudyResult(study("a.part", []), (), (), 1.0)
    assert "a.part.c" not in with_record(before, [part], {"a", "a.part", "ab"})


def test_a_claim_whose_data_are_not_there_keeps_its_outcome(study):
    absent = ClaimOutcome(Claim("a.b", "", "", "1"), ClaimVerdict.ABSENT)
    now = StudyResult(study("a", []), (absent,), (), 1.0)
    assert with_record({"a.b": ROW, "a.gone": ROW}, [now], {"a"}) == {"a.b": ROW}


def test_the_file_holds_a_claim_a_line_and_is_read_back(path, tmp_path):
    path.write_text(as_text({"a.b": ROW, "a.c": ROW}))
    found = read_record(path)
    assert found["a.b"] == ROW
    assert found["a.c"].claim.id == "a.c"
    assert len(path.read_text().splitlines()) == 4
    path.write_text(as_text({}))
    assert read_record(path) == {}
    assert read_record(tmp_path / "none.json") == {}


def test_what_is_no_number_of_json_is_read_back_too(path):
    path.write_text(as_text({"a.b": CLAIM.judge(nan), "a.c": CLAIM.judge(inf)}))
    json.loads(path.read_text(), parse_constant=pytest.fail)
    found = read_record(path)
    assert str(found["a.b"].ours) == "nan"
    assert found["a.b"].verdict is ClaimVerdict.FAIL
    assert found["a.c"].ours == inf


def test_figures_are_kept_to_six_digits(path):
    path.write_text(as_text({"a.b": CLAIM.judge(1.23456789e-7)}))
    assert read_record(path)["a.b"].ours == 1.23457e-7


def test_what_is_fitted_is_not_met_however_it_was_written(path):
    fitted = Claim("a.b", "Tilt", "Somebody", "deg", high=2.0, threshold=Threshold.FITTED)
    rows = {
        "a.b": ClaimOutcome(fitted, ClaimVerdict.PASS, 1.5),
        "a.c": fitted.judge(3.0),
    }
    path.write_text(as_text(rows))
    assert [one.verdict for one in read_record(path).values()] == [
        ClaimVerdict.FITTED,
        ClaimVerdict.FAIL,
    ]


def test_a_figure_is_told_with_limits_and_verdict():
    assert as_figures({"a.b": ROW}) == {"a.b": {"figure": "1.5 deg", "limits": "<= 2", "verdict": "PASS"}}


@pytest.mark.parametrize(
    "text",
    ["[]", "{", '{"a": 1}', '{"a": {"ours": 1.0}}', "\xff", as_text({"a": ROW}).replace("ours", "our")],
)
def test_another_file_is_refused_by_its_name(path, text):
    path.write_text(text, encoding="latin-1")
    with pytest.raises(HarnessError, match=r"validation\.json: no outcomes of torquer validate"):
        read_record(path)
