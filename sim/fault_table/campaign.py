"""Runs all cases of the chosen rows in parallel."""

from collections.abc import Callable, Sequence
from functools import partial

from sim.campaign.claim import Study
from sim.campaign.runner import StudyResult, run
from sim.campaign.study_cache import with_cache
from sim.fault_table.case import fly
from sim.fault_table.row import CaseResult, FaultRow, RowResult

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
