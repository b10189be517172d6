"""The command ``torquer faults``."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path

import click

from sim.errors import HarnessError
from sim.fault_table import earlier_rows, render
from sim.fault_table.campaign import fly_rows
from sim.fault_table.row import CheckVerdict, RowResult
from sim.fault_table.rows import ROWS, choose_rows
from sim.progress import progress
from sim.record.destination import check_file, check_folder
from sim.validate.registry import find_repository

PAGE, JUNIT, HTML, JSON = "faults.md", "faults.xml", "faults.html", "faults.json"


def list_rows(names: Sequence[str]) -> int:
    """Print the rows."""
    for row in choose_rows(names, slow=True):
        click.echo(render.listed(row))
    return 0


def faults(
    names: Sequence[str],
    phases: int,
    seeds: int,
    as_json: bool,
    out: Path | None,
    workers: int | None,
    write_docs: bool,
    slow: bool = False,
    keep: Path | None = None,
) -> int:
    """Fly the rows, print each result, write the requested files.

    Args:
        names: of rows, or first words of names; none: all.
        phases: of each row.
        seeds: of each phase.
        as_json: print JSON alone.
        out: folder for faults.xml, faults.html and faults.json; None: not written.
        workers: processes; None: one a core.
        slow: include rows that run real processes.
        keep: faults.json of an earlier campaign, for the rows that are not in this one.
        write_docs: write docs/faults.md of the repository.

    Returns:
        The exit code: 1 if an expectation is violated, else 0.

    Raises:
        HarnessError: there is no such row, or a file cannot be written.
    """
    rows = choose_rows(names, slow)
    earlier = {} if keep is None else earlier_rows.read(keep)
    page = _docs_page({*earlier, *(row.name for row in rows)}) if write_docs else None
    if page is not None:
        check_file(page)
    if out is not None:
        check_folder(out, (JUNIT, HTML, JSON))
    quiet = as_json or sys.stderr.isatty()  # then the rows are printed after the progress bar
    count = len(rows) * phases * seeds
    with progress("injecting faults", count) as watch:
        results = fly_rows(
            rows, phases, seeds, workers or os.cpu_count() or 1, watch, _print_later if quiet else _print
        )
    by_name = earlier | {result.row.name: result for result in results}
    results = [by_name[row.name] for row in ROWS if row.name in by_name]
    if as_json:
        click.echo(render.as_json(results))
    else:
        for result in results if quiet else ():
            _print(result)
        click.echo(render.tally(results))
    if out is not None:
        _write(out / JUNIT, render.junit(results))
        _write(out / HTML, render.html(results))
        _write(out / JSON, render.as_json(results))
    if page is not None:
        _write(page, render.markdown(results, phases, seeds))
        click.echo(f"page: {page}", err=as_json)
    return int(any(result.verdict is CheckVerdict.FAIL for result in results))


def _docs_page(names: set[str]) -> Path:
    repository = find_repository(Path.cwd())
    if repository is None:
        raise HarnessError("--write-docs: this is no checkout of torquer, so that there is no docs/faults.md")
    if not names >= {row.name for row in ROWS if not row.slow}:
        raise HarnessError("--write-docs: the page is of all rows: leave out --row, or --keep the others")
    return repository / "docs" / PAGE


def _print(result: RowResult) -> None:
    click.echo(render.line(result))


def _print_later(result: RowResult) -> None:
    """Print nothing yet."""


def _write(path: Path, text: str) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise HarnessError(f"{path}: cannot be written ({error.strerror})") from None
