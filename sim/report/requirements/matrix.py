"""Requirements against runs: what each run says of each requirement, as a table, as lines and as JSON."""

import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

from sim.console import counted
from sim.drawing.page_parts import PageHeader, PageSection, Table, TableCell, sections_page
from sim.record import run_dir
from sim.report.requirements.judge import Outcome
from sim.report.requirements.words import limit_words, number
from sim.result_files import write_result
from sim.scenario.requirements import in_words
from sim.value_types import Json

KINDS = {Outcome.MET: "good", Outcome.FAILED: "bad", Outcome.NOT_JUDGED: "note"}
"""The class of style of each verdict."""
SIGNS = {Outcome.MET: "✓ ", Outcome.FAILED: "✗ ", Outcome.NOT_JUDGED: Outcome.NOT_JUDGED.value}
"""How a cell of the table begins."""
ABSENT = "–"


@dataclass(frozen=True, slots=True)
class JudgedRun:
    """A run with its verdicts.

    Attributes:
        name: by which it is called.
        requirements: as in its summary.json.
        page: the address of its report from where the matrix stands; empty where there is none.
    """

    name: str
    requirements: Sequence[Mapping[str, Any]]
    page: str = ""


@dataclass(frozen=True, slots=True)
class MatrixCell:
    """What a run says of a requirement; ``measured`` is None where it was not judged or never settled."""

    verdict: Outcome
    measured: float | None
    limit: float

    @property
    def margin(self) -> float | None:
        """How far the figure is under its limit; negative where it is over."""
        return None if self.measured is None else self.limit - self.measured


@dataclass(frozen=True, slots=True)
class MatrixRow:
    """A requirement against all runs.

    Attributes:
        id: its name; None where it has none.
        words: index and what it is of, after the name where there is one.
        unit: of figures, limits and margins.
        cells: of each run, in their order; None where the run does not have the requirement.
    """

    id: str | None
    words: str
    unit: str
    cells: tuple[MatrixCell | None, ...]

    def count(self, verdict: Outcome) -> int:
        """How many runs have this verdict."""
        return sum(cell is not None and cell.verdict is verdict for cell in self.cells)

    @property
    def limit(self) -> str:
        """The limit in words, of all runs."""
        return limit_words(sorted({cell.limit for cell in self.cells if cell is not None}), self.unit)

    @property
    def share(self) -> str:
        """By how many it is met, of the runs that are judged by it."""
        judged = self.count(Outcome.MET) + self.count(Outcome.FAILED)
        if not judged:
            return Outcome.NOT_JUDGED.value
        unjudged = self.count(Outcome.NOT_JUDGED)
        return f"{self.count(Outcome.MET)} of {judged}" + (f", {unjudged} not judged" if unjudged else "")


def matrix(runs: Sequence[JudgedRun]) -> list[MatrixRow]:
    """The requirements of all runs, in the order in which they first occur.

    Those with the same ``id`` are one; without one, those of the same index, limit and orbit.
    """
    found: dict[tuple[object, ...], list[Mapping[str, Any] | None]] = {}
    for place, run in enumerate(runs):
        for key, one in _keyed(run.requirements):
            found.setdefault(key, [None] * len(runs))[place] = one
    return [_row(each) for each in found.values()]


def _keyed(
    requirements: Sequence[Mapping[str, Any]],
) -> Iterator[tuple[tuple[object, ...], Mapping[str, Any]]]:
    """Each requirement with what it is known by; of equal ones without a name, also by their number."""
    seen: Counter[tuple[object, ...]] = Counter()
    for one in requirements:
        if one.get("id") is not None:
            yield (one["id"], one["index"], one["unit"]), one
            continue
        alike = tuple(one[key] for key in ("index", "what", "unit", "limit", "by_orbit"))
        seen[alike] += 1
        yield (*alike, seen[alike]), one


def _row(each: Sequence[Mapping[str, Any] | None]) -> MatrixRow:
    first = next(one for one in each if one is not None)
    name = first.get("id")
    cells = tuple(
        None if one is None else MatrixCell(Outcome(one["verdict"]), one["measured"], one["limit"])
        for one in each
    )
    return MatrixRow(name, in_words(first["index"], first["what"], name), first["unit"], cells)


# --- As a table, as lines, as JSON


def matrix_table(rows: Sequence[MatrixRow], runs: Sequence[JudgedRun]) -> Table:
    """A row per requirement, a column per run that links to its page: the sign, the figure and its margin."""
    links = (TableCell(run.name, href=run.page) for run in runs)
    head = ("requirement", "limit", "met by", *links)
    body = [
        (
            row.words,
            row.limit,
            row.share,
            *(
                ABSENT if cell is None else _table_cell(cell, run.page)
                for cell, run in zip(row.cells, runs, strict=True)
            ),
        )
        for row in rows
    ]
    return Table(head, body)


def _table_cell(cell: MatrixCell, page: str) -> TableCell:
    sign = SIGNS[cell.verdict]
    if cell.measured is None or cell.margin is None:
        return TableCell(
            f"{sign}{'no value' if cell.verdict is Outcome.FAILED else ''}", KINDS[cell.verdict], page
        )
    plus = "+" if cell.margin >= 0.0 else ""
    words = f"{sign}{number(cell.measured)} ({plus}{number(cell.margin)})"
    return TableCell(words, KINDS[cell.verdict], page)


def _figures(cell: MatrixCell, unit: str) -> str:
    """Value and margin, where there are any."""
    if cell.measured is None or cell.margin is None:
        return ""
    return f": {number(cell.measured)}{unit}, margin {number(cell.margin)}{unit}"


def matrix_lines(rows: Sequence[MatrixRow], runs: Sequence[JudgedRun]) -> list[str]:
    """The same for the terminal: below each requirement a line per run."""
    lines = []
    for row in rows:
        by = "" if row.share == Outcome.NOT_JUDGED else "met by "
        lines.append(f"{row.words}, {row.limit}: {by}{row.share}")
        lines += [
            f"  {cell.verdict.value if cell.verdict is not Outcome.FAILED else 'FAILED'}"
            f"{_figures(cell, f' {row.unit}')}  ({run.name})"
            for cell, run in zip(row.cells, runs, strict=True)
            if cell is not None
        ]
    return lines


def matrix_json(rows: Sequence[MatrixRow], runs: Sequence[JudgedRun]) -> list[Json]:
    """The same as values of JSON, a list per requirement of what each run says."""
    return [
        {
            "id": row.id,
            "requirement": row.words,
            "unit": row.unit,
            "met": row.count(Outcome.MET),
            "failed": row.count(Outcome.FAILED),
            "not_judged": row.count(Outcome.NOT_JUDGED),
            "runs": [
                {
                    "run": run.name,
                    "verdict": cell.verdict.value,
                    "measured": cell.measured,
                    "limit": cell.limit,
                    "margin": cell.margin,
                }
                for cell, run in zip(row.cells, runs, strict=True)
                if cell is not None
            ],
        }
        for row in rows
    ]


# --- requirements.html: the requirements of several runs against these runs, one self-contained page

PAGE = "requirements.html"
_NOTE = (
    "Of each run the verdict (✓ met, ✗ missed), the figure that is limited, and in brackets its margin: "
    "how far it is under the limit. A run that is too short to be judged by a requirement counts neither way."
)


def judged_runs(summaries: Sequence[tuple[Path, Mapping[str, Any]]], page: Path) -> list[JudgedRun]:
    """Runs by their folders: in names that tell them apart, with the addresses of their reports."""
    names = [path.resolve().name for path, _ in summaries]
    return [
        JudgedRun(
            name if names.count(name) == 1 else str(path),
            summary["requirements"],
            quote(Path(os.path.relpath(path / run_dir.REPORT, page.parent)).as_posix()),
        )
        for (path, summary), name in zip(summaries, names, strict=True)
    ]


def write_matrix_page(path: Path, rows: Sequence[MatrixRow], runs: Sequence[JudgedRun]) -> None:
    """Write the page.

    Raises:
        HarnessError: it cannot be written.
    """
    facts = [counted(len(rows), "requirement"), counted(len(runs), "run")]
    header = PageHeader("Requirements", "Requirements against runs", facts, [_badge(rows)])
    section = PageSection("requirements", "Verdicts", _NOTE, (matrix_table(rows, runs),))
    write_result(path, sections_page(header, [section]))


def _badge(rows: Sequence[MatrixRow]) -> tuple[str, str]:
    """Whether all runs meet what they are judged by."""
    failed = sum(row.count(Outcome.FAILED) > 0 for row in rows)
    if failed:
        return "bad", f"✗ {failed} of {counted(len(rows), 'requirement')} missed by a run"
    if not any(row.count(Outcome.MET) for row in rows):
        return "note", "! not judged"
    return "good", "✓ no run misses one"
