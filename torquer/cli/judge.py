"""``torquer judge``: a flight software of one's own, judged."""

from pathlib import Path

import click

from sim.errors import HarnessError
from torquer.cli.completions import of_buses
from torquer.cli.numbers import Number
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

EXAMPLES = examples(
    "torquer judge detumble3u --flight-software './firmware {port}' --profile detumble",
    "torquer judge microsat --flight-software 'torquer fsw {scenario} --bus {bus}' --profile attitude",
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
@click.option("--seed", default=1, show_default=True, type=SEEDS, help="Of all random streams.")
@click.option("--out", type=click.Path(path_type=Path), help="Default: runs/<scenario>-<UTC time>.")
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
    seed: int,
    out: Path | None,
    settings: tuple[str, ...],
    junit: Path | None,
) -> int:
    """Fly SCENARIO against any flight software and judge it: rules of the bus, requirements, and why not."""
    from sim.flight.flight_command import parse_command
    from sim.flight.fsw_answers import Patience
    from sim.flight.record_flight import ticks_of
    from sim.judge.command import judge_scenario
    from sim.judge.flight import SoftwareUnderTest
    from sim.judge.profile import Profile
    from sim.junit import prepare_junit
    from sim.record.pace import parse_pace

    if software is None and bus is None:
        raise HarnessError(
            "which flight software? --flight-software COMMAND starts it, --bus BUS has it already"
        )
    command = None if software is None else parse_command(software, "--flight-software")
    patience = Patience(boot_s, answer_s, answer_s)
    tested = SoftwareUnderTest(command, bus or "loop", Profile(profile), parse_pace(pace), patience)
    chosen = load_scenario(scenario, settings, lambda chosen: ticks_of(chosen, orbits))
    prepare_junit(junit)
    return judge_scenario(tested, chosen, seed, orbits, out, junit)
