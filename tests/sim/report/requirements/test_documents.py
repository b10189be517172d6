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


STATED = {
    "index": "ape",
    "what": "attitude",
    "limit": 2.0,
    "unit": "deg",
    "window": "the last orbit",
    "by_orbit": 5.0,
    "measured": 132.25,
    "verdict": "failed",
    "text": "ape 132 deg",
    "reasons": [REASON, {"code": "dark", "text": "it is dark"}],
}


def test_the_evidence_stands_beside_the_verdict():
    (case,) = suites({"requirements": [STATED]})["requirements"]
    assert dict(case.properties) == {
        "measured": "132.25",
        "limit": "2.0",
        "unit": "deg",
        "window": "the last orbit",
        "by_orbit": "5.0",
        "verdict": "failed",
        "reasons": "the coils are too weak; it is dark",
    }


def test_what_there_is_not_is_no_evidence():
    unjudged = STATED | {"measured": None, "verdict": "not judged", "reasons": []}
    (case,) = suites({"requirements": [unjudged]})["requirements"]
    assert "measured" not in dict(case.properties)
    assert "reasons" not in dict(case.properties)


def test_a_test_is_called_by_the_name_of_its_requirement():
    duty = STATED | {"index": "duty", "what": None, "id": "REQ-02"}
    cases = suites({"requirements": [STATED | {"id": "REQ-01"}, duty, STATED | {"id": None}, STATED]})
    names = [case.name for case in cases["requirements"]]
    assert names == ["REQ-01: APE of whole attitude", "REQ-02: duty", "requirement 3", "requirement 4"]


def test_the_time_of_a_requirement_is_that_of_the_flight():
    (flown,) = suites({"wall_seconds": 17.5, "requirements": [STATED]})["requirements"]
    (unknown,) = suites({"requirements": [STATED]})["requirements"]
    assert (flown.wall_s, unknown.wall_s) == (17.5, 0.0)


def test_what_failed_stands_at_its_verdict():
    cases = suites({"failures": {"replay": "the replay is not exact"}})["flight"]
    assert [case.failure for case in cases] == ["", "the replay is not exact", "", ""]
