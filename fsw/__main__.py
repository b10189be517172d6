"""``python -m fsw``: the flight software as a process on a bus."""

import sys

import click

from fsw.bus.open_bus import KINDS
from fsw.input import command_line
from fsw.input.error_text import error_text
from fsw.input.schema import TableError
from fsw.process import fly
from fsw.table.table import load_flight_table


@click.command()
@click.option("--table", metavar="FILE", help="Onboard table to fly; default the one that ships.")
@click.option("--bus", default="auto", show_default=True, help=f"auto, {KINDS}.")
@click.option("--disarmed", is_flag=True, help="Let no request to drive a coil get on the bus.")
@click.option("--bench", is_flag=True, help="On a bench: no PLANT_END ends it.")
@click.option("--parent", type=int, hidden=True)
@click.option("--end", type=int, hidden=True)
def main(
    table: str | None, bus: str, disarmed: bool, bench: bool, parent: int | None, end: int | None
) -> None:
    """Run the flight software on a bus: answer each SYNC of a plant, by an onboard table."""
    try:
        loaded = load_flight_table(table)
    except TableError as error:
        click.echo(f"fsw: {error_text(error)}", err=True)
        sys.exit(2)
    sys.exit(fly(loaded, bus, disarmed, bench, parent, source=table or "flight table", end=end))


if __name__ == "__main__":
    sys.exit(command_line.run(main, "fsw"))
