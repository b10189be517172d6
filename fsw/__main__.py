"""``python -m fsw``: the flight software as a process on a bus."""

import sys

import click

from fsw.bus.disarmed import Disarmed
from fsw.bus.interface import Bus, BusError
from fsw.bus.open_bus import open_bus, resolve
from fsw.input import command_line
from fsw.input.schema import TableError
from fsw.input.sentence import sentence
from fsw.node import FlightNode
from fsw.runner import run
from fsw.table.config import flight_config
from fsw.table.table import FlightTable, load_flight_table

MOST_PASSED_OVER = 10_000


def _table(scenario: str | None, table: str | None, settings: tuple[str, ...]) -> FlightTable:
    if scenario is None:
        return load_flight_table(table)
    from sim.harness.scenario import flight_table, load, parse_settings  # noqa: PLC0415  (not there on a target)

    return flight_table(load(scenario, parse_settings(settings)))


def _pass_over(bus: Bus) -> None:
    """What was sent before FSW_BOOT does not count; not all of it, if others babble without end."""
    for _ in range(MOST_PASSED_OVER):
        if bus.receive(0.0) is None:
            return


@click.command()
@click.argument("scenario", required=False)
@click.option("--table", metavar="FILE", help="Onboard table to fly without a scenario.")
@click.option(
    "--bus", default="auto", show_default=True, help="auto, loop[:PORT], socketcan:NAME, slcan:PORT."
)
@click.option("--set", "settings", multiple=True, metavar="KEY=VALUE", help="Override a scenario's key.")
@click.option("--disarmed", is_flag=True, help="Let no request to drive a coil get on the bus.")
@click.option("--bench", is_flag=True, help="On a bench: no PLANT_END ends it.")
@click.option("--parent", type=int, hidden=True)
def main(
    scenario: str | None,
    table: str | None,
    bus: str,
    settings: tuple[str, ...],
    disarmed: bool,
    bench: bool,
    parent: int | None,
) -> None:
    """Fly on a bus: answer the SYNC of a plant, as SCENARIO or an onboard table says."""
    try:
        node = FlightNode(flight_config(_table(scenario, table, settings)))
        link: Bus = open_bus(bus)
        link = Disarmed(link) if disarmed else link
    except (TableError, BusError) as error:
        click.echo(f"fsw: {sentence(error)}", err=True)
        sys.exit(2)
    if parent is None:
        click.echo(f"fsw on {resolve(bus)}", err=True)
    try:
        _pass_over(link)
        run(node, link, parent, bench)
    except BusError as error:
        click.echo(f"fsw: {sentence(error)}", err=True)
        sys.exit(1)
    except KeyboardInterrupt:
        sys.exit(130)
    finally:
        link.close()


if __name__ == "__main__":
    sys.exit(command_line.run(main, "fsw"))
