"""``torquer replay``: a log flown again."""

from pathlib import Path

import click

from torquer.cli.options import RUN_OR_LOG, SETTINGS, VERIFY, sentences


@click.command()
@RUN_OR_LOG
@click.option("--scenario", help="What a bare log was flown with; default the scenario.toml beside it.")
@click.option("--plant", is_flag=True, help="Put the recorded commands through the plant instead.")
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
    """Refly a log through the flight software and compare byte for byte."""
    from sim.record.signature import public_key
    from sim.replay import command as commands

    key = None if verify is None else public_key(verify)
    log, chosen = commands.locate(run_or_log, scenario, settings, key)
    with chosen.binding.beside_errors():
        if onto is not None:
            return commands.play(log, chosen, onto)
        if plant:
            return commands.through_plant(log, chosen)
        return commands.through_flight_software(log, chosen)
