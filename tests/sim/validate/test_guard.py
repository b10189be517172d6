"""A computation that breaks off fails the claims made from it, with the reason, and no others."""

import pickle
from dataclasses import replace
from functools import partial
from math import isnan
from pathlib import Path

import pytest

from sim.campaign.claim import Claim, ClaimVerdict, Study
from sim.campaign.flight import FlightResult, Order, fly_order
from sim.campaign.runner import run
from sim.campaign.study import Figure, Group, campaign, figure_of
from sim.design.theory.periodic_lqr import NotConvergedError
from sim.errors import HarnessError
from sim.validate.guard import Failed, attempt, claims_of, guarded
from sim.validate.review.figures import judged, one_figure

CLAIM = Claim("a.b", "Least", "Somebody", "deg", high=2.0)


def raising(error):
    raise error


def result_of(*studies, passed=()):
    """The outcomes of studies that are run in this process."""
    finished = run([guarded(one, passed) for one in studies], 1, lambda done: None, lambda study: None)
    return [outcome for study in finished for outcome in study.outcomes]


def unreadable():
    try:
        Path("/nowhere/at/all").read_bytes()
    except OSError as error:
        raise HarnessError(f"cannot be read ({error.strerror})") from None


class TestTask:
    @pytest.mark.parametrize(
        ("error", "where"),
        [
            (HarnessError("the log cannot tell\nthe magnetometer"), "the log cannot tell the magnetometer"),
            (NotConvergedError("no gains"), "NotConvergedError: no gains"),
            (AssertionError(), "AssertionError"),
            (ZeroDivisionError("division by zero"), "ZeroDivisionError: division by zero"),
        ],
    )
    def test_that_breaks_off_fails_its_claim_with_the_reason_and_the_others_go_on(self, error, where):
        lost = one_figure(CLAIM, partial(raising, error))
        outcomes = result_of(lost, one_figure(replace(CLAIM, id="c"), partial(float, 1.0)))
        assert [one.verdict for one in outcomes] == [ClaimVerdict.FAIL, ClaimVerdict.PASS]
        assert outcomes[0].claim == CLAIM
        assert isnan(outcomes[0].ours)
        assert outcomes[0].where == where

    def test_the_place_in_the_code_is_told(self):
        failed = attempt(partial(figure_of("a"), None))
        assert failed.reason.startswith("AttributeError: ")
        assert "(sim/campaign/study.py, line " in failed.reason
        assert "Traceback" in failed.trace

    @pytest.mark.parametrize(
        "task",
        [
            partial(raising, OSError(28, "No space left on device")),
            partial(raising, MemoryError()),
            unreadable,
        ],
    )
    def test_what_the_machine_lacks_fails_no_claim(self, task):
        with pytest.raises((OSError, MemoryError, HarnessError)):
            result_of(one_figure(CLAIM, task))

    def test_what_ends_the_command_is_raised(self):
        with pytest.raises(KeyboardInterrupt):
            result_of(one_figure(CLAIM, partial(raising, KeyboardInterrupt())))

    def test_errors_of_files_that_a_user_gave_are_raised(self):
        with pytest.raises(HarnessError, match="line 3"):
            result_of(one_figure(CLAIM, partial(raising, HarnessError("line 3"))), passed=(HarnessError,))
        (outcome,) = result_of(one_figure(CLAIM, partial(raising, ValueError("5"))), passed=(HarnessError,))
        assert outcome.verdict is ClaimVerdict.FAIL


class TestStudy:
    CLAIMS = (CLAIM, replace(CLAIM, id="a.c"))

    def test_all_its_claims_fail_where_one_of_its_tasks_does(self):
        tasks = (partial(float, 1.0), partial(raising, ValueError("5")), partial(raising, ValueError("6")))
        study = Study("a", tasks, lambda found: judged(self.CLAIMS, found[:2]))
        outcomes = result_of(study)
        assert [(one.claim, one.verdict) for one in outcomes] == [
            (claim, ClaimVerdict.FAIL) for claim in self.CLAIMS
        ]
        assert {one.where for one in outcomes} == {
            "task 2 of 3: ValueError: 5; 2 of 3 are not computed",
        }

    def test_whose_results_cannot_be_judged_fails(self):
        study = Study("a", (partial(float, 0.0),), lambda found: [CLAIM.judge(1.0 / found[0])])
        (outcome,) = result_of(study)
        assert (outcome.claim, outcome.verdict) == (CLAIM, ClaimVerdict.FAIL)
        assert "ZeroDivisionError" in outcome.where

    @pytest.mark.parametrize("conclude", [lambda found: [CLAIM.judge(found[0].x)], lambda found: []])
    def test_that_does_not_tell_its_claims_beforehand_fails_in_one_of_its_name(self, conclude):
        study = Study("a", (partial(raising, ValueError("5")),), conclude)
        (outcome,) = result_of(study)
        assert (outcome.claim.id, outcome.verdict) == ("a", ClaimVerdict.FAIL)

    def test_of_flights_fails_in_each_figure_and_names_the_flight(self):
        order = Order("nowhere", name="satellite 7")
        figures = (
            Figure("x", "Error", "deg", figure_of("x"), high=1.0),
            Figure("y", "Time", "s", figure_of("y"), high=1.0),
        )
        study = campaign("flown", "Somebody", (Group("", (order,)),), figures, "satellites")
        sound = study.conclude([FlightResult(order, {}, {"x": 0.5, "y": 0.5})])
        lost = result_of(study)
        assert [one.claim for one in lost] == [one.claim for one in sound] == claims_of(study)
        assert {one.verdict for one in lost} == {ClaimVerdict.FAIL}
        assert all(one.where.startswith("satellite 7: ") for one in lost)

    def test_that_computes_is_as_it_is_without_a_guard(self, study):
        sound = study("a", [1.0, 2.0])
        assert result_of(sound) == sound.conclude((1.0, 2.0))


def test_a_guarded_task_goes_to_another_process_and_back():
    (task,) = guarded(Study("a", (partial(fly_order, Order("nowhere")),), list)).tasks
    failed = pickle.loads(pickle.dumps(pickle.loads(pickle.dumps(task))()))
    assert isinstance(failed, Failed)
    assert "nowhere" in failed.reason
