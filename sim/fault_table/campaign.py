"""All cases of the chosen rows, side by side on the machine's cores."""

from collections.abc import Callable, Sequence
from functools import partial

from sim.campaign.claim import Study
from sim.campaign.runner import StudyResult, run
from sim.fault_table.case import fly
from sim.fault_table.row import CaseResult, Row, RowResult

Watch = Callable[[int], None]


def fly_rows(
    rows: Sequence[Row],
    phases: int,
    seeds: int,
    workers: int,
    watch: Watch,
    report: Callable[[RowResult], None],
) -> list[RowResult]:
    """Fly every row in so many phases, each with so many seeds.

    Args:
        rows: what to fly.
        phases: of each row.
        seeds: 1 to this number, of each phase.
        workers: processes; the outcome does not depend on how many.
        watch: called with the number of cases done.
        report: called with each row when it is done.

    Returns:
        The rows in their order, with one result for each case that was asked for.
    """
    studies = [_study(row, phases, seeds) for row in rows]
    by_name = {row.name: row for row in rows}
    finished = run(studies, workers, watch, lambda done: report(_result(by_name, done)))
    return [_result(by_name, done) for done in finished]


def _study(row: Row, phases: int, seeds: int) -> Study:
    tasks = tuple(partial(fly, row, phase, seed + 1) for phase in range(phases) for seed in range(seeds))
    return Study(row.name, tasks, lambda results: [], has_flights=True)


def _result(by_name: dict[str, Row], done: StudyResult) -> RowResult:
    cases: tuple[CaseResult, ...] = done.results
    return RowResult(by_name[done.study.id], cases)
