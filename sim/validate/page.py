"""validation.md: one table, made of outcomes alone."""

import platform
from collections.abc import Sequence
from dataclasses import asdict, replace
from math import inf

import numpy as np
import scipy

from sim.campaign.claim import Claim, ClaimOutcome, ClaimVerdict, Spread, Threshold
from sim.campaign.runner import StudyResult
from sim.console import counted
from sim.junit import JunitCase
from sim.validate.flight_data.claims import passes_table
from sim.validate.flight_data.passes import PassFigures
from sim.validate.reference.reference import FileResult

_HEAD = """# Validation

Written by `torquer validate`; do not edit. The command computes every row: a claim or a reference figure, its
source, the figure of this code, and the tolerance. Of a reference file, the row nearest to its tolerance is
shown.

The column *whose* tells where a tolerance comes from. *paper*: as the source prints it, or as its
statistics give it. *reference file*: as its header states it. *own prototype*: the result of an earlier
computation of this project. *own requirement*: asked of the project before the figure was computed. *own,
set afterwards*: set when the figure was known, close to it, so that a change shows; where it is more than
ten times off, the reason is given. (Of a fraction near one, the part that is missing counts.) *fitted*: the
paper's figure, to which a number of the scenario was fitted; meeting it proves nothing, so it does not
count as met. A paper reports one flight; the column *all starts* gives the least, the median and the
greatest over all starts, and how many meet the tolerance. Settled means within the threshold from then on
to the end, for at least 600 s.
"""


def render(
    outcomes: Sequence[ClaimOutcome],
    finished: Sequence[StudyResult],
    wall_s: float,
    unknown: Sequence[str] = (),
) -> str:
    """The page: the table of claims, what was left out of the reference files, wall time and platform.

    Args:
        outcomes: of all claims of the page.
        finished: the studies whose reference files and recorded passes are listed.
        wall_s: of this run.
        unknown: claims that are made and have no outcome yet.
    """
    lines = [_HEAD, tally(outcomes) + ".", "", *claims_table(outcomes), ""]
    if unknown:
        lines += [f"Claimed, and not computed yet: {', '.join(unknown)}.", ""]
    lines += [
        f"Own limits more than ten times off, without a reason: {', '.join(loose(outcomes)) or 'none'}.",
        "",
    ]
    files = [result for study in finished for result in study.results if isinstance(result, FileResult)]
    if files:
        lines += ["| reference file | rows | columns not used |", "|---|---|---|"]
        lines += [f"| {file.name} | {file.rows} | {', '.join(file.unused) or 'none'} |" for file in files]
        lines.append("")
    passes = [result for study in finished for result in study.results if isinstance(result, PassFigures)]
    if passes:
        lines += [*passes_table(passes), ""]
    lines += [f"Wall time of the last run {wall_s:.0f} s. {platform_line()}.", ""]
    return "\n".join(lines)


def loose(outcomes: Sequence[ClaimOutcome]) -> list[str]:
    """The claims whose limit is this project's own and far from the figure, without a reason."""
    return [
        one.claim.id
        for one in outcomes
        if one.ours is not None
        and one.verdict is not ClaimVerdict.TOO_FEW
        and (one.claim.is_loose(one.ours) or _is_loose_part(one.claim, one.ours))
    ]


def _is_loose_part(claim: Claim, ours: float) -> bool:
    """Whether a part of a whole that is to be large lacks far less than its limit lets it.

    0.95 of the time is near to 0.9999 of it, but 500 times what then is missing.
    """
    if claim.unit != "1" or claim.high != inf or not 0.5 < claim.low <= ours <= 1.0:
        return False
    return replace(claim, low=-inf, high=1.0 - claim.low).is_loose(1.0 - ours)


def claims_table(outcomes: Sequence[ClaimOutcome]) -> list[str]:
    """The lines of a table of claims with figures and verdicts."""
    head = "| claim | source | ours | all starts | tolerance | whose | verdict |"
    return [head, "|---" * 7 + "|", *map(_row, outcomes)]


def line(outcome: ClaimOutcome) -> str:
    """One outcome for the terminal."""
    if outcome.ours is None:
        return f"{outcome.verdict.value:<6} {outcome.claim.id}"
    where = f"  [{outcome.where}]" if outcome.where else ""
    figure = f"{figure_text(outcome)} ({outcome.claim.limits}, {outcome.claim.threshold.value})"
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
        "threshold": claim.threshold.value,
        "wide": claim.wide,
        "room": None if outcome.ours is None else claim.room(outcome.ours),
        "where": outcome.where,
        "spread": None if outcome.spread is None else asdict(outcome.spread),
    }


def suites(finished: Sequence[StudyResult]) -> dict[str, list[JunitCase]]:
    """The outcomes as tests, by study; one that is not judged, or fitted, is skipped."""
    return {study.study.id: [_test(outcome) for outcome in study.outcomes] for study in finished}


def _test(outcome: ClaimOutcome) -> JunitCase:
    said, failed = line(outcome), outcome.verdict is ClaimVerdict.FAIL
    skipped = not failed and outcome.verdict is not ClaimVerdict.PASS
    return JunitCase(
        "validate", outcome.claim.id, failure=said if failed else "", skipped=said if skipped else ""
    )


def tally(outcomes: Sequence[ClaimOutcome]) -> str:
    """How many claims hold and fail, by where their limits come from; how many could not be judged."""
    judged = (ClaimVerdict.PASS, ClaimVerdict.FAIL)
    parts = []
    for threshold in Threshold:
        mine = [one for one in outcomes if one.claim.threshold is threshold and one.verdict in judged]
        if mine:
            met = sum(one.verdict is ClaimVerdict.PASS for one in mine)
            parts.append(f"{threshold.value} {met} of {len(mine)}")
    met = sum(one.verdict is ClaimVerdict.PASS for one in outcomes)
    failed = sum(one.verdict is ClaimVerdict.FAIL for one in outcomes)
    text = f"{counted(met, 'claim')} met, {failed} failed"
    text += f" ({', '.join(parts)})" if parts else ""
    others = (ClaimVerdict.FITTED, ClaimVerdict.ABSENT, ClaimVerdict.TOO_FEW)
    count = {verdict: sum(one.verdict is verdict for one in outcomes) for verdict in others}
    return text + "".join(f", {count[verdict]} {verdict.value}" for verdict in others if count[verdict])


def platform_line() -> str:
    """What the figures were computed with."""
    return (
        f"Python {platform.python_version()}, numpy {np.__version__}, scipy {scipy.__version__}, "
        f"{platform.system()} {platform.machine()}"
    )


def _row(outcome: ClaimOutcome) -> str:
    claim = outcome.claim
    ours = "" if outcome.ours is None else figure_text(outcome)
    if outcome.verdict is ClaimVerdict.FAIL and outcome.where:
        ours += f" at {outcome.where}"
    if outcome.verdict is ClaimVerdict.TOO_FEW:
        ours += f" of {outcome.where}"
    limits = f"{claim.limits} {_unit(claim.unit)}".strip() if outcome.ours is not None else ""
    limits += f" ({claim.wide})" if claim.wide and limits else ""
    cells = (
        f"{claim.statement} (`{claim.id}`)",
        claim.source,
        ours,
        "" if outcome.spread is None else _spread(outcome.spread),
        limits,
        claim.threshold.value,
        outcome.verdict.value,
    )
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _spread(spread: Spread) -> str:
    """Least, median and most, and how many meet the claim."""
    values = " / ".join(f"{value:.3g}" for value in (spread.least, spread.median, spread.most))
    return f"{values}; {spread.meet} of {spread.flights}"


def figure_text(outcome: ClaimOutcome) -> str:
    """The figure with its unit; the claim has one."""
    return f"{outcome.ours:.4g} {_unit(outcome.claim.unit)}".strip()


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit
