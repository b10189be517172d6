"""Every flight says what may limit its pointing; only one that has not settled, what does."""

import pytest

from sim.campaign.flight import record_scenario
from sim.report.requirements.diagnosis import FINDINGS, diagnose
from sim.report.requirements.evidence import FlightEvidence
from sim.report.summary import summary_text
from sim.scenario.controlled import controlled
from sim.scenario.schema import load, parse_settings


def diagnosed(*settings, settled=None, **evidence):
    scenario = load("microsat", parse_settings(settings))
    return diagnose(controlled(scenario), settled, FlightEvidence(scenario, **({"orbits": 5.0} | evidence)))


def test_of_a_flight_that_has_settled_there_are_findings_and_no_reason():
    found = diagnosed(settled=1.2, estimate_deg=0.1, within_3sigma=0.99, levels=(10, 20, 25))
    assert list(found["findings"]) == list(FINDINGS)
    assert found["reasons"] == []
    assert found["findings"]["axes and gravity"] == "gravity holds the body"
    assert found["findings"]["time"] == "5.00 orbits flown, under 5 deg from 1.20 orbits on"
    assert "45 % of them at the highest level" in found["findings"]["coils"]


@pytest.mark.parametrize(("last", "is_settled"), [((4.0, 4.5), True), ((28.0, 3.0), False)])
def test_an_error_that_only_swings_by_at_the_end_has_not_settled(last, is_settled):
    """Under 5 deg for the last ten minutes of an orbit of 20 deg RMS."""
    found = diagnosed(settled=4.9, trend=(30.0, 25.0, 28.0, 26.0, *last))
    assert (found["reasons"] == []) is is_settled
    assert ("not settled under 5 deg" in found["findings"]["time"]) is not is_settled


@pytest.mark.parametrize(
    ("settings", "evidence", "finding", "words"),
    [
        (("knowledge=perfect",), {}, "estimate", "none: the attitude is known"),
        ((), {"first_valid": None}, "estimate", "never valid"),
        ((), {"estimate_deg": None}, "estimate", "not valid in the last orbit"),
        ((), {}, "coils", "no pulse in the last orbit"),
        (
            ("coils.driver=continuous", "coils.max_dipole_am2=0.5"),
            {"saturated_part": 0.25},
            "coils",
            "at their largest dipole for 25 % of the last orbit",
        ),
        (("body.inertia_kgm2=[1.95,1.85,1.02]",), {}, "axes and gravity", "turns the body over"),
    ],
)
def test_what_may_limit_the_pointing_is_said_of_what_was_flown(settings, evidence, finding, words):
    assert words in diagnosed(*settings, **evidence)["findings"][finding]


@pytest.mark.long
def test_a_flight_without_requirements_says_why_it_has_not_settled():
    scenario = load("microsat", parse_settings(("requirement=[]", "knowledge=perfect")))
    summary = record_scenario(scenario, 1, 0.3).summary()
    (reason,) = summary["diagnosis"]["reasons"]
    assert reason["cause"] == "short"
    assert "why        too early to say: a flight of 0.30 orbits is" in summary_text(summary)
