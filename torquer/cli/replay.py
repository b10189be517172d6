"""``torquer replay``: a log replayed through the flight software, through the plant or onto a bus."""

from pathlib import Path

import click

from torquer.cli.options import RUN_OR_LOG, SETTINGS, VERIFY, sentences


@click.command()
@RUN_OR_LOG
@click.option("--scenario", help="Scenario of a bare log; default: the scenario.toml beside it.")
@click.option("--plant", is_flag=True, help="Replay the recorded commands through the plant instead.")
@click.option("--onto", metavar="BUS", help="Play the log on a bus instead, at its own pace.")
@VERIFY
@SETTINGS
@sentences
def replay(
    run_or_log: Path,
    scenario: str | None,
    plant: bool,
    onto: str | None,
    verify: Path | None,
    settings: tuple[str, ...],
) -> int:
    """Replay a log through the flight software and compare its answers byte for byte."""
    from sim.record.signature import public_key
    from sim.replay import command as commands

    key = None if verify is None else public_key(verify)
    log, run = commands.locate(run_or_log, scenario, settings, key)
    with run.binding.beside_errors():
        if onto is not None:
            return commands.play(log, run, onto)
        if plant:
            return commands.through_plant(log, run)
        return commands.through_flight_software(log, run)
