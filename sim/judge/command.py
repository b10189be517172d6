"""What ``torquer judge`` flies: one flight, the rows of the fault table, a campaign, or a coil board."""

import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from sim.campaign.definition.campaign import Campaign
from sim.campaign.report.verdicts import CampaignVerdict
from sim.errors import HarnessError
from sim.fault_table.row import FaultRow
from sim.flight.record_flight import ticks_of
from sim.judge.board import (
    BoardVerdict,
    CoilBoardUnderTest,
    board_json,
    board_line,
    board_page,
    board_suites,
    check_board,
    fly_with_board,
)
from sim.judge.faults import fault_cases
from sim.judge.flight import JudgedFlight, SoftwareUnderTest, fly_and_judge
from sim.judge.population import population_cases, population_verdicts
from sim.judge.render import (
    PAGE,
    VERDICT,
    failed_clauses,
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
from sim.value_types import Json

SUITE = "torquer judge"
Line = tuple[str, bool]
"""A line, and whether it tells of something that is wrong."""


@dataclass(frozen=True)
class OneFlight:
    """A flight that was judged."""

    flight: JudgedFlight

    @property
    def ok(self) -> bool:
        """Nothing is broken or missed."""
        return self.flight.ok

    @property
    def failures(self) -> tuple[str, ...]:
        """What is broken or missed, a clause each."""
        return tuple(failed_clauses(self.flight))

    @property
    def sentence(self) -> str:
        """All of that in a sentence; empty where nothing is."""
        return failed_text(self.flight)

    @property
    def lines(self) -> list[Line]:
        """What is said once it is judged."""
        return [(self.text, not self.ok)]

    @property
    def text(self) -> str:
        """A line for each verdict."""
        return verdict_text(self.flight)

    @property
    def page(self) -> Path:
        """The page."""
        return self.flight.path / PAGE

    @property
    def document(self) -> Json:
        """The verdicts as values."""
        return verdict_json(self.flight) | {"page": self.page}

    def write_junit(self, path: Path | None) -> None:
        """Write the verdicts as JUnit XML; None: nowhere."""
        write_junit(path, SUITE, verdict_suites(self.flight))


@dataclass(frozen=True)
class JudgedSeries:
    """Flights that were judged one after the other.

    Attributes:
        name: of the series.
        folder: of the judgement.
        flown: each case.
        verdicts: of the population; none of the rows of the fault table.
    """

    name: str
    folder: Path
    flown: Sequence[JudgedCase]
    verdicts: Sequence[CampaignVerdict]

    @property
    def ok(self) -> bool:
        """No verdict of the population is missed, or, where there are none, no flight."""
        return not self.failures

    @property
    def failures(self) -> tuple[str, ...]:
        """What is broken or missed, a clause each."""
        if self.verdicts:
            return tuple(str(one) for one in self.verdicts if one.met is False)
        return tuple(f"{one.name}: {one.text}" for one in self.flown if one.outcome is Outcome.FAILED)

    @property
    def sentence(self) -> str:
        """All of that in a sentence; empty where nothing is."""
        return _in_a_sentence("the flight software failed", self.failures)

    @property
    def lines(self) -> list[Line]:
        """What is said once all are judged."""
        return [(f"  {one}", one.met is False) for one in self.verdicts] + [(tally_line(self.flown), False)]

    @property
    def text(self) -> str:
        """A line for each flight, then those of all."""
        return "\n".join([*map(case_line, self.flown), *(line for line, _ in self.lines)])

    @property
    def page(self) -> Path:
        """The page."""
        return self.folder / PAGE

    @property
    def document(self) -> Json:
        """The verdicts as values."""
        return {**series_json(self.flown, self.verdicts), "folder": self.folder, "page": self.page}

    def write_junit(self, path: Path | None) -> None:
        """Write the verdicts as JUnit XML; None: nowhere."""
        write_junit(path, SUITE, series_suites(self.flown, self.verdicts))


@dataclass(frozen=True)
class JudgedBoard:
    """A coil board that was judged, and what flew with it.

    Attributes:
        folder: of the judgement.
        checks: each check, and what the flight shows.
    """

    folder: Path
    checks: Sequence[BoardVerdict]

    @property
    def ok(self) -> bool:
        """No check has failed."""
        return not self.failures

    @property
    def failures(self) -> tuple[str, ...]:
        """What has failed, a clause each."""
        return tuple(f"{one.name}: {one.failure}" for one in self.checks if one.failure)

    @property
    def sentence(self) -> str:
        """All of that in a sentence; empty where nothing has."""
        return _in_a_sentence("the board failed", self.failures)

    @property
    def lines(self) -> list[Line]:
        """What is said once all is judged."""
        return []

    @property
    def text(self) -> str:
        """A line for each check."""
        return "\n".join(map(board_line, self.checks))

    @property
    def page(self) -> Path:
        """The page."""
        return self.folder / PAGE

    @property
    def document(self) -> Json:
        """The verdicts as values."""
        return {**board_json(self.checks), "folder": self.folder, "page": self.page}

    def write_junit(self, path: Path | None) -> None:
        """Write the verdicts as JUnit XML; None: nowhere."""
        write_junit(path, SUITE, board_suites(self.checks))


def _in_a_sentence(head: str, clauses: Sequence[str]) -> str:
    more = f", and {len(clauses) - 1} more" if len(clauses) > 1 else ""
    return f"{head}: {clauses[0]}{more}" if clauses else ""


def judge_scenario(
    software: SoftwareUnderTest, scenario: Scenario, seed: int, orbits: float | None, out: Path | None
) -> OneFlight:
    """Fly one scenario against the flight software, and judge it.

    Raises:
        HarnessError: nothing can be flown.
        BusError: the bus cannot be used.
    """
    with progress(f"flying {scenario.name}", ticks_of(scenario, orbits)) as watch:
        flight = fly_and_judge(software, scenario, seed, out, orbits, watch)
    write_judgement(flight)
    return OneFlight(flight)


def judge_faults(
    software: SoftwareUnderTest,
    scenario: Scenario,
    rows: Sequence[FaultRow],
    phases: int,
    seed: int,
    out: Path | None,
    keep: KeptFiles,
    tell: Callable[[JudgedCase], object],
) -> JudgedSeries:
    """Fly the rows of the fault table that apply, and judge each; ``tell`` is called with it.

    Raises:
        HarnessError: nothing can be flown.
        BusError: the bus cannot be used.
    """
    cases = list(fault_cases(scenario, rows, phases, seed))
    return _judge_series(software, f"{scenario.name}, faults", cases, scenario, out, keep, tell)


def judge_campaign(
    software: SoftwareUnderTest,
    campaign: Campaign,
    out: Path | None,
    keep: KeptFiles,
    tell: Callable[[JudgedCase], object],
) -> JudgedSeries:
    """Fly the runs of a campaign, and judge each, reported by ``tell``, and all of them.

    Raises:
        HarnessError: nothing can be flown.
        BusError: the bus cannot be used.
    """
    cases = list(population_cases(campaign))
    first = cases[0].scenario
    assert first is not None

    def conclude(flown: Sequence[JudgedCase]) -> Sequence[CampaignVerdict]:
        return population_verdicts(campaign, flown)

    return _judge_series(software, campaign.name, cases, first, out, keep, tell, conclude)


def judge_board(
    board: CoilBoardUnderTest,
    software: SoftwareUnderTest | None,
    scenario: Scenario,
    seconds: float | None,
    seed: int,
    out: Path | None,
    tell: Callable[[BoardVerdict], object],
) -> JudgedBoard:
    """Check a coil board, fly with it, and judge both; ``tell`` is called with each check.

    Args:
        board: the board.
        software: flies with it, and is judged too; None: this project's flies.
        scenario: what is flown.
        seconds: of the flight; None: some pulses.
        seed: of the plant.
        out: folder of the judgement; None: a new one.
        tell: called with each check.

    Raises:
        HarnessError: nothing could be checked.
        BusError: the bus cannot be used.
    """
    folder = _new_folder(out, scenario)
    found = check_board(board, scenario, folder, tell)
    flown = fly_with_board(board, software, scenario, folder, seconds, seed)
    for one in flown:
        tell(one)
    found += flown
    command = board.command
    about = board.bus if command is None else command.text
    write_result(folder / PAGE, board_page(scenario.name, about, found))
    run_dir.write_json(folder / VERDICT, board_json(found))
    return JudgedBoard(folder, found)


def _judge_series(
    software: SoftwareUnderTest,
    name: str,
    cases: Sequence[SeriesCase],
    scenario: Scenario,
    out: Path | None,
    keep: KeptFiles,
    tell: Callable[[JudgedCase], object],
    conclude: Callable[[Sequence[JudgedCase]], Sequence[CampaignVerdict]] = lambda flown: (),
) -> JudgedSeries:
    folder = _new_folder(out, scenario)
    flown = _flown(name, fly_series(software, cases, folder, keep), len(cases), tell)
    verdicts = conclude(flown)
    command = software.command
    name_of_software = software.bus if command is None else command.text
    write_result(folder / PAGE, series_page(name, name_of_software, flown, verdicts))
    run_dir.write_json(folder / VERDICT, series_json(flown, verdicts))
    return JudgedSeries(name, folder, flown, verdicts)


def _new_folder(out: Path | None, scenario: Scenario) -> Path:
    folder = out or run_dir.new_folder(scenario)
    if (folder / VERDICT).exists():
        raise HarnessError(f"{folder} already holds a judgement: choose another --out")
    return folder


def _flown(
    name: str, judged: Iterable[JudgedCase], total: int, tell: Callable[[JudgedCase], object]
) -> list[JudgedCase]:
    """The cases as they are judged, each printed at once where no bar is shown."""
    bar = sys.stderr.isatty()
    flown = []
    with progress(f"flying {name}", total) as watch:
        for one in judged:
            flown.append(one)
            watch(len(flown))
            if not bar:
                tell(one)
    for one in flown if bar else ():
        tell(one)
    if not any(one.outcome is not Outcome.NOT_JUDGED for one in flown):
        note("note: nothing applies, so that nothing was flown")
    return flown
