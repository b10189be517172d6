"""The command ``torquer validate``."""

import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from sim.campaign.claim import ClaimOutcome, ClaimVerdict, Study
from sim.campaign.runner import StudyResult, run
from sim.campaign.study import FlightStudy
from sim.console import answer, counted, say, warn
from sim.errors import HarnessError
from sim.junit import prepare_junit, write_junit
from sim.progress import note, progress
from sim.result_files import Files, check_results
from sim.validate.flight_data import claims
from sim.validate.flight_rows import FlightRows, keep_flight, with_kept_flights
from sim.validate.outcomes import read_record
from sim.validate.page import as_json, line, loose, suites, tally
from sim.validate.reference import reference
from sim.validate.registry import all_studies, choose_studies, find_repository, judging_digests
from sim.validate.running.guard import claims_of, guarded
from sim.validate.running.kept_results import keep_result, with_kept_results
from sim.validate.running.recorded import recorded_studies
from sim.validate.running.results import ResultFiles

PAGE = "validation.md"
DATA_SUFFIXES = (".csv", ".txt")


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
    recorded: Path | None = None,
) -> int:
    """Run the studies, print each outcome, write the page.

    A study whose computation breaks off fails in all its claims, and the others go on. Without ``out`` only
    a complete validation, or one that is recorded, writes its page, and the outcomes beside it as
    ``validation.json``: into docs/ of the repository, else into the current directory.

    Args:
        folder: run only the checks of the reference files in this folder.
        only: first words of the ids of the studies to run; none: all.
        out: path of the page.
        quick: leave out flights.
        workers: processes; None: as many as there are cores.
        satellites: at most so many of each population, by which claims on the median or mean of more are not
            judged; None: all.
        junit: file for the verdicts as JUnit XML; None: not written.
        flight_data: run only the claims on the recorded passes in this folder.
        record: put the outcomes of each study that is done among those of ``validation.json``, and write the
            page of all.
        keep: file of flights; those in it, of this code, are not flown again, and each new one is added.
        recorded: file of outcomes; those in it of flights that this code has flown and judged count.

    Returns:
        The exit code: 1 if a claim fails, else 0, also where some are not judged, which is said.

    Raises:
        HarnessError: reference data are malformed or missing, an id is unknown, a file cannot be written,
            ``keep`` or ``recorded`` holds something else, or there are no such outcomes.
    """
    began = time.monotonic()
    for option, given in (("--record", record), ("--recorded", recorded)):
        if given:
            _check_whole(option, folder, satellites)
    there_are = _studies(folder, flight_data, satellites)
    whole = folder is None and flight_data is None and not only and not quick and satellites is None
    results = _results(out, whole, record, there_are)
    written = {"--out": results.page, "the outcomes": results.figures, "--keep": keep, "--junit": junit}
    check_results(written, {**_data_files(folder or flight_data), **_read_only(recorded, results.figures)})
    known = {} if recorded is None else _recorded(recorded, there_are)
    studies = choose_studies(there_are, only, quick, known)
    if recorded is not None and quick:
        _tell_left_out(choose_studies(there_are, only, False, known), studies)
    prepare_junit(junit)
    rows = FlightRows(keep) if keep is not None else None
    if rows is not None:
        studies = with_kept_results(with_kept_flights(studies, rows), rows)
    passed = (HarnessError,) if folder is not None or flight_data is not None else ()  # the user's own files
    studies = [guarded(study, passed) for study in studies]
    bar = sys.stderr.isatty()  # then the outcomes are printed after the progress bar

    def report(study: StudyResult) -> None:
        if not bar:
            _print(study)
        results.take(study, time.monotonic() - began)

    if whole and keep is None and any(study.has_flights and study.tasks for study in studies):
        note("some hours of flights; with --keep FILE one that is stopped goes on, --quick leaves them out")
    with progress("validating", sum(len(study.tasks) for study in studies)) as watch:
        finished = run(studies, workers or os.cpu_count() or 1, watch, report, _keeper(rows))
    if bar:
        for study in finished:
            _print(study)
    outcomes = [outcome for study in finished for outcome in study.outcomes]
    if all(outcome.verdict is ClaimVerdict.ABSENT for outcome in outcomes):
        raise HarnessError(f"nothing was checked: {_why_absent(outcomes, folder, satellites)}")
    wall_s = time.monotonic() - began
    results.finish(finished, wall_s)
    write_junit(junit, "torquer validate", suites(finished))
    if far := loose(outcomes):
        warn(f"own limits more than ten times off, without a reason: {', '.join(far)}")
    if few := [outcome.claim.id for outcome in outcomes if outcome.verdict is ClaimVerdict.TOO_FEW]:
        warn(
            f"{counted(len(few), 'claim')} on a median or mean not judged: made for more satellites than "
            f"--satellites {satellites} flies"
        )
    if flight_data is not None:
        say(claims.NOT_CLAIMED)
    say(f"{tally(outcomes)}; {wall_s:.0f} s")
    answer({"wall_s": wall_s, "page": results.page, "claims": [as_json(outcome) for outcome in outcomes]})
    return int(any(outcome.verdict is ClaimVerdict.FAIL for outcome in outcomes))


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


def _read_only(recorded: Path | None, figures: Path | None) -> Files:
    """The record, where the new one is not to take its place."""
    replaced = recorded is None or (figures is not None and figures.resolve() == recorded.resolve())
    return {} if replaced else {"--recorded": recorded}


def _check_whole(option: str, folder: Path | None, satellites: int | None) -> None:
    """Refuse other outcomes than those of the project."""
    if folder is not None:
        raise HarnessError(
            f"{option} is for outcomes by the reference files that ship, not by those of another folder: "
            "leave out --reference"
        )
    if satellites is not None:
        raise HarnessError(f"{option} is for outcomes of whole populations: leave out --satellites")


def _recorded(path: Path, studies: Sequence[Study]) -> dict[str, Study]:
    """The studies with recorded outcomes, by their ids."""
    if not path.exists():
        raise HarnessError(f"--recorded {path}: no such file; --record writes one")
    known = recorded_studies(studies, read_record(path), judging_digests())
    flown = sum(len(study.tasks) for study in studies if study.id in known)
    note(f"{path}: {counted(flown, 'flight')} that this code has flown and judged, not flown again")
    return known


def _results(out: Path | None, whole: bool, record: bool, studies: Sequence[Study]) -> ResultFiles:
    page = out or (_default_page() if whole or record else None)
    figures = page.with_suffix(".json") if page is not None and (whole or record) else None
    if figures is not None and figures == page:
        raise HarnessError(f"--out {out}: the outcomes beside the page would have its name: end it in .md")
    before = read_record(figures) if record and figures is not None else None
    flown = [study for study in all_studies(None) if isinstance(study, FlightStudy)] if record else []
    claimed = {claim.id: claim for study in flown for claim in claims_of(study)}
    ids = frozenset(study.id for study in studies)
    judges = judging_digests() if any(study.has_flights for study in studies) else {}
    return ResultFiles(page, figures, ids, judges, claimed, before)


def _tell_left_out(meant: Sequence[Study], chosen: Sequence[Study]) -> None:
    """Name the studies that ``--quick`` leaves out, although a record was to stand for their flights."""
    there = {study.id for study in chosen}
    if missing := [study.id for study in meant if study.id not in there]:
        warn(f"left out by --quick, as this code has not flown or judged them: {', '.join(missing)}")


def _keeper(rows: FlightRows | None) -> Callable[[object], None] | None:
    """What keeps a result; None where none is kept."""
    if rows is None:
        return None

    def keep(result: object) -> None:
        keep_flight(rows, result)
        keep_result(rows, result)

    return keep


def _default_page() -> Path:
    repository = find_repository(Path.cwd())
    return Path(PAGE) if repository is None else repository / "docs" / PAGE


def _print(finished: StudyResult) -> None:
    for outcome in finished.outcomes:
        say(line(outcome), failed=outcome.verdict is ClaimVerdict.FAIL)
