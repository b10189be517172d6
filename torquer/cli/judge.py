"""``torquer judge``: a user's flight software, judged."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sim.errors import HarnessError
from torquer.cli.completions import of_buses, of_fault_rows
from torquer.cli.options import (
    JSON,
    JUNIT,
    SEEDS,
    SETTINGS,
    Number,
    WholeNumber,
    examples,
    load_scenario,
    scenario_argument,
    sentences,
)

if TYPE_CHECKING:
    from sim.judge.board import BoardVerdict
    from sim.judge.series import JudgedCase

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
@click.option("--pace", help="lockstep or realtime[:FACTOR]. Default: lockstep.")
@click.option("--paced", is_flag=True, help="In real time, as --pace realtime: a late answer is a failure.")
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
    help="Judge a coil board: started on a loop bus, or there already; checks, then a flight. With "
    "--flight-software both fly and are judged, else this project's flies.",
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
    pace: str | None,
    paced: bool,
    orbits: float | None,
    faults: bool,
    board: str | None,
    settings: tuple[str, ...],
    **options: Any,  # noqa: ANN401  (as click gives them)
) -> int:
    """Fly SCENARIO against any flight software and judge it: rules of the bus, requirements, and why not.

    SCENARIO may be the file of a campaign: then all of its runs are flown. docs/own-firmware.md has what a
    flight software needs.
    """
    from sim.console import answer, fail, say
    from sim.flight.record_flight import ticks_of
    from sim.scenario.schema import Scenario, parse_settings
    from torquer.api.judge import is_campaign, judge

    if paced and pace is not None:
        raise HarnessError(f"--paced, --pace {pace}: both say how fast it is flown, give one of them")

    def ticks(chosen: Scenario) -> int:
        return ticks_of(chosen, orbits)

    campaign = board is None and is_campaign(scenario)
    one_flight = board is None and not faults
    judged = judge(
        scenario if campaign else load_scenario(scenario, settings, ticks if one_flight else None),
        pace=pace or ("realtime" if paced else "lockstep"),
        orbits=orbits,
        faults=faults,
        board=board,
        set=parse_settings(settings) if campaign else None,
        tell=_say,
        progress=True,
        **options,
    )
    for line, wrong in judged.found.lines:
        say(line, failed=wrong)
    say(f"page: {judged.page}")
    answer(judged.document)
    if not judged.ok:
        fail(judged.found.sentence)
    return int(not judged.ok)


def _say(one: "JudgedCase | BoardVerdict") -> None:
    from sim.console import say
    from sim.judge.board import BoardVerdict, board_line
    from sim.judge.series_render import case_line
    from sim.report.requirements.judge import Outcome

    if isinstance(one, BoardVerdict):
        say(board_line(one), failed=bool(one.failure))
    else:
        say(case_line(one), failed=one.outcome is Outcome.FAILED)
