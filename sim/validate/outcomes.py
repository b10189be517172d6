"""The outcomes of the claims: validation.json, which holds the last of each, and the page beside it."""

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pydantic import BaseModel, ConfigDict, RootModel, ValidationError

from fsw.input.regular_file import read_regular
from fsw.input.schema import faults
from fsw.input.toml_text import BoundsError
from sim.campaign.claim import Claim, ClaimOutcome, ClaimVerdict, Spread, Threshold
from sim.campaign.runner import StudyResult
from sim.errors import HarnessError
from sim.result_files import write_result
from sim.validate.page import figure_text, render

MOST_BYTES = 4_000_000
DIGITS = 6
"""Of each figure that is kept: more would be those of the machine."""
UNJUDGED = (ClaimVerdict.ABSENT, ClaimVerdict.TOO_FEW)

Record = Mapping[str, ClaimOutcome]
"""By the id of the claim."""


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


class _File(RootModel[dict[str, _Row]]):
    """The whole file."""


def with_record(before: Record, finished: Sequence[StudyResult], studies: Collection[str]) -> Record:
    """The outcomes of now and, of other studies, those before, sorted: what a study no longer claims goes.

    A claim that is not judged now, as its data are missing, keeps its outcome.

    Args:
        before: what the file held.
        finished: what was run.
        studies: ids of all studies; a claim is of the one with the longest id that it begins with.
    """
    run_now = {done.study.id for done in finished}
    outcomes = [outcome for done in finished for outcome in done.outcomes]
    claimed = {outcome.claim.id for outcome in outcomes}
    kept = {
        name: one for name, one in before.items() if name in claimed or study_of(name, studies) not in run_now
    }
    judged = {outcome.claim.id: outcome for outcome in outcomes if outcome.verdict not in UNJUDGED}
    return dict(sorted({**kept, **judged}.items()))


def study_of(claim: str, studies: Collection[str]) -> str:
    """The study of a claim; empty where none has it."""
    return max((one for one in studies if f"{claim}.".startswith(f"{one}.")), key=len, default="")


def as_figures(record: Record) -> dict[str, dict[str, str]]:
    """By the id of the claim: its figure with its unit, its limits, its verdict."""
    return {
        name: {
            "figure": figure_text(outcome),
            "limits": outcome.claim.limits,
            "verdict": outcome.verdict.value,
        }
        for name, outcome in record.items()
    }


# --- The file


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


def _row(outcome: ClaimOutcome) -> _Row:
    claim = outcome.claim
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
    )


def _recorded(name: str, row: _Row) -> ClaimOutcome:
    claim = Claim(name, row.statement, row.source, row.unit, row.low, row.high, row.threshold, row.wide)
    met = row.verdict is ClaimVerdict.PASS
    fitted = met and row.threshold is Threshold.FITTED  # however it was called when it was written
    verdict = ClaimVerdict.FITTED if fitted else row.verdict
    return ClaimOutcome(claim, verdict, row.ours, row.where, row.spread)


def _rounded_spread(spread: Spread) -> Spread:
    values = map(_rounded, (spread.least, spread.median, spread.most))
    return Spread(spread.flights, spread.meet, *values)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _no_record(path: Path, why: str) -> HarnessError:
    return HarnessError(f"{path}: no outcomes of torquer validate: {why}")


# --- The file and the page of a run


@dataclass(slots=True)
class ResultFiles:
    """What is written of a run.

    Attributes:
        page: None: not written.
        figures: the file of outcomes; None: not written.
        studies: ids of all studies.
        claimed: ids of the claims that are made, by all studies that tell them beforehand.
        before: what ``figures`` held of all studies, where the outcomes are put among those; None: it is to
            hold those of this run alone.
        done: the studies of this run that are done.
    """

    page: Path | None
    figures: Path | None
    studies: frozenset[str]
    claimed: frozenset[str] = frozenset()
    before: Record | None = None
    done: list[StudyResult] = field(default_factory=list)

    def take(self, study: StudyResult, wall_s: float) -> None:
        """A study is done; where there are outcomes before, both files now have its own too.

        Raises:
            HarnessError: a file cannot be written.
        """
        self.done.append(study)
        if self.before is not None:
            known = with_record(self.before, self.done, self.studies)
            # no details: those of a part would stand for the whole
            self._write(known, render([*known.values()], [], wall_s, sorted(self.claimed - known.keys())))

    def finish(self, finished: Sequence[StudyResult], wall_s: float) -> None:
        """All studies are done.

        Raises:
            HarnessError: a file cannot be written.
        """
        if self.before is None:
            outcomes = [outcome for study in finished for outcome in study.outcomes]
            self._write(with_record({}, finished, self.studies), render(outcomes, finished, wall_s))

    def _write(self, known: Record, text: str) -> None:
        for file, content in ((self.figures, as_text(known)), (self.page, text)):
            if file is not None:
                write_result(file, content)  # outcomes of hours are not lost by a kill
