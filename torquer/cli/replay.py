"""``torquer replay``: a log replayed through the flight software, through the plant or onto a bus."""

from pathlib import Path

import click

from torquer.cli.completions import of_buses, of_scenarios
from torquer.cli.options import CHANNEL, JSON, LAW_AGAIN, RUN_OR_LOG, SETTINGS, VERIFY, examples, sentences

EXAMPLES = examples(
    "torquer replay runs/microsat-20250320T120000Z           # the flight software again",
    "torquer replay runs/microsat-20250320T120000Z --plant   # the plant again",
    "torquer replay candump.log --scenario microsat",
    "torquer replay candump.log --scenario microsat --onto socketcan:vcan0",
)


@click.command(epilog=EXAMPLES)
@RUN_OR_LOG
@click.option(
    "--scenario",
    shell_complete=of_scenarios,
    help="Scenario of a bare log; default: the scenario.toml beside it.",
)
@click.option("--plant", is_flag=True, help="Replay the recorded commands through the plant instead.")
@click.option(
    "--onto", metavar="BUS", shell_complete=of_buses, help="Play the log on a bus instead, at its own pace."
)
@CHANNEL
@VERIFY
@LAW_AGAIN
@click.option("--effects", is_flag=True, help="With --plant: execute the user effects of the run.")
@SETTINGS
@JSON
@sentences
def replay(
    run_or_log: Path,
    scenario: str | None,
    plant: bool,
    onto: str | None,
    channel: str | None,
    verify: Path | None,
    law: str | None,
    effects: bool,
    settings: tuple[str, ...],
) -> int:
    """Replay a log through the flight software and compare its answers byte for byte."""
    from sim.console import answer, say
    from sim.replay.command import as_json
    from sim.scenario.schema import parse_settings
    from torquer.api.replay import replay

    over = parse_settings(settings)
    report = replay(
        run_or_log,
        scenario=scenario,
        set=over,
        plant=plant,
        onto=onto,
        channel=channel,
        law=law,
        effects=effects,
        verify=verify,
        progress=True,
    )
    for line in report.lines:
        say(line, failed=not report.ok)
    answer(as_json(report))
    return int(not report.ok)
