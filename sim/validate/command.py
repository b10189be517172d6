"""The command ``torquer validate``."""

import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from pydantic import Field, Strict

from fsw.input.schema import Section
from sim.campaign.claim import ClaimOutcome, ClaimVerdict, Study
from sim.campaign.runner import StudyResult, run
from sim.campaign.study import FlightStudy
from sim.campaign.study_cache import with_cache
from sim.console import counted
from sim.errors import HarnessError
from sim.junit import prepare_junit, write_junit
from sim.progress import note, progress
from sim.result_files import Files, check_results
from sim.validate.flight_data import claims
from sim.validate.guard import claims_of, guarded
from sim.validate.outcomes import ResultFiles, read_record
from sim.validate.page import loose, suites, tally
from sim.validate.reference import reference
from sim.validate.registry import all_studies, choose_studies, find_repository

PAGE = "validation.md"
DATA_SUFFIXES = (".csv", ".txt")

Tell = Callable[[ClaimOutcome], None]


@dataclass(frozen=True, slots=True)
class ValidationReport:
    """Claims that were checked.

    Attributes:
        outcomes: of all claims.
        page: the page; None: not written.
        figures: the outcomes beside it; None: not written.
        doubts: what of the outcomes is to be looked at, a sentence each.
        not_claimed: what recorded passes cannot show; empty where there are none.
        wall_s: how long it took.
    """

    outcomes: tuple[ClaimOutcome, ...]
    page: Path | None
    figures: Path | None
    doubts: tuple[str, ...]
    not_claimed: str
    wall_s: float

    @property
    def ok(self) -> bool:
        """No claim fails; some may not be judged."""
        return all(outcome.verdict is not ClaimVerdict.FAIL for outcome in self.outcomes)

    @property
    def tally(self) -> str:
        """How many hold, and how long it took."""
        return f"{tally(self.outcomes)}; {self.wall_s:.0f} s"


class ValidateOptions(Section):
    """What is checked of all claims.

    Attributes:
        only: first words of the ids of the studies to run; none: all.
        quick: leave out flights.
        satellites: at most so many of each population, by which claims on the median or mean of more are not
            judged; None: all.
        workers: processes; None: as many as there are cores.
        record: put the outcomes of each study that is done among those of ``validation.json``, and write the
            page of all.
    """

    only: Annotated[tuple[str, ...], Strict(False)] = ()
    quick: bool = False
    satellites: int | None = Field(default=None, ge=1)
    workers: int | None = Field(default=None, ge=1)
    record: bool = False


def validate(
    options: ValidateOptions,
    *,
    reference_files: Path | None = None,
    flight_data: Path | None = None,
    out: Path | None = None,
    junit: Path | None = None,
    tell: Tell = lambda outcome: None,
) -> ValidationReport:
    """Run the studies, tell each outcome, write the page.

    A study whose computation breaks off fails in all its claims, and the others go on. Without ``out`` only
    a complete validation, or one that is recorded, writes its page, and the outcomes beside it as
    ``validation.json``: into docs/ of the repository, else into the current directory.

    Args:
        options: what is checked.
        reference_files: run only the checks of the reference files in this folder.
        flight_data: run only the claims on the recorded passes in this folder.
        out: path of the page.
        junit: file for the verdicts as JUnit XML; None: not written.
        tell: called with each outcome once it is known; at the end, where a bar shows how far it is.

    Raises:
        HarnessError: reference data are malformed or missing, an id is unknown, or a file cannot be written.
    """
    began, satellites = time.monotonic(), options.satellites
    if options.record:
        _check_whole(reference_files, satellites)
    there_are = _studies(reference_files, flight_data, satellites)
    of_files = reference_files is not None or flight_data is not None
    whole = not (of_files or options.only or options.quick or satellites is not None)
    results = _results(out, whole, options.record, there_are)
    written = {"--out": results.page, "the outcomes": results.figures, "--junit": junit}
    check_results(written, _data_files(reference_files or flight_data))
    chosen = choose_studies(there_are, options.only, options.quick)
    prepare_junit(junit)
    passed = (HarnessError,) if of_files else ()  # the user's own files
    studies = [guarded(study, passed) for study in with_cache(chosen)]
    bar = sys.stderr.isatty()  # then the outcomes are shown after the progress bar

    def report(study: StudyResult) -> None:
        if not bar:
            _tell_each(study, tell)
        results.take(study, time.monotonic() - began)

    if whole and any(study.has_flights for study in studies):
        note("an hour or more of flights; one that is stopped goes on, --quick leaves them out")
    with progress("validating", sum(len(study.tasks) for study in studies)) as watch:
        finished = run(studies, options.workers or os.cpu_count() or 1, watch, report)
    if bar:
        for study in finished:
            _tell_each(study, tell)
    outcomes = tuple(outcome for study in finished for outcome in study.outcomes)
    if all(outcome.verdict is ClaimVerdict.ABSENT for outcome in outcomes):
        raise HarnessError(f"nothing was checked: {_why_absent(outcomes, reference_files, satellites)}")
    wall_s = time.monotonic() - began
    results.finish(finished, wall_s)
    write_junit(junit, "torquer validate", suites(finished))
    not_claimed = "" if flight_data is None else claims.NOT_CLAIMED
    doubts = tuple(_doubts(outcomes, satellites))
    return ValidationReport(outcomes, results.page, results.figures, doubts, not_claimed, wall_s)


def _tell_each(finished: StudyResult, tell: Tell) -> None:
    for outcome in finished.outcomes:
        tell(outcome)


def _doubts(outcomes: Sequence[ClaimOutcome], satellites: int | None) -> Iterator[str]:
    if far := loose(outcomes):
        yield f"own limits more than ten times off, without a reason: {', '.join(far)}"
    if few := [outcome.claim.id for outcome in outcomes if outcome.verdict is ClaimVerdict.TOO_FEW]:
        yield (
            f"{counted(len(few), 'claim')} on a median or mean not judged: made for more satellites than "
            f"--satellites {satellites} flies"
        )


def _studies(folder: Path | None, flight_data: Path | None, satellites: int | None) -> list[Study]:
    if folder is not None and flight_data is not None:
        raise HarnessError("--reference and --flight-data each run nothing else: give one of them")
    if flight_data is not None:
        return claims.studies(flight_data)
    return reference.studies(folder) if folder is not None else all_studies(satellites)


def _why_absent(outcomes: Sequence[ClaimOutcome], folder: Path | None, satellites: int | None) -> str:
    """Why no claim has data to judge by."""
    if folder is None:
        names = ", ".join(outcome.claim.id for outcome in outcomes)
        return f"--satellites {satellites} leaves none that there are claims on, of {names}"
    return f"{folder} does not hold {', '.join(outcome.claim.source for outcome in outcomes)}"


def _data_files(folder: Path | None) -> Files:
    """Tables and element sets in the user's folder, by name."""
    files = [] if folder is None or not folder.is_dir() else list(folder.iterdir())
    return {f"{file.name} of the data": file for file in files if file.suffix in DATA_SUFFIXES}


def _check_whole(folder: Path | None, satellites: int | None) -> None:
    """Refuse other outcomes than those of the project."""
    if folder is not None:
        raise HarnessError(
            "--record is for outcomes by the reference files that ship, not by those of another folder: "
            "leave out --reference"
        )
    if satellites is not None:
        raise HarnessError("--record is for outcomes of whole populations: leave out --satellites")


def _results(out: Path | None, whole: bool, record: bool, studies: Sequence[Study]) -> ResultFiles:
    page = out or (_default_page() if whole or record else None)
    figures = page.with_suffix(".json") if page is not None and (whole or record) else None
    if figures is not None and figures == page:
        raise HarnessError(f"--out {out}: the outcomes beside the page would have its name: end it in .md")
    before = read_record(figures) if record and figures is not None else None
    flown = [study for study in all_studies(None) if isinstance(study, FlightStudy)] if record else []
    claimed = frozenset(claim.id for study in flown for claim in claims_of(study))
    return ResultFiles(page, figures, frozenset(study.id for study in studies), claimed, before)


def _default_page() -> Path:
    repository = find_repository(Path.cwd())
    return Path(PAGE) if repository is None else repository / "docs" / PAGE
