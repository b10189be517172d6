"""Studies whose computation may break off: then their claims fail with the reason, and the others go on."""

import traceback
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import nan
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from sim.campaign.claim import Claim, ClaimOutcome, Study, Task
from sim.campaign.code_digest import PROJECT
from sim.campaign.flight import fly_order
from sim.campaign.study import FlightStudy, campaign, describe_order
from sim.campaign.study_cache import CachedTask
from sim.console import detail
from sim.errors import HarnessError

Errors = tuple[type[Exception], ...]
Result = TypeVar("Result")

OF_THE_MACHINE: Errors = (OSError, MemoryError, ImportError)
"""No room, no memory, no package: what a claim says is not touched by them."""

PACKAGES = tuple(PROJECT / name for name in ("fsw", "hil_stub", "sim"))


class Failed(NamedTuple):
    """What stands for a result that there is not: why in a sentence, and the traceback."""

    reason: str
    trace: str


def guarded(study: Study, passed: Errors = ()) -> Study:
    """The study, whose claims all fail where a task or the judging of their results raises an error.

    Args:
        study: any.
        passed: errors that are raised nevertheless; those of the machine always are.
    """
    tasks = tuple(partial(attempt, task, passed) for task in study.tasks)
    return replace(study, tasks=tasks, conclude=partial(_conclude, study, passed))


def attempt(task: Callable[[], Result], passed: Errors = ()) -> Result | Failed:
    """What it gives, or why it gives nothing."""
    try:
        return task()
    except Exception as error:
        outside = (*passed, *OF_THE_MACHINE)
        if isinstance(error, outside) or isinstance(error.__context__, OF_THE_MACHINE):
            raise
        return Failed(_reason(error), traceback.format_exc())


def claims_of(study: Study) -> list[Claim]:
    """The claims that a study makes; where it does not tell them beforehand, one that stands for them."""
    judged: list[ClaimOutcome] | Failed
    if isinstance(study, FlightStudy):
        counted = f"; {len(study.tasks)} {study.counted}" if study.counted else ""
        judged = campaign(study.id, study.source + counted, (), study.figures).conclude([])
    else:
        judged = attempt(partial(study.conclude, [nan] * len(study.tasks)))
    if isinstance(judged, Failed) or not judged:  # its results are more than numbers
        return [
            Claim(study.id, "What the claims of this study are judged by", "this computation", "1", low=1.0)
        ]
    return [outcome.claim for outcome in judged]


def _conclude(study: Study, passed: Errors, results: Sequence[Any]) -> list[ClaimOutcome]:
    failed = [(number, one) for number, one in enumerate(results) if isinstance(one, Failed)]
    if failed:
        number, first = failed[0]
        more = f"; {len(failed)} of {len(results)} are not computed" if len(failed) > 1 else ""
        return _all_failed(study, first, f"{_named(study.tasks, number)}{first.reason}{more}")
    outcomes: list[ClaimOutcome] | Failed = attempt(partial(study.conclude, results), passed)
    if isinstance(outcomes, Failed):
        return _all_failed(study, outcomes, outcomes.reason)
    return outcomes


def _all_failed(study: Study, failed: Failed, where: str) -> list[ClaimOutcome]:
    detail(f"{study.id}: {failed.trace}")
    return [claim.judge(nan, where) for claim in claims_of(study)]


def _named(tasks: Sequence[Task], number: int) -> str:
    task = tasks[number]
    task = task.task if isinstance(task, CachedTask) else task
    if isinstance(task, partial) and task.func is fly_order:
        return f"{describe_order(*task.args)}: "
    return f"task {number + 1} of {len(tasks)}: " if len(tasks) > 1 else ""


def _reason(error: Exception) -> str:
    """The sentence of an error that has one for the user; of others the name and the place besides."""
    text = " ".join(str(error).split())
    if isinstance(error, HarnessError):
        return text
    said = f"{type(error).__name__}: {text}" if text else type(error).__name__
    frames = traceback.extract_tb(error.__traceback__)[1:]  # the first is this module's
    places = [f"{place}, line {frame.lineno}" for frame in frames if (place := _place(frame.filename))]
    return f"{said} ({places[-1]})" if places else said


def _place(file: str) -> str:
    """The path of a module of this project; empty for others."""
    path = Path(file)
    return path.relative_to(PROJECT).as_posix() if any(map(path.is_relative_to, PACKAGES)) else ""
