"""validation.json: what was measured is kept until it is measured again."""

import pytest

from sim.campaign.claim import Claim, ClaimOutcome, ClaimVerdict
from sim.errors import HarnessError
from sim.validate.outcomes import as_outcomes, as_text, read_outcomes, with_outcomes

CLAIM = Claim("a.b", "Least", "Somebody", "deg", high=2.0)
ROW = {"figure": "1.5 deg", "limits": "<= 2", "verdict": "PASS"}


def test_a_claim_that_was_judged_has_figure_limits_and_verdict():
    outcomes = [CLAIM.judge(1.5), ClaimOutcome(Claim("a.c", "No data", "Nobody", ""), ClaimVerdict.ABSENT)]
    assert as_outcomes(outcomes) == {"a.b": ROW}
    assert as_outcomes([CLAIM.judge(3.0)])["a.b"]["verdict"] == "FAIL"


def test_the_new_figure_stands_for_the_old_one_and_the_others_stay():
    worse = {**ROW, "figure": "1.9 deg"}
    assert with_outcomes({"b": ROW, "a": ROW}, {"a": worse, "0": ROW}) == {"0": ROW, "a": worse, "b": ROW}
    assert list(with_outcomes({"b": ROW}, {"a": ROW})) == ["a", "b"]


def test_the_file_holds_a_claim_a_line_and_is_read_back(tmp_path):
    path = tmp_path / "validation.json"
    path.write_text(as_text({"a": ROW, "b": ROW}))
    assert read_outcomes(path) == {"a": ROW, "b": ROW}
    assert len(path.read_text().splitlines()) == 4
    path.write_text(as_text({}))
    assert read_outcomes(path) == {}
    assert read_outcomes(tmp_path / "none.json") == {}


@pytest.mark.parametrize("text", ["[]", "{", '{"a": 1}', '{"a": {"figure": "1"}}', "\xff"])
def test_another_file_is_refused_by_its_name(tmp_path, text):
    path = tmp_path / "validation.json"
    path.write_text(text, encoding="latin-1")
    with pytest.raises(HarnessError, match=r"validation\.json: no outcomes of torquer validate"):
        read_outcomes(path)
