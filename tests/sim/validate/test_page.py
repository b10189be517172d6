"""The page: a row per claim, and the text around the table."""

import pytest

from sim.campaign.claim import Claim, ClaimOutcome, ClaimVerdict
from sim.campaign.runner import StudyResult
from sim.validate.page import line, render

CLAIM = Claim("a.b", "Least | most", "Somebody 2001", "deg", low=1.0, high=2.0)


class TestPage:
    def outcomes(self):
        return (
            CLAIM.judge(1.5, "row 7"),
            Claim("a.c", "Too much", "Her", "1", high=1e-9).judge(2e-9, "row 8"),
            ClaimOutcome(Claim("a.d", "Not there", "Nobody", ""), ClaimVerdict.ABSENT),
        )

    @pytest.fixture
    def page(self, study):
        return render([StudyResult(study("a", []), self.outcomes(), (), 1.0)], 61.4)

    def test_a_row_a_claim(self, page):
        rows = [row for row in page.splitlines() if row.startswith("| ") and "`a." in row]
        assert rows == [
            r"| Least \| most (`a.b`) | Somebody 2001 | 1.5 deg | 1 to 2 deg | PASS |",
            "| Too much (`a.c`) | Her | 2e-09 at row 8 | <= 1e-09 | FAIL |",
            "| Not there (`a.d`) | Nobody |  |  | absent |",
        ]

    def test_what_stands_around_the_table(self, page):
        assert page.startswith("# Validation\n")
        assert "1 claims hold, 1 fail, 1 absent." in page
        assert "Wall time 61 s. Python 3." in page
        assert "| claim | source | ours | tolerance | verdict |" in page

    def test_the_terminal_names_the_worst_row(self):
        texts = [line(outcome) for outcome in self.outcomes()]
        assert texts[1] == "FAIL   a.c: Too much: 2e-09 (<= 1e-09)  [row 8]"
        assert texts[2] == "absent a.d"
