"""Requirements of the scenario over a campaign as tables, lines and JSON; of a few runs against each."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sim.campaign.definition.campaign import Campaign
from sim.campaign.one_run import run_folder
from sim.campaign.report.shares import RequirementShare
from sim.campaign.report.verdicts import proportion
from sim.console import counted
from sim.drawing.page_parts import Table
from sim.record import run_dir
from sim.report.requirements.judge import Outcome
from sim.report.requirements.matrix import JudgedRun, MatrixCell, MatrixRow, matrix_table
from sim.report.requirements.words import number
from sim.value_types import Json

MOST_RUNS = 12
"""Of a campaign that shows each run; of more runs it shows the share alone."""
_ABSENT = "–"


def run_tables(shares: Sequence[RequirementShare], folder: Path) -> list[Table]:
    """The requirements against each run, linked to its report if that is kept; none of too many runs."""
    if not 0 < len(shares[0].runs) <= MOST_RUNS:
        return []
    runs = [JudgedRun(f"run {run}", (), _page_of(folder, run)) for run in shares[0].runs]
    return [matrix_table([MatrixRow(one.id, one.words, one.unit, _cells(one)) for one in shares], runs)]


def _page_of(folder: Path, run: int) -> str:
    page = run_folder(folder, run) / run_dir.REPORT
    return page.relative_to(folder).as_posix() if page.is_file() else ""


def _cells(one: RequirementShare) -> tuple[MatrixCell | None, ...]:
    figures = zip(one.verdicts, one.measured.tolist(), one.limits.tolist(), strict=True)
    return tuple(
        None if np.isnan(limit) else MatrixCell(verdict, None if np.isnan(value) else value, limit)
        for verdict, value, limit in figures
    )


def share_table(shares: Sequence[RequirementShare]) -> Table:
    """The share that meets each, with the middle and the largest figure and the least margin."""
    head = (
        "requirement",
        "limit",
        "met by",
        "part",
        "at least",
        "at most",
        "median",
        "largest",
        "least margin",
    )
    return Table(head, [(one.words, one.limit, *_share_cells(one), *_figure_cells(one)) for one in shares])


def _share_cells(one: RequirementShare) -> tuple[str, ...]:
    if one.met is None:
        return (Outcome.NOT_JUDGED.value, _ABSENT, _ABSENT, _ABSENT)
    unjudged = f", {one.unjudged} not judged" if one.unjudged else ""
    parts = (f"{100.0 * part:.2f} %" for part in (one.met.value, one.met.low, one.met.high))
    return (f"{one.met.count} of {one.met.total}{unjudged}", *parts)


def _figure_cells(one: RequirementShare) -> tuple[str, ...]:
    if one.tightest is None:
        return (_ABSENT,) * 3
    middle, largest = float(np.nanmedian(one.measured)), float(np.nanmax(one.measured))
    margin = f"{number(float(one.margins[one.tightest]))} {one.unit}, run {one.runs[one.tightest]}"
    return f"{number(middle)} {one.unit}", f"{number(largest)} {one.unit}", margin


def shortfalls(shares: Sequence[RequirementShare]) -> list[str]:
    """How many requirements no run was long enough for, and how many some run misses; none of none."""
    of_all = f"of {counted(len(shares), 'requirement')} of the scenario"
    unjudged = sum(one.met is None for one in shares)
    missed = sum(one.met is not None and one.met.count < one.met.total for one in shares)
    counts = {f"{unjudged} {of_all} not judged": unjudged, f"{missed} {of_all} missed by a run": missed}
    return [words for words, count in counts.items() if count]


def share_lines(shares: Sequence[RequirementShare], campaign: Campaign) -> list[str]:
    """A line each for the terminal."""
    lines = []
    for one in shares:
        if one.met is None:
            found = f"{Outcome.NOT_JUDGED} before orbit {one.by_orbit:g}"
        else:
            found = f"met by {proportion(one.met, campaign)}"
            found += f", {counted(one.unjudged, 'run')} not judged" if one.unjudged else ""
        least = "" if one.tightest is None else f", least margin {_figure_cells(one)[-1]}"
        lines.append(f"  scenario   {one.words}, {one.limit}: {found}{least}")
    return lines


def share_json(shares: Sequence[RequirementShare]) -> list[Json]:
    """The same as values of JSON."""
    return [
        {
            "id": one.id,
            "requirement": one.words,
            "unit": one.unit,
            "met": one.met and one.met.values,
            "not_judged": one.unjudged,
            "least_margin": None if one.tightest is None else float(one.margins[one.tightest]),
            "least_margin_run": None if one.tightest is None else one.runs[one.tightest],
        }
        for one in shares
    ]
