"""The page: a row per claim, whose its tolerance is, what all starts give, and the text around the table."""

import pytest

from sim.campaign.claim import Claim, ClaimOutcome, ClaimVerdict, Spread, Threshold
from sim.campaign.runner import StudyResult
from sim.validate.outcomes import with_record
from sim.validate.page import as_json, line, loose, render, suites, tally

CLAIM = Claim("a.b", "Least | most", "Somebody 2001", "deg", low=1.0, high=2.0, threshold=Threshold.PAPER)
SPREAD = Spread(flights=12, meet=11, least=1.25, median=1.5, most=2.125)


class TestPage:
    def outcomes(self):
        return (
            CLAIM.judge(1.5, "row 7", SPREAD),
            Claim("a.c", "Too much", "Her", "1", high=1e-9, wide="rounding").judge(2e-9, "row 8"),
            Claim("a.e", "Fitted", "Him", "s", high=3.0, threshold=Threshold.FITTED).judge(2.0),
            ClaimOutcome(Claim("a.d", "Not there", "Nobody", ""), ClaimVerdict.ABSENT),
        )

    @pytest.fixture
    def finished(self, study):
        return [StudyResult(study("a", []), self.outcomes(), (), 1.0)]

    @pytest.fixture
    def page(self, finished):
        return render(self.outcomes(), finished, 61.4)

    def test_a_row_a_claim(self, page):
        rows = [row for row in page.splitlines() if row.startswith("| ") and "`a." in row]
        assert rows == [
            r"| Least \| most (`a.b`) | Somebody 2001 | 1.5 deg | 1.25 / 1.5 / 2.12; 11 of 12 | 1 to 2 deg "
            "| paper | PASS |",
            "| Too much (`a.c`) | Her | 2e-09 at row 8 |  | <= 1e-09 (rounding) "
            "| own, set afterwards | FAIL |",
            "| Fitted (`a.e`) | Him | 2 s |  | <= 3 s | fitted | fitted |",
            "| Not there (`a.d`) | Nobody |  |  |  | own, set afterwards | absent |",
        ]

    def test_what_stands_around_the_table(self, page):
        assert page.startswith("# Validation\n")
        assert "1 claim met, 1 failed (paper 1 of 1, own, set afterwards 0 of 1), 1 fitted, 1 absent." in page
        assert "Wall time of the last run 61 s. Python 3." in page
        assert "| claim | source | ours | all starts | tolerance | whose | verdict |" in page
        for threshold in Threshold:
            assert f"*{threshold.value}*:" in " ".join(page.split()), "each is explained"

    def test_the_terminal_names_the_worst_row_and_whose_the_limit_is(self):
        texts = [line(outcome) for outcome in self.outcomes()]
        assert texts[1] == "FAIL   a.c: Too much: 2e-09 (<= 1e-09, own, set afterwards)  [row 8]"
        assert texts[3] == "absent a.d"

    def test_a_program_is_told_the_same(self):
        paper, own, *_ = map(as_json, self.outcomes())
        assert (paper["threshold"], own["threshold"], own["wide"]) == (
            "paper",
            "own, set afterwards",
            "rounding",
        )
        assert paper["spread"] == {"flights": 12, "meet": 11, "least": 1.25, "median": 1.5, "most": 2.125}
        assert own["spread"] is None

    def test_what_is_fitted_is_no_test_that_passes(self, finished):
        cases = {case.name: case for case in suites(finished)["a"]}
        assert "fitted" in cases["a.e"].skipped
        assert not cases["a.e"].failure
        assert not cases["a.b"].skipped

    def test_what_too_few_flights_say_is_shown_as_no_verdict(self, study):
        claim = Claim("a.f", "Pointing, median", "Drawn", "deg", high=100.0)
        few = ClaimOutcome(claim, ClaimVerdict.TOO_FEW, 2.0, "3 of the 30 satellites that it is claimed for")
        assert line(few) == (
            "too few to judge a.f: Pointing, median: 2 deg (<= 100, own, set afterwards)  "
            "[3 of the 30 satellites that it is claimed for]"
        )
        assert tally([few]) == "0 claims met, 0 failed, 1 too few to judge"
        finished = [StudyResult(study("a", []), (few,), (), 1.0)]
        (case,) = suites(finished)["a"]
        assert (case.failure, case.skipped) == ("", line(few))
        assert "| 2 deg of 3 of the 30 satellites that it is claimed for |" in render([few], finished, 1.0)
        assert as_json(few)["verdict"] == "too few to judge"
        assert loose([few]) == []
        assert with_record({}, finished, {"a"}) == {}

    def test_a_limit_of_one_s_own_far_from_the_figure_is_named_unless_it_says_why(self):
        outcomes = [
            Claim("a.near", "", "", "1", high=1e-2).judge(2e-3),
            Claim("a.far", "", "", "1", high=1e-2).judge(9e-4),
            Claim("a.reason", "", "", "1", high=1e-2, wide="rounding").judge(9e-4),
            Claim("a.paper", "", "", "1", high=1e-2, threshold=Threshold.PAPER).judge(9e-4),
            Claim("a.prototype", "", "", "1", high=1e-2, threshold=Threshold.PROTOTYPE).judge(9e-4),
        ]
        assert loose(outcomes) == ["a.far", "a.prototype"]
        page = render(outcomes, [], 1.0)
        assert "off, without a reason: a.far, a.prototype." in page

    def test_of_a_part_of_a_whole_what_it_lacks_counts(self):
        outcomes = [
            Claim("a.near", "", "", "1", low=0.95).judge(0.994),
            Claim("a.far", "", "", "1", low=0.95).judge(0.9999),
            Claim("a.whole", "", "", "1", low=0.95).judge(1.0),
            Claim("a.reason", "", "", "1", low=0.95, wide="honest").judge(1.0),
            Claim("a.ratio", "", "", "1", low=0.95).judge(1.2),
            Claim("a.angle", "", "", "deg", low=0.95).judge(1.0),
            Claim("a.all", "", "", "1", low=1.0).judge(1.0),
        ]
        assert loose(outcomes) == ["a.far", "a.whole"]

    def test_the_tally_counts_only_what_shows_something(self):
        fitted = Claim("a.e", "Fitted", "Him", "s", high=3.0, threshold=Threshold.FITTED)
        assert tally([fitted.judge(2.0)]) == "0 claims met, 0 failed, 1 fitted"
        assert tally([fitted.judge(4.0)]) == "0 claims met, 1 failed (fitted 0 of 1)", (
            "what was fitted must stay met"
        )
