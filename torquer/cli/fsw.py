"""``torquer fsw``: the flight software alone, with the onboard table of a scenario."""

import click

from torquer.cli.options import BUSES, law_and_settings, sentences


@click.command()
@click.argument("scenario", default="realsat")
@click.option("--bus", default="auto", show_default=True, help=BUSES)
@law_and_settings
@click.option("--disarmed", is_flag=True, help="Send no request to drive a coil.")
@click.option("--bench", is_flag=True, help="On a bench: PLANT_END does not end it.")
@sentences
def fsw(scenario: str, bus: str, settings: tuple[str, ...], disarmed: bool, bench: bool) -> int:
    """Fly on a bus: answer the SYNC of a plant, with the onboard table of SCENARIO."""
    from fsw.process import fly
    from sim.scenario.schema import flight_table, load, parse_settings

    return fly(flight_table(load(scenario, parse_settings(settings))), bus, disarmed, bench)
