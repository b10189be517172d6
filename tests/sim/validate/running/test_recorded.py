"""Recorded outcomes in the place of flights: only those that this code would fly and judge the same."""

from dataclasses import replace

import pytest

from sim.campaign.claim import Claim, ClaimVerdict
from sim.campaign.code_digest import code_digest
from sim.campaign.flight import Order
from sim.campaign.study import Figure, Group, campaign
from sim.validate.outcomes import Recorded, mark, read_record
from sim.validate.registry import all_studies, judging_digests
from sim.validate.running.recorded import recorded_studies

FIGURES = tuple(
    Figure(name, "Pointing", "deg", lambda flight: 1.0, high=high)
    for name, high in (("rms", 2.0), ("ape", 5.0))
)
JUDGES = {"a": "by this", "a.part": "by this", "b": "by this"}


def flown(figures=FIGURES, study_id="a"):
    return campaign(study_id, "Somebody", [Group("", (Order("microsat"),))], figures)


def rows(study_id="a", figures=(1.5, 3.25)):
    """What this code recorded of the study."""
    claims = [
        Claim(f"{study_id}.{figure.id}", "Pointing", "Somebody", "deg", high=figure.high)
        for figure in FIGURES
    ]
    judge = mark(JUDGES, study_id, [claim.id for claim in claims])
    return {
        claim.id: Recorded(claim.judge(ours, "flight 7"), code_digest(), judge)
        for claim, ours in zip(claims, figures, strict=True)
    }


def outcomes(study):
    return {one.claim.id: (one.ours, one.where, one.verdict) for one in study.conclude([])}


def test_the_study_flies_nothing_and_gives_what_was_recorded():
    known = recorded_studies([flown()], rows(), JUDGES)["a"]
    assert known.tasks == ()
    assert known.has_flights
    assert outcomes(known) == {
        "a.rms": (1.5, "flight 7", ClaimVerdict.PASS),
        "a.ape": (3.25, "flight 7", ClaimVerdict.PASS),
    }


def test_the_verdict_is_that_of_the_figure_whatever_was_written_beside_it():
    record = rows(figures=(2.5, 3.25))
    claim = record["a.rms"].outcome.claim
    record["a.rms"] = record["a.rms"]._replace(outcome=replace(claim.judge(1.0), ours=2.5))
    assert outcomes(recorded_studies([flown()], record, JUDGES)["a"])["a.rms"][2] is ClaimVerdict.FAIL


@pytest.mark.parametrize("change", [{"code": "5eed"}, {"judge": "5eed"}, {"judge": ""}, {"code": ""}])
def test_what_other_code_has_flown_or_judged_is_flown_again(change):
    record = rows()
    record["a.ape"] = record["a.ape"]._replace(**change)
    assert recorded_studies([flown()], record, JUDGES) == {}


def test_so_is_a_study_with_a_claim_that_is_new_or_gone_or_has_another_limit():
    fewer, other = FIGURES[:1], (FIGURES[0], replace(FIGURES[1], high=4.0))
    more = (*FIGURES, replace(FIGURES[0], id="settling"))
    for figures in (fewer, more, other):
        assert recorded_studies([flown(figures)], rows(), JUDGES) == {}
    record = rows()
    del record["a.ape"]
    assert recorded_studies([flown()], record, JUDGES) == {}


def test_each_study_has_its_own_rows():
    studies = [flown(), flown(study_id="a.part"), flown(study_id="b")]
    known = recorded_studies(studies, {**rows(), **rows("a.part", (1.0, 9.0))}, JUDGES)
    assert known.keys() == {"a", "a.part"}
    assert outcomes(known["a.part"])["a.part.ape"] == (9.0, "flight 7", ClaimVerdict.FAIL)


def test_what_flies_nothing_is_always_computed(study):
    record = {"a": Recorded(Claim("a", "", "", "1").judge(1.0), code_digest(), mark(JUDGES, "a", ["a"]))}
    assert recorded_studies([study("a", [1.0])], record, JUDGES) == {}


def test_one_that_does_not_tell_its_claims_beforehand_is_taken_by_their_mark(study):
    silent = study("a", [1.0], has_flights=True)
    assert recorded_studies([silent], rows(), JUDGES)["a"].tasks == ()
    assert recorded_studies([silent], {}, JUDGES) == {}
    assert recorded_studies([silent], {"a.rms": rows()["a.rms"]}, JUDGES) == {}, "a row was cut out"
    assert recorded_studies([silent], rows(), {**JUDGES, "a": "by other"}) == {}


def test_the_record_of_the_project_holds_every_study_with_flights_or_its_page_tells_otherwise(pytestconfig):
    docs = pytestconfig.rootpath / "docs"
    known = recorded_studies(all_studies(), read_record(docs / "validation.json"), judging_digests())
    missing = {study.id for study in all_studies() if study.has_flights} - known.keys()
    page = (docs / "validation.md").read_text()
    assert bool(missing) == (
        r"\*: flown or judged by an earlier version" in page or "not computed yet" in page
    )
