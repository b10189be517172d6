"""The command ``torquer validate``."""

import os
import sys
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from sim.campaign.claim import ClaimVerdict, Study
from sim.campaign.runner import StudyResult, run
from sim.console import answer, say, warn
from sim.errors import HarnessError
from sim.junit import write_junit
from sim.progress import progress
from sim.record.destination import check_file
from sim.record.run_dir import replace_file
from sim.validate.flight_data import claims
from sim.validate.flight_rows import FlightRows, keep_flight, with_known
from sim.validate.outcomes import as_text, of_other_code, read_record, with_record
from sim.validate.page import as_json, line, loose, render, suites, tally
from sim.validate.reference import reference
from sim.validate.registry import all_studies, choose_studies, find_repository

PAGE = "validation.md"


def validate(
    folder: Path | None,
    only: Sequence[str],
    out: Path | None,
    quick: bool,
    workers: int | None,
    satellites: int | None = None,
    junit: Path | None = None,
    flight_data: Path | None = None,
    record: bool = False,
    keep: Path | None = None,
) -> int:
    """Run the studies, print each outcome, write the page.

    Without ``out`` only a complete validation, or one that is recorded, writes its page, and the outcomes
    beside it as ``validation.json``: into docs/ of the repository, else into the current directory.

    Args:
        folder: run only the checks of the reference files in this folder.
        only: first words of the ids of the studies to run; none: all.
        out: path of the page.
        quick: leave out flights.
        workers: processes; None: as many as there are cores.
        satellites: at most so many of each population; None: all.
        junit: file for the verdicts as JUnit XML; None: not written.
        flight_data: run only the claims on the recorded passes in this folder.
        record: put the outcomes among those of ``validation.json``, and write the page of all.
        keep: file of flights; those in it, of this code, are not flown again, and each new one is added.

    Returns:
        The exit code: 1 if a claim fails, else 0.

    Raises:
        HarnessError: reference data are malformed or missing, an id is unknown, a file cannot be written,
            or ``keep`` holds something else.
    """
    began = time.monotonic()
    repository = find_repository(Path.cwd())
    there_are = _studies(folder, flight_data, satellites)
    studies = choose_studies(there_are, only, quick)
    whole = folder is None and flight_data is None and not only and not quick and satellites is None
    page = out or (_default_page(repository) if whole or record else None)
    figures = page.with_suffix(".json") if page is not None and (whole or record) else None
    if figures is not None and figures == page:
        raise HarnessError(f"--out {out}: the outcomes beside the page would have its name: end it in .md")
    for file in filter(None, (page, junit, figures, keep)):
        check_file(file)
    rows = FlightRows(keep) if keep is not None else None
    if rows is not None:
        studies = with_known(studies, rows)
    before = read_record(figures) if record and figures is not None else {}
    bar = sys.stderr.isatty()  # then the outcomes are printed after the progress bar
    with progress("validating", sum(len(study.tasks) for study in studies)) as watch:
        finished = run(
            studies,
            workers or os.cpu_count() or 1,
            watch,
            _print_later if bar else _print,
            None if rows is None else partial(keep_flight, rows),
        )
    if bar:
        for study in finished:
            _print(study)
    outcomes = [outcome for study in finished for outcome in study.outcomes]
    if all(outcome.verdict is ClaimVerdict.ABSENT for outcome in outcomes):
        names = ", ".join(outcome.claim.source for outcome in outcomes)
        raise HarnessError(f"nothing was checked: {folder} does not hold {names}")
    wall_s = time.monotonic() - began
    known = with_record(before, finished, {study.id for study in there_are})
    if figures is not None:
        _write(figures, as_text(known))
        say(f"figures: {figures}")
    if page is not None:
        shown = [one.outcome for one in known.values()] if record else outcomes
        details = [] if record else finished  # those of a part would stand for the whole
        _write(page, render(shown, details, wall_s, of_other_code(known)))
        say(f"page: {page}")
    if junit is not None:
        write_junit(junit, "torquer validate", suites(finished))
    if far := loose(outcomes):
        warn(f"own limits more than ten times off, without a reason: {', '.join(far)}")
    if flight_data is not None:
        say(claims.NOT_CLAIMED)
    say(f"{tally(outcomes)}; {wall_s:.0f} s")
    answer({"wall_s": wall_s, "page": page, "claims": [as_json(outcome) for outcome in outcomes]})
    return int(any(outcome.verdict is ClaimVerdict.FAIL for outcome in outcomes))


def _studies(folder: Path | None, flight_data: Path | None, satellites: int | None) -> list[Study]:
    if folder is not None and flight_data is not None:
        raise HarnessError("--reference and --flight-data each run nothing else: give one of them")
    if flight_data is not None:
        return claims.studies(flight_data)
    return reference.studies(folder) if folder is not None else all_studies(satellites)


def _default_page(repository: Path | None) -> Path:
    return Path(PAGE) if repository is None else repository / "docs" / PAGE


def _print(finished: StudyResult) -> None:
    for outcome in finished.outcomes:
        say(line(outcome), failed=outcome.verdict is ClaimVerdict.FAIL)


def _print_later(finished: StudyResult) -> None:
    """Print nothing yet."""


def _write(page: Path, text: str) -> None:
    try:
        page.parent.mkdir(parents=True, exist_ok=True)
        replace_file(page, text.encode())  # outcomes of hours are not lost by a kill
    except OSError as error:
        raise HarnessError(f"{page}: cannot be written ({error.strerror})") from None
