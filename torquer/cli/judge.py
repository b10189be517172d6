"""``torquer judge``: a flight software of one's own, judged."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sim.errors import HarnessError
from torquer.cli.completions import of_buses, of_fault_rows
from torquer.cli.numbers import Number, WholeNumber
from torquer.cli.options import (
    JSON,
    JUNIT,
    SEEDS,
    SETTINGS,
    examples,
    load_scenario,
    scenario_argument,
    sentences,
)

if TYPE_CHECKING:
    from sim.judge.board import CoilBoardUnderTest

EXAMPLES = examples(
    "torquer judge microsat --flight-software './firmware {port}' --profile detumble",
    "torquer judge microsat --flight-software './firmware {port}' --faults --row mag",
    "torquer judge campaign.toml --flight-software './firmware {port}' --runs 20",
    "torquer judge microsat --bus socketcan:vcan0 --paced    # one that runs already, in real time",
)


@click.command(epilog=EXAMPLES)
@scenario_argument()
@click.option(
    "--flight-software",
    "software",
    metavar="COMMAND",
    help="Started for each flight, without a shell; {bus}, {port}, {scenario} stand for those of the flight.",
)
@click.option("--bus", shell_complete=of_buses, help="Where it runs already; with a COMMAND a loop bus.")
@click.option(
    "--profile",
    type=click.Choice(["actuator", "detumble", "attitude"]),
    default="actuator",
    show_default=True,
    help="What it gives: requests, requests that brake, its estimate too.",
)
@click.option("--pace", default="lockstep", show_default=True, help="lockstep or realtime[:FACTOR].")
@click.option("--paced", "pace", flag_value="realtime", help="In real time; a late answer is a failure.")
@click.option(
    "--answer-s",
    type=Number(0.01, 3600.0),
    default=20.0,
    show_default=True,
    help="How long to wait for an answer before the flight is given up.",
)
@click.option(
    "--boot-s",
    type=Number(0.1, 3600.0),
    default=60.0,
    show_default=True,
    help="How long to wait for its FSW_BOOT.",
)
@click.option("--orbits", type=Number(min=0.0, min_open=True), help="Default: those of the scenario.")
@click.option("--seed", type=SEEDS, help="Of all random streams. Default: 1, or a campaign's own.")
@click.option("--out", "-o", type=click.Path(path_type=Path), help="Default: runs/<scenario>-<UTC time>.")
@click.option("--faults", is_flag=True, help="Fly the rows of the fault table that apply.")
@click.option(
    "--row",
    "rows",
    multiple=True,
    metavar="NAME",
    shell_complete=of_fault_rows,
    help="With --faults: these rows alone, by their first words.",
)
@click.option("--phases", type=WholeNumber(min=1), help="With --faults: of each row. Default: 1.")
@click.option("--runs", type=WholeNumber(min=1), help="Of a campaign. Default: those of its file.")
@click.option(
    "--keep",
    type=click.Choice(["failures", "all"]),
    default="failures",
    show_default=True,
    help="Of many flights, those whose files stay.",
)
@click.option(
    "--board",
    metavar="COMMAND|BUS",
    help="Judge a coil board instead: started on a loop bus, or there already; checks, then a flight.",
)
@click.option("--arm", is_flag=True, help="With --board: let coils be driven.")
@click.option("--seconds", type=Number(1.0, 1e6), help="With --board: of the flight. Default: three pulses.")
@click.option("--deadman-s", type=Number(0.1, 3600.0), help="With --board: its dead-man. Default: 5.")
@SETTINGS
@JUNIT
@JSON
@sentences
def judge(
    scenario: str,
    software: str | None,
    bus: str | None,
    profile: str,
    pace: str,
    answer_s: float,
    boot_s: float,
    orbits: float | None,
    seed: int | None,
    out: Path | None,
    faults: bool,
    rows: tuple[str, ...],
    phases: int | None,
    runs: int | None,
    keep: str,
    board: str | None,
    arm: bool,
    seconds: float | None,
    deadman_s: float | None,
    settings: tuple[str, ...],
    junit: Path | None,
) -> int:
    """Fly SCENARIO against any flight software and judge it: rules of the bus, requirements, and why not.

    SCENARIO may be the file of a campaign: then all of its runs are flown. docs/own-firmware.md has what a
    flight software needs.
    """
    from sim.campaign.definition.campaign_file import load_campaign
    from sim.fault_table.rows.table import choose_rows
    from sim.flight.fsw_answers import Patience
    from sim.flight.node_command import parse_command
    from sim.flight.record_flight import ticks_of
    from sim.judge.command import judge_board, judge_campaign, judge_faults, judge_scenario
    from sim.judge.flight import SoftwareUnderTest
    from sim.judge.profile import Profile
    from sim.judge.series import KeptFiles
    from sim.junit import prepare_junit
    from sim.record.pace import parse_pace
    from sim.scenario.schema import parse_settings

    of_board = {"--arm": arm, "--seconds": seconds, "--deadman-s": deadman_s}
    if board is not None:
        others = {"--flight-software": software, "--bus": bus, "--faults": faults, "--orbits": orbits}
        _refuse("--board", others)
        chosen = load_scenario(scenario, settings)
        tested_board = _coil_board(board, arm, 5.0 if deadman_s is None else deadman_s)
        prepare_junit(junit)
        return judge_board(tested_board, chosen, seconds, 1 if seed is None else seed, out, junit)
    _refuse("without --board a judgement", of_board)
    if software is None and bus is None:
        raise HarnessError("which flight software? --flight-software COMMAND starts it, --bus BUS has it")
    command = None if software is None else parse_command(software, "--flight-software")
    patience = Patience(boot_s, answer_s, answer_s)
    tested = SoftwareUnderTest(command, bus or "loop", Profile(profile), parse_pace(pace), patience)
    kept = KeptFiles(keep)
    if _is_campaign(scenario):
        _refuse("a campaign", {"--faults": faults, "--row": rows, "--phases": phases})
        over = {"runs": runs, "orbits": orbits, "seed": seed}
        given = {key: value for key, value in over.items() if value is not None}
        campaign = load_campaign(scenario, given, parse_settings(settings))
        prepare_junit(junit)
        return judge_campaign(tested, campaign, out, kept, junit)
    _refuse("a scenario, which is no campaign", {"--runs": runs})
    seed = 1 if seed is None else seed
    if faults:
        _refuse("--faults", {"--orbits": orbits})
        found = choose_rows(rows, slow=True)
        chosen = load_scenario(scenario, settings)
        prepare_junit(junit)
        return judge_faults(tested, chosen, found, phases or 1, seed, out, kept, junit)
    _refuse("a flight without --faults", {"--row": rows, "--phases": phases})
    chosen = load_scenario(scenario, settings, lambda chosen: ticks_of(chosen, orbits))
    prepare_junit(junit)
    return judge_scenario(tested, chosen, seed, orbits, out, junit)


def _coil_board(board: str, arm: bool, deadman_s: float) -> "CoilBoardUnderTest":
    """The board of a command, or of a bus."""
    from fsw.bus.open_bus import resolve
    from sim.flight.node_command import parse_command
    from sim.judge.board import CoilBoardUnderTest

    if board.partition(":")[0] in ("loop", "socketcan", "slcan", "can"):
        return CoilBoardUnderTest(None, resolve(board), arm, deadman_s)
    return CoilBoardUnderTest(parse_command(board, "--board"), "loop", arm, deadman_s)


def _is_campaign(source: str) -> bool:
    """Whether the argument is the file of a campaign, which names its scenario."""
    from fsw.input.schema import read_toml

    return source.endswith(".toml") and "scenario" in read_toml(Path(source))


def _refuse(what: str, given: Mapping[str, object]) -> None:
    """Refuse options that do not belong to what is judged.

    Raises:
        HarnessError: one was given.
    """
    wrong = [option for option, value in given.items() if value]
    if wrong:
        raise HarnessError(f"{', '.join(wrong)}: {what} has no such option")
