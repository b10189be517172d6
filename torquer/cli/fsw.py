"""``torquer fsw``: the flight software alone, with the onboard table of a scenario."""

import click

from torquer.cli.options import (
    bus_option,
    examples,
    law_and_settings,
    load_scenario,
    scenario_argument,
    sentences,
)

EXAMPLES = examples(
    "torquer fsw microsat --bus socketcan:vcan0",
    "torquer fsw microsat --bus loop --disarmed",
)


@click.command(epilog=EXAMPLES)
@scenario_argument("realsat")
@bus_option()
@law_and_settings
@click.option("--disarmed", is_flag=True, help="Send no request to drive a coil.")
@click.option("--bench", is_flag=True, help="On a bench: PLANT_END does not end it.")
@sentences
def fsw(scenario: str, bus: str, settings: tuple[str, ...], disarmed: bool, bench: bool) -> int:
    """Fly on a bus: answer the SYNC of a plant, with the onboard table of SCENARIO."""
    from fsw.process import fly
    from sim.console import current
    from sim.scenario.schema import flight_table

    table = flight_table(load_scenario(scenario, settings))
    return fly(table, bus, disarmed, bench, quiet=current().quiet, source=f"scenario {scenario}")
