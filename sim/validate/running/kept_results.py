"""What tasks give that fly and judge in one, kept in the file of flights: none is lost when a run stops."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

from pydantic import TypeAdapter, ValidationError

from sim.campaign.claim import Study, Task
from sim.campaign.code_digest import code_digest
from sim.validate.commissioning import calibrated, wirings
from sim.validate.flight_rows import FlightRows


class KeptKind(NamedTuple):
    """Tasks of one argument; the first value of the result is that argument."""

    name: str
    task: Callable[[Any], Any]
    result: type[Any]


KINDS = (
    KeptKind("phasing", wirings.tally, wirings.Tally),
    KeptKind("calibration", calibrated.flown, calibrated.Flown),
)


def with_kept_results(studies: Sequence[Study], rows: FlightRows) -> list[Study]:
    """The studies, where the result of a task is known with that result in place of the task."""
    return [
        replace(study, tasks=tuple(_known(task, rows) or task for task in study.tasks)) for study in studies
    ]


def keep_result(rows: FlightRows, result: object) -> None:
    """Add what a task has given, if it is of one of the kinds and is not known.

    Raises:
        HarnessError: the file cannot be written, or another run adds to it.
    """
    for kind in KINDS:
        if isinstance(result, kind.result):
            key = _key(kind, result[0])
            if rows.result(key) is None:
                rows.keep_result(key, f"{kind.name} {result[0]}", list(result))


def _known(task: Task, rows: FlightRows) -> Task | None:
    for kind in KINDS:
        if isinstance(task, partial) and task.func is kind.task:
            values = rows.result(_key(kind, *task.args))
            return None if values is None else _given_again(kind, values)
    return None


def _given_again(kind: KeptKind, values: object) -> Task | None:
    try:
        return partial(_given, TypeAdapter(kind.result).validate_python(values))
    except ValidationError:
        return None  # it is computed anew


def _given(result: object) -> object:
    return result


def _key(kind: KeptKind, argument: object) -> str:
    """What tells one result from another, and the code of one from the code of another."""
    told = f"{kind.name} {argument!r} {code_digest(kind.task.__module__)}"
    return hashlib.sha256(told.encode()).hexdigest()[:16]
