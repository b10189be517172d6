"""The command ``torquer judge``: one flight, the rows of the fault table, or a campaign."""

import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from sim.campaign.definition.campaign import Campaign
from sim.campaign.report.verdicts import CampaignVerdict
from sim.console import answer, fail, say
from sim.errors import HarnessError
from sim.fault_table.row import FaultRow
from sim.flight.record_flight import ticks_of
from sim.judge.board import (
    BoardVerdict,
    CoilBoardUnderTest,
    board_json,
    board_page,
    board_suites,
    check_board,
    fly_with_board,
)
from sim.judge.faults import fault_cases
from sim.judge.flight import SoftwareUnderTest, fly_and_judge
from sim.judge.population import population_cases, population_verdicts
from sim.judge.render import (
    PAGE,
    VERDICT,
    failed_text,
    verdict_json,
    verdict_suites,
    verdict_text,
    write_judgement,
)
from sim.judge.series import JudgedCase, KeptFiles, SeriesCase, fly_series
from sim.judge.series_render import case_line, series_json, series_page, series_suites, tally_line
from sim.junit import write_junit
from sim.progress import note, progress
from sim.record import run_dir
from sim.report.requirements.judge import Outcome
from sim.result_files import write_result
from sim.scenario.schema import Scenario


def judge_scenario(
    software: SoftwareUnderTest,
    scenario: Scenario,
    seed: int,
    orbits: float | None,
    out: Path | None,
    junit: Path | None,
) -> int:
    """Fly one scenario against the flight software and say what is judged: the exit code.

    Raises:
        HarnessError: nothing can be flown.
        BusError: the bus cannot be used.
    """
    with progress(f"flying {scenario.name}", ticks_of(scenario, orbits)) as watch:
        flight = fly_and_judge(software, scenario, seed, out, orbits, watch)
    say(verdict_text(flight), failed=not flight.ok)
    write_judgement(flight)
    say(f"page: {flight.path / PAGE}")
    answer(verdict_json(flight) | {"page": flight.path / PAGE})
    write_junit(junit, "torquer judge", verdict_suites(flight))
    if not flight.ok:
        fail(failed_text(flight))
    return int(not flight.ok)


def judge_faults(
    software: SoftwareUnderTest,
    scenario: Scenario,
    rows: Sequence[FaultRow],
    phases: int,
    seed: int,
    out: Path | None,
    keep: KeptFiles,
    junit: Path | None,
) -> int:
    """Fly the rows of the fault table that apply, and say what is judged of each: the exit code.

    Raises:
        HarnessError: nothing can be flown.
        BusError: the bus cannot be used.
    """
    cases = list(fault_cases(scenario, rows, phases, seed))
    return _judge_series(software, f"{scenario.name}, faults", cases, scenario, out, keep, junit)


def judge_campaign(
    software: SoftwareUnderTest, campaign: Campaign, out: Path | None, keep: KeptFiles, junit: Path | None
) -> int:
    """Fly the runs of a campaign, and say what is judged of all of them: the exit code.

    Raises:
        HarnessError: nothing can be flown.
        BusError: the bus cannot be used.
    """
    cases = list(population_cases(campaign))
    first = cases[0].scenario
    assert first is not None
    return _judge_series(
        software,
        campaign.name,
        cases,
        first,
        out,
        keep,
        junit,
        lambda flown: population_verdicts(campaign, flown),
    )


def judge_board(
    board: CoilBoardUnderTest,
    scenario: Scenario,
    seconds: float | None,
    seed: int,
    out: Path | None,
    junit: Path | None,
) -> int:
    """Check a coil board, fly with it, and say what is judged: the exit code.

    Raises:
        HarnessError: nothing could be checked.
        BusError: the bus cannot be used.
    """
    folder = out or run_dir.new_folder(scenario)
    if (folder / VERDICT).exists():
        raise HarnessError(f"{folder} already holds a judgement: choose another --out")
    found = check_board(board, scenario, folder, _say_check)
    flown = fly_with_board(board, scenario, folder, seconds, seed)
    for one in flown:
        _say_check(one)
    found += flown
    command = board.command
    about = board.bus if command is None else command.text
    write_result(folder / PAGE, board_page(scenario.name, about, found))
    run_dir.write_json(folder / VERDICT, board_json(found))
    say(f"page: {folder / PAGE}")
    answer({**board_json(found), "folder": folder, "page": folder / PAGE})
    write_junit(junit, "torquer judge", board_suites(found))
    failed = [one for one in found if one.failure]
    if failed:
        more = f", and {len(failed) - 1} more" if len(failed) > 1 else ""
        fail(f"the board failed: {failed[0].name}: {failed[0].failure}{more}")
    return int(bool(failed))


def _say_check(one: BoardVerdict) -> None:
    mark = "FAILED" if one.failure else "not run" if one.skipped else "ok"
    say(f"{mark:<8}{one.name:<20} {one.failure or one.what}", failed=bool(one.failure))


def _judge_series(
    software: SoftwareUnderTest,
    name: str,
    cases: Sequence[SeriesCase],
    scenario: Scenario,
    out: Path | None,
    keep: KeptFiles,
    junit: Path | None,
    conclude: Callable[[Sequence[JudgedCase]], Sequence[CampaignVerdict]] = lambda flown: (),
) -> int:
    folder = out or run_dir.new_folder(scenario)
    if (folder / VERDICT).exists():
        raise HarnessError(f"{folder} already holds a judgement: choose another --out")
    flown = _flown(name, fly_series(software, cases, folder, keep), len(cases))
    verdicts = conclude(flown)
    for one in verdicts:
        say(f"  {one}", failed=one.met is False)
    say(tally_line(flown))
    command = software.command
    told = software.bus if command is None else command.text
    write_result(folder / PAGE, series_page(name, told, flown, verdicts))
    run_dir.write_json(folder / VERDICT, series_json(flown, verdicts))
    say(f"page: {folder / PAGE}")
    answer({**series_json(flown, verdicts), "folder": folder, "page": folder / PAGE})
    write_junit(junit, "torquer judge", series_suites(flown, verdicts))
    return _exit_code(flown, verdicts)


def _flown(name: str, judged: Iterable[JudgedCase], total: int) -> list[JudgedCase]:
    """The cases as they are judged, each said at once where no bar is shown."""
    bar = sys.stderr.isatty()
    flown = []
    with progress(f"flying {name}", total) as watch:
        for one in judged:
            flown.append(one)
            watch(len(flown))
            if not bar:
                say(case_line(one), failed=one.outcome is Outcome.FAILED)
    for one in flown if bar else ():
        say(case_line(one), failed=one.outcome is Outcome.FAILED)
    if not any(one.outcome is not Outcome.NOT_JUDGED for one in flown):
        note("note: nothing applies, so that nothing was flown")
    return flown


def _exit_code(flown: Sequence[JudgedCase], verdicts: Sequence[CampaignVerdict]) -> int:
    """1 where a verdict of the population is missed, or, where there are none, a flight is."""
    missed = [str(one) for one in verdicts if one.met is False]
    if not verdicts:
        missed = [f"{one.name}: {one.text}" for one in flown if one.outcome is Outcome.FAILED]
    if missed:
        more = f", and {len(missed) - 1} more" if len(missed) > 1 else ""
        fail(f"the flight software failed: {missed[0]}{more}")
    return int(bool(missed))
