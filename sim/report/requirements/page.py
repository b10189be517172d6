"""requirements.html: the requirements of several runs against these runs, one self-contained page."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from sim.console import counted
from sim.drawing.page_parts import PageHeader, PageSection, sections_page
from sim.record import run_dir
from sim.report.requirements.judge import Outcome
from sim.report.requirements.matrix import JudgedRun, MatrixRow, matrix_table
from sim.result_files import write_result

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
