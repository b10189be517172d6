"""``torquer.judge``: a flight software or a user's coil board, flown and judged."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, Strict

from fsw.bus.open_bus import resolve
from fsw.input.own_code import refuse_while_loading
from fsw.input.schema import Nested, Section, read_toml
from hil_stub.bench import DEADMAN_MS
from sim.campaign.definition.campaign_file import load_campaign
from sim.errors import HarnessError, refuse
from sim.fault_table.rows.table import choose_rows
from sim.flight.fsw_answers import Patience
from sim.flight.node_command import parse_command
from sim.flight.record_flight import ticks_of
from sim.judge import command
from sim.judge.board import BoardVerdict, CoilBoardUnderTest
from sim.judge.command import JudgedBoard, JudgedSeries, OneFlight
from sim.judge.flight import SoftwareUnderTest
from sim.judge.profile import Profile
from sim.judge.series import JudgedCase, KeptFiles
from sim.junit import prepare_junit
from sim.progress import shown
from sim.record.pace import parse_pace
from sim.scenario.schema import Scenario, load
from sim.value_types import Json
from torquer.api.arguments import ScenarioLike, Settings, checked, laid_over, optional_path, scenario_source
from torquer.api.errors import one_sentence
from torquer.api.printed import PrintedResult
from torquer.api.run import Run

Tell = Callable[[JudgedCase | BoardVerdict], None]
"""Called with each flight of several, and with each check of a board, once it is judged."""
BUSES = ("loop", "socketcan", "slcan", "can")


class _JudgeOptions(Section):
    profile: Literal["actuator", "detumble", "attitude"]
    pace: str
    answer_s: float = Field(ge=0.01, le=3600.0)
    boot_s: float = Field(ge=0.1, le=3600.0)
    orbits: float | None = Field(gt=0.0)
    seed: int | None = Field(ge=0, le=2**64 - 1)
    faults: bool
    rows: Annotated[tuple[str, ...], Strict(False)]
    phases: int | None = Field(ge=1)
    runs: int | None = Field(ge=1)
    keep: Literal["failures", "all"]
    arm: bool
    seconds: float | None = Field(ge=1.0, le=1e6)
    deadman_s: float | None = Field(ge=0.1, le=3600.0)


@dataclass(frozen=True)
class JudgedSoftware(PrintedResult):
    """What was judged; ``print`` shows what the command prints.

    Attributes:
        found: the whole of it, as ``sim.judge`` gives it: of a flight, of several, or of a board.
    """

    found: OneFlight | JudgedSeries | JudgedBoard

    @property
    def ok(self) -> bool:
        """Nothing is broken or missed."""
        return self.found.ok

    @property
    def failures(self) -> tuple[str, ...]:
        """What is broken or missed, a clause each."""
        return self.found.failures

    @property
    def document(self) -> Json:
        """The verdicts as values, as ``--json`` gives them and ``judge.json`` holds them."""
        return self.found.document

    @property
    def page(self) -> Path:
        """The page ``judge.html``."""
        return self.found.page

    @property
    def run(self) -> Run | None:
        """The run, if one flight was judged; several, and that with a board, have folders beside the page."""
        return Run(self.found.flight.path) if isinstance(self.found, OneFlight) else None

    def __str__(self) -> str:
        return self.found.text

    def __repr__(self) -> str:
        return f"<JudgedSoftware: {'as it should be' if self.ok else self.failures[0]}>"


@one_sentence
def judge(
    scenario: ScenarioLike,
    flight_software: str | None = None,
    *,
    bus: str | None = None,
    profile: str = "actuator",
    pace: str = "lockstep",
    answer_s: float = 20.0,
    boot_s: float = 60.0,
    orbits: float | None = None,
    seed: int | None = None,
    faults: bool = False,
    rows: Sequence[str] = (),
    phases: int | None = None,
    runs: int | None = None,
    keep: str = "failures",
    board: str | None = None,
    arm: bool = False,
    seconds: float | None = None,
    deadman_s: float | None = None,
    set: Settings | None = None,
    out: str | PathLike[str] | None = None,
    junit: str | PathLike[str] | None = None,
    tell: Tell | None = None,
    progress: bool = False,
) -> JudgedSoftware:
    """Fly a scenario against any flight software and judge it, as ``torquer judge`` does.

    Args:
        scenario: a scenario, or the file of a campaign, whose runs are flown.
        flight_software: the command, started for each flight without a shell; in it ``{bus}``, ``{port}`` and
            ``{scenario}`` stand for those of the flight.
        bus: where the flight software runs already; with a command its loop bus.
        profile: what it gives: ``actuator``, ``detumble`` or ``attitude``.
        pace: ``lockstep``, or ``realtime[:FACTOR]``, in which a late answer is a failure.
        answer_s: how long to wait for an answer before the flight is given up.
        boot_s: how long to wait for its FSW_BOOT.
        orbits: how long to fly; None: as the scenario says.
        seed: of all random streams; None: 1, or a campaign's own.
        faults: fly the rows of the fault table that apply.
        rows: of them these alone, by their first words.
        phases: of each row; None: 1.
        runs: of a campaign; None: those of its file.
        keep: of several flights those whose files stay: ``failures`` or ``all``.
        board: a coil board, judged in place of a flight software or flown with it: a command, or its bus.
        arm: let that board drive its coils.
        seconds: of the flight with it; None: three pulses.
        deadman_s: its dead-man; None: that of the stub.
        set: values laid over the scenario by key.
        out: folder of the judgement; None: a new one, ``runs/<scenario>-<UTC time>``.
        junit: file for the verdicts as JUnit XML.
        tell: called with each flight of several, and with each check of a board.
        progress: show progress on stderr.

    Raises:
        InputError: an argument, or one that would do nothing; nothing was flown.
        Error: nothing can be flown.
    """
    options = checked(
        _JudgeOptions,
        "judge",
        profile=profile,
        pace=pace,
        answer_s=answer_s,
        boot_s=boot_s,
        orbits=orbits,
        seed=seed,
        faults=faults,
        rows=(rows,) if isinstance(rows, str) else rows,
        phases=phases,
        runs=runs,
        keep=keep,
        arm=arm,
        seconds=seconds,
        deadman_s=deadman_s,
    )
    refuse_while_loading("torquer.judge")
    file = optional_path(junit, "junit")
    source, over, folder = scenario_source(scenario), laid_over(set), optional_path(out, "out")
    report = tell or (lambda one: None)
    found: OneFlight | JudgedSeries | JudgedBoard
    with shown(progress):
        if board is not None:
            found = _board(board, flight_software, bus, source, over, options, folder, file, report)
        else:
            found = _software(flight_software, bus, source, over, options, folder, file, report)
        found.write_junit(file)
    return JudgedSoftware(found)


def _board(
    board: str,
    flight_software: str | None,
    bus: str | None,
    source: str | Scenario,
    over: Nested,
    options: _JudgeOptions,
    folder: Path | None,
    junit: Path | None,
    tell: Tell,
) -> JudgedBoard:
    """Check a coil board and fly with it."""
    wrong = {"--bus": bus, "--faults": options.faults, "--orbits": options.orbits}
    _refuse("--board", wrong | _of_faults(options) | {"--runs": options.runs})
    if flight_software is not None and not options.arm:
        raise HarnessError("--board with --flight-software: it drives the coils of the board, give --arm")
    deadman_s = DEADMAN_MS / 1000.0 if options.deadman_s is None else options.deadman_s
    if board.partition(":")[0] in BUSES:
        tested = CoilBoardUnderTest(None, resolve(board), options.arm, deadman_s)
    else:
        tested = CoilBoardUnderTest(parse_command(board, "--board"), "loop", options.arm, deadman_s)
    software = None if flight_software is None else _software_of(flight_software, None, options)
    scenario, seed = load(source, over), 1 if options.seed is None else options.seed
    prepare_junit(junit)
    return command.judge_board(tested, software, scenario, options.seconds, seed, folder, tell)


def _software(
    flight_software: str | None,
    bus: str | None,
    source: str | Scenario,
    over: Nested,
    options: _JudgeOptions,
    folder: Path | None,
    junit: Path | None,
    tell: Tell,
) -> OneFlight | JudgedSeries:
    """Fly a flight software: once, with the rows of the fault table, or the runs of a campaign."""
    of_board = {"--arm": options.arm, "--seconds": options.seconds, "--deadman-s": options.deadman_s}
    _refuse("without --board a judgement", of_board)
    if flight_software is None and bus is None:
        raise HarnessError("which flight software? --flight-software COMMAND starts it, --bus BUS has it")
    software, keep = _software_of(flight_software, bus, options), KeptFiles(options.keep)
    orbits = options.orbits
    if is_campaign(source):
        _refuse("a campaign", {"--faults": options.faults} | _of_faults(options))
        given = {"runs": options.runs, "orbits": orbits, "seed": options.seed}
        changed = {key: value for key, value in given.items() if value is not None}
        campaign = load_campaign(str(source), changed, over)
        prepare_junit(junit)
        return command.judge_campaign(software, campaign, folder, keep, tell)
    _refuse("a scenario, which is no campaign", {"--runs": options.runs})
    seed = 1 if options.seed is None else options.seed
    if options.faults:
        _refuse("--faults", {"--orbits": orbits})
        rows, scenario = choose_rows(options.rows, slow=True), load(source, over)
        prepare_junit(junit)
        return command.judge_faults(software, scenario, rows, options.phases or 1, seed, folder, keep, tell)
    _refuse("a flight without --faults", _of_faults(options))
    scenario = load(source, over)
    ticks_of(scenario, orbits)
    prepare_junit(junit)
    return command.judge_scenario(software, scenario, seed, orbits, folder)


def is_campaign(source: str | Scenario) -> bool:
    """Whether this is the file of a campaign, which names its scenario.

    Raises:
        TableError: the file cannot be read.
    """
    return isinstance(source, str) and source.endswith(".toml") and "scenario" in read_toml(Path(source))


def _software_of(flight_software: str | None, bus: str | None, options: _JudgeOptions) -> SoftwareUnderTest:
    started = None if flight_software is None else parse_command(flight_software, "--flight-software")
    patience = Patience(options.boot_s, options.answer_s, options.answer_s)
    return SoftwareUnderTest(
        started, bus or "loop", Profile(options.profile), parse_pace(options.pace), patience
    )


def _of_faults(options: _JudgeOptions) -> dict[str, object]:
    return {"--row": options.rows, "--phases": options.phases}


def _refuse(what: str, given: Mapping[str, object]) -> None:
    """Refuse options that do not belong to what is judged.

    Raises:
        HarnessError: one was given.
    """
    refuse(given, f"{what} has no such option")
