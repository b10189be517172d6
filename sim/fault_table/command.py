"""The command ``torquer faults``."""

import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from sim.campaign.claim import Study
from sim.campaign.runner import StudyResult, run
from sim.campaign.study_cache import with_cache
from sim.console import answer, say
from sim.errors import HarnessError
from sim.fault_table import render
from sim.fault_table.case import fly
from sim.fault_table.row import CaseResult, CheckVerdict, FaultRow, RowResult
from sim.fault_table.rows.table import ROWS, choose_rows
from sim.junit import prepare_junit, write_junit
from sim.progress import progress
from sim.result_files import check_results, write_result
from sim.validate.registry import find_repository

# --- The flights

Watch = Callable[[int], None]


def fly_rows(
    rows: Sequence[FaultRow],
    phases: int,
    seeds: int,
    workers: int,
    watch: Watch,
    report: Callable[[RowResult], None],
) -> list[RowResult]:
    """Fly every row in all phases, each with all seeds.

    Args:
        rows: rows of the table.
        phases: number of phases of each row.
        seeds: number of seeds of each phase, from 1 on.
        workers: processes; the outcome does not depend on their number.
        watch: called with the number of cases done.
        report: called with each row when it is done.

    Returns:
        The rows in their order, with one result for each case.
    """
    studies = with_cache([_study(row, phases, seeds) for row in rows])
    by_name = {row.name: row for row in rows}
    finished = run(studies, workers, watch, lambda done: report(_result(by_name, done)))
    return [_result(by_name, done) for done in finished]


def _study(row: FaultRow, phases: int, seeds: int) -> Study:
    tasks = tuple(partial(fly, row, phase, seed + 1) for phase in range(phases) for seed in range(seeds))
    return Study(row.name, tasks, lambda results: [], has_flights=True)


def _result(by_name: dict[str, FaultRow], done: StudyResult) -> RowResult:
    cases: tuple[CaseResult, ...] = done.results
    return RowResult(by_name[done.study.id], cases)


# --- The command

PAGE, JUNIT, HTML, JSON = "faults.md", "faults.xml", "faults.html", "faults.json"


def list_rows(names: Sequence[str]) -> int:
    """Print the rows."""
    for row in choose_rows(names, slow=True):
        say(render.listed(row))
    answer({"rows": [render.listed_json(row) for row in choose_rows(names, slow=True)]})
    return 0


def faults(
    names: Sequence[str],
    phases: int,
    seeds: int,
    out: Path | None,
    workers: int | None,
    write_docs: bool,
    slow: bool = False,
    junit: Path | None = None,
) -> int:
    """Fly the rows, print each result, write the requested files.

    Args:
        names: of rows, or first words of names; none: all.
        phases: of each row.
        seeds: of each phase.
        out: folder for faults.xml, faults.html and faults.json; None: not written.
        workers: processes; None: one per core.
        slow: include rows that run real processes.
        write_docs: write docs/faults.md of the repository.
        junit: file for the verdicts as JUnit XML; None: not written.

    Returns:
        The exit code: 1 if an expectation is violated, otherwise 0.

    Raises:
        HarnessError: there is no such row, or a file cannot be written.
    """
    rows = choose_rows(names, slow)
    page = _docs_page({row.name for row in rows}) if write_docs else None
    beside = {f"{name} of --out": out / name for name in (JUNIT, HTML, JSON)} if out is not None else {}
    check_results({"the page": page, **beside, "--junit": junit}, {})
    prepare_junit(junit)
    bar = sys.stderr.isatty()  # then the rows are printed after it

    def report(result: RowResult) -> None:
        if not bar:
            _print(result)

    with progress("injecting faults", len(rows) * phases * seeds) as watch:
        results = fly_rows(rows, phases, seeds, workers or os.cpu_count() or 1, watch, report)
    for result in results if bar else ():
        _print(result)
    say(render.tally(results))
    answer(render.json_values(results))
    _write_reports(results, out, junit)
    if page is not None:
        write_result(page, render.markdown(results, phases, seeds))
        say(f"page: {page}")
    return int(any(result.verdict is CheckVerdict.FAIL for result in results))


def _write_reports(results: Sequence[RowResult], out: Path | None, junit: Path | None) -> None:
    for file in (junit, None if out is None else out / JUNIT):
        write_junit(file, "torquer faults", render.suites(results))
    if out is not None:
        write_result(out / HTML, render.html(results))
        write_result(out / JSON, render.as_json(results))


def _docs_page(names: set[str]) -> Path:
    repository = find_repository(Path.cwd())
    if repository is None:
        raise HarnessError("--write-docs: this is no checkout of torquer, so that there is no docs/faults.md")
    if not names >= {row.name for row in ROWS if not row.slow}:
        raise HarnessError("--write-docs: the page is of all rows: leave out --row")
    return repository / "docs" / PAGE


def _print(result: RowResult) -> None:
    say(render.line(result), failed=result.verdict is CheckVerdict.FAIL)
