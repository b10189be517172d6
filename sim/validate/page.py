"""validation.md: one table, made of outcomes alone."""

import platform
from collections.abc import Sequence

import numpy as np
import scipy

from sim.campaign.claim import ClaimOutcome, ClaimVerdict
from sim.campaign.runner import StudyResult
from sim.junit import JunitCase
from sim.validate.reference.reference import FileResult

_HEAD = """# Validation

Written by `torquer validate`; do not edit. That command computes each row: a claim or a reference figure, its
source, the figure of this code, and the tolerance. Of the rows of a reference file the one nearest to its
tolerance counts.
"""


def render(finished: Sequence[StudyResult], wall_s: float) -> str:
    """The page: the table of claims, what was left out of the reference files, wall time and platform."""
    outcomes = [outcome for study in finished for outcome in study.outcomes]
    lines = [_HEAD, tally(outcomes) + ".", "", *claims_table(outcomes), ""]
    files = [result for study in finished for result in study.results if isinstance(result, FileResult)]
    if files:
        lines += ["| reference file | rows | columns not used |", "|---|---|---|"]
        lines += [f"| {file.name} | {file.rows} | {', '.join(file.unused) or 'none'} |" for file in files]
        lines.append("")
    lines += [f"Wall time {wall_s:.0f} s. {platform_line()}.", ""]
    return "\n".join(lines)


def claims_table(outcomes: Sequence[ClaimOutcome]) -> list[str]:
    """The lines of a table of claims with figures and verdicts."""
    return ["| claim | source | ours | tolerance | verdict |", "|---|---|---|---|---|", *map(_row, outcomes)]


def line(outcome: ClaimOutcome) -> str:
    """One outcome for the terminal."""
    if outcome.ours is None:
        return f"{outcome.verdict.value:<6} {outcome.claim.id}"
    where = f"  [{outcome.where}]" if outcome.where else ""
    figure = f"{_figure(outcome)} ({outcome.claim.limits})"
    return f"{outcome.verdict.value:<6} {outcome.claim.id}: {outcome.claim.statement}: {figure}{where}"


def as_json(outcome: ClaimOutcome) -> dict[str, object]:
    """One outcome, for programs; a side without a limit is infinite."""
    claim = outcome.claim
    return {
        "id": claim.id,
        "statement": claim.statement,
        "source": claim.source,
        "verdict": outcome.verdict.value,
        "ours": outcome.ours,
        "unit": claim.unit,
        "low": claim.low,
        "high": claim.high,
        "where": outcome.where,
    }


def suites(finished: Sequence[StudyResult]) -> dict[str, list[JunitCase]]:
    """The outcomes as tests, by study; a claim without its data was not judged."""
    return {study.study.id: [_test(outcome) for outcome in study.outcomes] for study in finished}


def _test(outcome: ClaimOutcome) -> JunitCase:
    said = {outcome.verdict: line(outcome)}
    return JunitCase(
        "validate",
        outcome.claim.id,
        failure=said.get(ClaimVerdict.FAIL, ""),
        skipped=said.get(ClaimVerdict.ABSENT, ""),
    )


def tally(outcomes: Sequence[ClaimOutcome]) -> str:
    """How many claims hold, fail, and could not be judged."""
    count = {verdict: sum(outcome.verdict is verdict for outcome in outcomes) for verdict in ClaimVerdict}
    text = f"{count[ClaimVerdict.PASS]} claims hold, {count[ClaimVerdict.FAIL]} fail"
    return text + (f", {count[ClaimVerdict.ABSENT]} absent" if count[ClaimVerdict.ABSENT] else "")


def platform_line() -> str:
    """What the figures were computed with."""
    return (
        f"Python {platform.python_version()}, numpy {np.__version__}, scipy {scipy.__version__}, "
        f"{platform.system()} {platform.machine()}"
    )


def _row(outcome: ClaimOutcome) -> str:
    claim = outcome.claim
    ours = "" if outcome.ours is None else _figure(outcome)
    if outcome.verdict is ClaimVerdict.FAIL and outcome.where:
        ours += f" at {outcome.where}"
    limits = f"{claim.limits} {_unit(claim.unit)}".strip() if outcome.ours is not None else ""
    cells = (f"{claim.statement} (`{claim.id}`)", claim.source, ours, limits, outcome.verdict.value)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _figure(outcome: ClaimOutcome) -> str:
    return f"{outcome.ours:.4g} {_unit(outcome.claim.unit)}".strip()


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit
