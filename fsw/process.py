"""The flight software as a process: its node on a bus, faults as one sentence, an exit code."""

from contextlib import suppress

import click

from fsw.bus.disarmed import Disarmed
from fsw.bus.interface import Bus, BusClosed, BusError
from fsw.bus.open_bus import join_bus, open_bus, resolve
from fsw.input.error_text import error_text
from fsw.input.schema import TableError
from fsw.node import FlightNode
from fsw.runner import run
from fsw.table.config import flight_config
from fsw.table.own_law import LawError
from fsw.table.table import FlightTable

MOST_DISCARDED = 10_000


def fly(
    table: FlightTable,
    spec: str,
    disarmed: bool = False,
    bench: bool = False,
    parent: int | None = None,
    quiet: bool = False,
    source: str = "flight table",
    end: int | None = None,
) -> int:
    """Run the flight software on a bus until the run ends: the exit code.

    Args:
        table: the onboard table.
        spec: of the bus.
        disarmed: let no request to drive a coil get on the bus.
        bench: no PLANT_END ends it.
        parent: process that started this one; when it is gone the run is over.
        quiet: print failures only.
        source: of the table, for the sentence that says why it cannot be flown.
        end: inherited descriptor of a socket that is on the bus already.
    """
    try:
        node = FlightNode(flight_config(table, source))
        link: Bus = open_bus(spec) if end is None else join_bus(spec, end)
        link = Disarmed(link) if disarmed else link
    except (TableError, BusError) as error:
        return _failed(error, 2)
    if parent is None and not quiet:
        click.echo(f"fsw on {error_text(resolve(spec))}", err=True)
    try:
        _discard_backlog(link)
        run(node, link, parent, bench)
    except (BusError, LawError) as error:
        return _failed(error, 1)
    except KeyboardInterrupt:
        return 130
    finally:
        link.close()
    return 0


def _failed(error: Exception, exit_code: int) -> int:
    click.echo(f"fsw: {error_text(error)}", err=True)
    return exit_code


def _discard_backlog(bus: Bus) -> None:
    """Discard the frames sent before FSW_BOOT, up to a bound: other nodes may send without end."""
    with suppress(BusClosed):  # a run on it ends at once
        for _ in range(MOST_DISCARDED):
            if bus.receive(0.0) is None:
                return
