"""validation.json: the outcomes of the claims as last computed, for what is written from them."""

import hashlib
import json
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from pydantic import BaseModel, ConfigDict, RootModel, ValidationError

from fsw.input.regular_file import read_regular
from fsw.input.schema import faults
from fsw.input.toml_text import BoundsError
from sim.campaign.claim import Claim, ClaimOutcome, ClaimVerdict, Spread, Threshold
from sim.campaign.code_digest import code_digest
from sim.campaign.runner import StudyResult
from sim.errors import HarnessError
from sim.validate.page import figure_text

MOST_BYTES = 4_000_000
DIGITS = 6
"""Of each figure that is kept: more would be those of the machine."""


class Recorded(NamedTuple):
    """An outcome; where there are flights, the digest of the code that flew and the mark of what judged."""

    outcome: ClaimOutcome
    code: str
    judge: str = ""


Record = Mapping[str, Recorded]
"""By the id of the claim."""
Judges = Mapping[str, str]
"""By the id of each study with flights: the digest of the code that judges them."""


class _Row(BaseModel):
    """What the file has of a claim; what JSON has no number for, as a limit that is none, is a text."""

    model_config = ConfigDict(extra="forbid", ser_json_inf_nan="strings")

    statement: str
    source: str
    ours: float
    unit: str
    low: float
    high: float
    threshold: Threshold
    wide: str
    verdict: ClaimVerdict
    where: str
    spread: Spread | None
    code: str
    judge: str = ""


class _File(RootModel[dict[str, _Row]]):
    """The whole file."""


def as_record(finished: Sequence[StudyResult], judges: Judges) -> Record:
    """What the file is to hold of them; a claim that is not judged is left out."""
    return {name: one for done in finished for name, one in _rows_of(done, judges).items()}


def _rows_of(done: StudyResult, judges: Judges) -> Record:
    unjudged = (ClaimVerdict.ABSENT, ClaimVerdict.TOO_FEW)
    outcomes = {one.claim.id: one for one in done.outcomes if one.verdict not in unjudged}
    flown = done.study.has_flights
    code, judge = (code_digest(), mark(judges, done.study.id, outcomes)) if flown else ("", "")
    return {name: Recorded(outcome, code, judge) for name, outcome in outcomes.items()}


def mark(judges: Judges, study: str, claims: Iterable[str]) -> str:
    """Of the code that judges a study and all claims that it makes: with one missing it is another."""
    if study not in judges:
        return ""
    return hashlib.sha256(" ".join([judges[study], *sorted(claims)]).encode()).hexdigest()[:16]


def with_record(
    before: Record, finished: Sequence[StudyResult], studies: Collection[str], judges: Judges
) -> Record:
    """The outcomes of now and, of other studies, those before, sorted: what a study no longer claims goes.

    A claim whose data are not there now keeps its outcome.

    Args:
        before: what the file held.
        finished: what was run.
        studies: ids of all studies; a claim is of the one with the longest id that it begins with.
        judges: digests of the code that judges flights.
    """
    run_now = {done.study.id for done in finished}
    claimed = {outcome.claim.id for done in finished for outcome in done.outcomes}
    kept = {
        name: one for name, one in before.items() if name in claimed or study_of(name, studies) not in run_now
    }
    return dict(sorted({**kept, **as_record(finished, judges)}.items()))


def study_of(claim: str, studies: Collection[str]) -> str:
    """The study of a claim; empty where none has it."""
    return max((one for one in studies if f"{claim}.".startswith(f"{one}.")), key=len, default="")


def outdated(record: Record, made: Mapping[str, Claim], judges: Judges) -> set[str]:
    """The claims whose flights other code has flown or judged, or that now have other limits or words.

    Args:
        record: what was computed.
        made: the claims as this code makes them, by their ids; one that is not there counts as unchanged.
        judges: digests of the code that judges flights.
    """
    marks = _marks(record, judges)
    return {
        name
        for name, (outcome, code, judge) in record.items()
        if made.get(name, outcome.claim) != outcome.claim
        or (code and (code, judge) != (code_digest(), marks[name]))
    }


def _marks(record: Record, judges: Judges) -> dict[str, str]:
    """By the id of each claim with flights: its mark, if this code has judged it."""
    claims: dict[str, list[str]] = {}
    for name, one in record.items():
        if one.code:
            claims.setdefault(study_of(name, judges), []).append(name)
    return {name: mark(judges, study, names) for study, names in claims.items() for name in names}


def as_figures(record: Record) -> dict[str, dict[str, str]]:
    """By the id of the claim: its figure with its unit, its limits, its verdict."""
    return {
        name: {
            "figure": figure_text(one.outcome),
            "limits": one.outcome.claim.limits,
            "verdict": one.outcome.verdict.value,
        }
        for name, one in record.items()
    }


def as_text(record: Record) -> str:
    """The file: a claim a line."""
    rows = [f"  {json.dumps(name)}: {_row(one).model_dump_json()}" for name, one in record.items()]
    return "{\n" + ",\n".join(rows) + "\n}\n"


def read_record(path: Path) -> Record:
    """The outcomes of a file; none if there is no file.

    Raises:
        HarnessError: it cannot be read, or holds something else.
    """
    if not path.exists():
        return {}
    try:
        rows = _File.model_validate_json(read_regular(path, MOST_BYTES)).root
    except OSError as error:
        raise _no_record(path, error.strerror or str(error)) from None
    except BoundsError as error:
        raise _no_record(path, str(error)) from None
    except ValidationError as error:
        raise _no_record(path, faults(_File, error)) from None
    return {name: _recorded(name, row) for name, row in rows.items()}


def _row(one: Recorded) -> _Row:
    outcome, claim = one.outcome, one.outcome.claim
    assert outcome.ours is not None
    return _Row(
        statement=claim.statement,
        source=claim.source,
        ours=_rounded(outcome.ours),
        unit=claim.unit,
        low=claim.low,
        high=claim.high,
        threshold=claim.threshold,
        wide=claim.wide,
        verdict=outcome.verdict,
        where=outcome.where,
        spread=None if outcome.spread is None else _rounded_spread(outcome.spread),
        code=one.code,
        judge=one.judge,
    )


def _recorded(name: str, row: _Row) -> Recorded:
    claim = Claim(name, row.statement, row.source, row.unit, row.low, row.high, row.threshold, row.wide)
    met = row.verdict is ClaimVerdict.PASS
    fitted = met and row.threshold is Threshold.FITTED  # however it was called when it was written
    verdict = ClaimVerdict.FITTED if fitted else row.verdict
    return Recorded(ClaimOutcome(claim, verdict, row.ours, row.where, row.spread), row.code, row.judge)


def _rounded_spread(spread: Spread) -> Spread:
    values = map(_rounded, (spread.least, spread.median, spread.most))
    return Spread(spread.flights, spread.meet, *values)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _no_record(path: Path, why: str) -> HarnessError:
    return HarnessError(f"{path}: no outcomes of torquer validate: {why}")
