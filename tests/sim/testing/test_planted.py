"""Each planted fault is found by flights as they are drawn, and correct schedulers pass.

Without shrinking, and as a rule from one seed. Hypothesis also draws the constants of the modules that other
tests have loaded, so that now and then a run finds nothing: then there are two more. ``make planted`` runs it
as a user would, from four.
"""

import pytest
from correct_schedulers import CORRECT
from hypothesis import Phase
from planted import Run, row, run
from planted_schedulers import PLANTED

SEED = 1
SEEDS = (1, 2, 3)
UNSHRUNK = (Phase.generate,)


@pytest.mark.long
@pytest.mark.parametrize("scheduler", PLANTED, ids=lambda one: one.__name__)
@pytest.mark.slow
def test_a_planted_fault_is_found(scheduler):
    assert any(run(scheduler.__name__, seed, UNSHRUNK).violation for seed in SEEDS)


@pytest.mark.long
@pytest.mark.parametrize("scheduler", CORRECT, ids=lambda one: one.__name__)
def test_a_correct_scheduler_passes(scheduler):
    assert run(scheduler.__name__, SEED, UNSHRUNK, examples=15).violation is None


@pytest.mark.parametrize(
    ("name", "runs", "passed"),
    [
        ("EveryNinth", [Run("EveryNinth", 9.0, "too long"), Run("EveryNinth", 9.0, "too long")], True),
        ("EveryNinth", [Run("EveryNinth", 9.0, "too long"), Run("EveryNinth", 9.0, None)], False),
        ("EveryNinth", [Run("EveryNinth", 60.0, "too long")], False),
        ("Timers", [Run("Timers", 9.0, None)], True),
        ("Timers", [Run("Timers", 9.0, None), Run("Timers", 9.0, "too long")], False),
    ],
)
def test_the_table_fails_by_a_missed_fault_a_failed_correct_scheduler_or_a_long_run(name, runs, passed):
    assert row(name, runs)[1] is passed
