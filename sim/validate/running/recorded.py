"""Outcomes that were recorded, in the place of flights that this code would fly and judge the same."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from sim.campaign.claim import ClaimOutcome, Study
from sim.campaign.study import FlightStudy
from sim.validate.outcomes import Judges, Record, Recorded, outdated, study_of
from sim.validate.running.guard import claims_of


def recorded_studies(studies: Sequence[Study], record: Record, judges: Judges) -> dict[str, Study]:
    """By their ids, the studies all of whose claims were recorded: without tasks, they give what they gave.

    A study counts only where this code has flown and judged all its claims, as it makes them now.

    Args:
        studies: any.
        record: of all studies.
        judges: digests of the code that judges flights.
    """
    of_study = {study.id: _of(study.id, record, judges) for study in studies if study.has_flights}
    return {
        study.id: _without_flights(study, rows)
        for study in studies
        if (rows := of_study.get(study.id)) and not _changed(study, rows, judges)
    }


def _of(study: str, record: Record, judges: Judges) -> Record:
    return {name: one for name, one in record.items() if one.code and study_of(name, judges) == study}


def _changed(study: Study, rows: Record, judges: Judges) -> bool:
    """Whether a claim has no row, or one that other code has made, or a row no claim."""
    if not isinstance(study, FlightStudy):  # it does not tell its claims beforehand: their mark does
        return bool(outdated(rows, {}, judges))
    made = {claim.id: claim for claim in claims_of(study)}
    return made.keys() != rows.keys() or bool(outdated(rows, made, judges))


def _without_flights(study: Study, rows: Record) -> Study:
    return replace(study, tasks=(), conclude=partial(_judged_again, tuple(rows.values())))


def _judged_again(rows: Sequence[Recorded], results: Sequence[Any]) -> list[ClaimOutcome]:
    """By the figure: a record whose verdict is not that of its figure changes nothing."""
    assert not results
    return [
        one.outcome.claim.judge(one.outcome.ours, one.outcome.where, one.outcome.spread)
        for one in rows
        if one.outcome.ours is not None
    ]
