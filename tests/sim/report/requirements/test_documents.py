"""The verdicts of a flight as JUnit tests: each requirement with its reasons."""

import pytest

from sim.report.requirements.documents import suites

REASON = {"code": "weak", "text": "the coils are too weak"}


@pytest.mark.parametrize(
    ("verdict", "failure", "skipped"),
    [
        ("met", "", ""),
        ("failed", "ape 132 deg; the coils are too weak", ""),
        ("not judged", "", "ape 132 deg; the coils are too weak"),
    ],
)
def test_a_requirement_is_a_test_with_its_reasons(verdict, failure, skipped):
    summary = {"requirements": [{"verdict": verdict, "text": "ape 132 deg", "reasons": [REASON]}]}
    (case,) = suites(summary)["requirements"]
    assert (case.failure, case.skipped) == (failure, skipped)


def test_what_failed_stands_at_its_verdict():
    cases = suites({"failures": {"replay": "the replay is not exact"}})["flight"]
    assert [case.failure for case in cases] == ["", "the replay is not exact", "", ""]
