"""A user's coil driver board: checked against docs/icd.md, then flown with, in real time.

Its flight software is this project's, or a user's as well.
"""

import json
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from subprocess import Popen
from typing import NamedTuple

from fsw.bus.interface import Bus
from fsw.bus.open_bus import open_bus
from fsw.wire.messages import CoilBoot, PlantBoot, intact
from sim.audit.check import check
from sim.bench.budgets import Budgets
from sim.bench.command import NUMBERS, SOFTWARE, HilSettings, hil
from sim.bench.processes import hub_of, wait_or_kill
from sim.conformance.board_link import BOARD_KINDS, BoardLink
from sim.conformance.board_under_test import BoardLimits
from sim.conformance.command import CheckResult, run_checks
from sim.conformance.pauses import PauseWatch
from sim.console import counted
from sim.drawing.page_parts import PageHeader, PageSection, Table, sections_page
from sim.errors import HarnessError
from sim.flight.node_command import NodeCommand, last_words
from sim.judge.answers import read_answers
from sim.judge.flight import SoftwareUnderTest
from sim.judge.invariants import JudgedFlightRecord, judge_invariants
from sim.junit import JunitCase
from sim.record import run_dir
from sim.record.candump import whole_entries
from sim.record.destination import check_folder
from sim.report.requirements.judge import Outcome
from sim.report.verdict import Verdict
from sim.scenario.assemble import coil_limits
from sim.scenario.schema import Scenario
from sim.value_types import Json

OUTPUT, FLIGHT = "board.log", "flight"
BOOT_S, ASK_S = 30.0, 0.5
PULSES = 3
"""For which a flight lasts long enough, where no time is given."""
NEVER_WARM_S = 1e9
"""Memory is not judged: it is this computer's."""
LATE_PART = 0.02
"""Part of the ticks in which this computer, and not the board, may have been late."""


@dataclass(frozen=True, slots=True)
class CoilBoardUnderTest:
    """A coil driver board, and how it is tested.

    Attributes:
        command: started for each test, on a loop bus of its own; None: it runs already.
        bus: on which it runs.
        armed: coils may be driven.
        deadman_s: its dead-man.
        boot_s: how long to wait for it.
    """

    command: NodeCommand | None
    bus: str
    armed: bool
    deadman_s: float = 5.0
    boot_s: float = BOOT_S


class BoardVerdict(NamedTuple):
    """A check of the board, or what a flight shows of it: ``failure`` empty: kept; ``skipped``: not run."""

    name: str
    what: str
    failure: str = ""
    skipped: str = ""


def check_board(
    board: CoilBoardUnderTest,
    scenario: Scenario,
    folder: Path,
    report: Callable[[BoardVerdict], object] = lambda verdict: None,
) -> list[BoardVerdict]:
    """Check a board against docs/icd.md, its limits being those of the scenario.

    Raises:
        HarnessError: it does not boot, or the scenario has another board.
        BusError: the bus cannot be used.
    """
    if scenario.coils.driver == "continuous":
        raise HarnessError(f"{scenario.name}: coils.driver is continuous: a pulsed board is judged")
    hz = scenario.time.tick_hz
    of_table = coil_limits(scenario.coils, hz)
    limits = BoardLimits(of_table.pulse_ms, of_table.backoff_ms, of_table.shared, board.deadman_s)
    found = []

    def take(result: CheckResult) -> None:
        skipped = "" if result.ran else "it drives coils, and nothing is armed"
        what, failure = f"{result.what}{result.times_run}", result.failure or ""
        found.append(BoardVerdict(result.name, what, failure, skipped))
        report(found[-1])

    with _running(board, scenario, folder) as bus, PauseWatch() as watch:
        link = BoardLink(bus, BOARD_KINDS["coil"], hz)
        run_checks(link, limits, board.armed, take, watch.take_longest_s)
    return found


def fly_with_board(
    board: CoilBoardUnderTest,
    software: SoftwareUnderTest | None,
    scenario: Scenario,
    folder: Path,
    seconds: float | None,
    seed: int,
) -> list[BoardVerdict]:
    """Fly in real time with a board, a flight software and this project's plant; the log is in ``FLIGHT``.

    Args:
        board: the board.
        software: is judged too; None: this project's flies.
        scenario: what is flown.
        folder: of the judgement.
        seconds: how long; None: for some pulses.
        seed: of the plant.

    Raises:
        HarnessError: a node does not boot, or the scenario does not fit a bench.
        BusError: the bus cannot be used.
    """
    coils, path = scenario.coils, folder / FLIGHT
    length_s = PULSES * (coils.pulse_s + coils.backoff_s) + 10.0 if seconds is None else seconds
    late = ceil(LATE_PART * length_s * scenario.time.tick_hz)
    budgets = Budgets(1e9, 1e9, late, 1e9, 1e9)
    with _running(board, scenario, folder) as bus:
        settings = HilSettings(
            scenario,
            _spec_of(bus, board),
            frozenset(("coil",)),
            board.armed,
            length_s,
            "plant",
            board.deadman_s,
            budgets,
            NEVER_WARM_S,
            seed,
            path,
            None if software is None else software.command,
        )
        hil(settings)
    numbers = json.loads((path / NUMBERS).read_text(encoding="utf-8"))
    verdicts = flight_verdicts(path, numbers, late, board.armed)
    return verdicts if software is None else verdicts + software_verdicts(path, scenario, software, numbers)


OF_ITS_TIME = "answers each tick"
"""The rule that a computer which is late may break in the flight software's place."""


def software_verdicts(
    path: Path, scenario: Scenario, software: SoftwareUnderTest, numbers: Json
) -> list[BoardVerdict]:
    """What a flight on the bench shows of the flight software: the rules that every one must keep.

    Args:
        path: its run directory.
        scenario: that was flown.
        software: the flight software.
        numbers: of the bench.
    """
    log = run_dir.bus_log(path)
    pulses = len(check(path, None, ticks_alone=True).pulses)
    run = run_dir.read_run(path)
    run["flight_software"] = {"command": None, "profile": software.profile.value}  # a board is beside it
    ended = numbers["ended"].get("fsw", "")
    summary = {
        "failures": {Verdict.COMPLETE.value: f"it ended before its time, {ended}"} if ended else {},
        "pulses": {"total": pulses},
    }
    answers, said = read_answers(whole_entries(log)), last_words(path / SOFTWARE)
    record = JudgedFlightRecord(scenario, software.profile, run, summary, answers, said if ended else "")
    busy = "this computer was late" if numbers["slips"] and not ended else ""
    found = []
    for one in judge_invariants(record):
        broken = one.text if one.outcome is Outcome.FAILED else ""
        unjudged = one.text if one.outcome is Outcome.NOT_JUDGED else ""
        if one.name == OF_ITS_TIME and broken and busy:
            broken, unjudged = "", busy
        found.append(BoardVerdict(f"software: {one.name}", one.text, broken, unjudged))
    return found


def flight_verdicts(path: Path, numbers: Json, late: int, armed: bool) -> list[BoardVerdict]:
    """What a flight on the bench shows of the coil board.

    Where this computer was late, as flight software and sensors show, neither the clock of the recorder nor a
    missing status says anything of the board.

    Args:
        path: its run directory.
        numbers: of the bench.
        late: the most ticks in which a sample may be missing.
        armed: coils could be driven.
    """
    missing = dict(numbers["missing_samples"])
    of_board = missing.pop("coil")
    busy = "this computer was late" if max(numbers["slips"], *missing.values()) > late else ""
    audit = check(path, None, ticks_alone=bool(busy))
    broken = str(audit.violations[0]) if audit.violations else f"no {audit.missing}" * bool(audit.missing)
    pulses = counted(len(audit.pulses), "pulse")
    idle = "" if audit.pulses else "no pulse was flown, so that nothing shows it"
    absent = f"in {counted(of_board, 'tick')} of {numbers['ticks']} there is no status" * (of_board > late)
    ended = numbers["ended"].get("coil", "")
    return [
        BoardVerdict("limits in flight", f"{pulses}, limits kept", broken),
        BoardVerdict("pulses in flight", f"{pulses} flown", idle if armed else "", idle if not armed else ""),
        BoardVerdict("in time", "a status in every tick", (ended or absent) if not busy else "", busy),
    ]


@contextmanager
def _running(board: CoilBoardUnderTest, scenario: Scenario, folder: Path) -> Iterator[Bus]:
    """The bus with the board on it, which has booted."""
    check_folder(folder)
    with hub_of(board.bus) as (spec, _):
        bus, process = open_bus(spec), None
        try:
            if board.command is not None:  # its boot message is sent once, and the bus is open for it
                process = board.command.start(spec, board_values(scenario, board.deadman_s), folder / OUTPUT)
                _await_board(bus, board.boot_s, process, folder)
            yield bus
        finally:
            bus.close()
            if process is not None:
                with suppress(ProcessLookupError):
                    process.send_signal(signal.SIGTERM)
                wait_or_kill(process)


def _spec_of(bus: Bus, board: CoilBoardUnderTest) -> str:
    return str(getattr(bus, "spec", board.bus))


def board_values(scenario: Scenario, deadman_s: float) -> dict[str, str]:
    """What the words of a board's command may name."""
    coils = scenario.coils
    limits = coil_limits(coils, scenario.time.tick_hz)
    return {
        "tick_hz": str(scenario.time.tick_hz),
        "pulse_ms": str(limits.pulse_ms),
        "backoff_ms": str(limits.backoff_ms),
        "backoff": coils.backoff,
        "levels_ma": ",".join(f"{level_ma:g}" for level_ma in coils.levels_ma),
        "deadman_ms": str(round(1000.0 * deadman_s)),
    }


def _await_board(bus: Bus, boot_s: float, process: Popen[bytes], folder: Path) -> None:
    """Wait for COIL_BOOT of a board that was started; one that booted earlier is asked for it.

    Raises:
        HarnessError: it does not come, or the board has ended.
    """
    deadline, asked = time.monotonic() + boot_s, 0.0
    while (now := time.monotonic()) < deadline:
        if process.poll() is not None:
            said = last_words(folder / OUTPUT) or "it said nothing"
            raise HarnessError(f"the board ended with exit code {process.returncode}: {said}")
        if now - asked > ASK_S:
            bus.send([PlantBoot(reason=0, version=1, table_crc=0).encode()])
            asked = now
        frame = bus.receive(0.1)
        if frame is not None and frame.can_id == CoilBoot.ID and intact(frame):
            return
    raise HarnessError(f"the board sends no COIL_BOOT within {boot_s:g} s of its start")


def board_suites(found: Sequence[BoardVerdict]) -> dict[str, list[JunitCase]]:
    """The verdicts as tests of JUnit."""
    return {"board": [JunitCase("board", one.name, 0.0, one.failure, one.skipped) for one in found]}


def board_line(one: BoardVerdict) -> str:
    """A check in a line."""
    mark = "FAILED" if one.failure else "not run" if one.skipped else "ok"
    return f"{mark:<8}{one.name:<20} {one.failure or one.what}"


def board_json(found: Sequence[BoardVerdict]) -> Json:
    """The verdicts as values."""
    return {"ok": not any(one.failure for one in found), "checks": [one._asdict() for one in found]}


def board_page(name: str, about: str, found: Sequence[BoardVerdict]) -> str:
    """The page of a board."""
    failed = sum(bool(one.failure) for one in found)
    badge = ("bad", f"✗ {failed} failed") if failed else ("good", "✓ as it should be")
    rows = [
        ("FAILED" if one.failure else "not run" if one.skipped else "kept", one.name, one.failure or one.what)
        for one in found
    ]
    table = Table(("verdict", "check", "demands, or what is wrong"), rows)
    sections = [PageSection("checks", "The coil board", tables=(table,))]
    return sections_page(PageHeader("Judgement of a board", name, (about,), [badge]), sections)
