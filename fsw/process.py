"""The flight software as a process: its node on a bus, faults as one sentence, an exit code."""

import os
import time
from collections.abc import Sequence
from contextlib import suppress

import click

from fsw.bus.interface import Bus, BusClosed, BusError
from fsw.bus.open_bus import join_bus, open_bus, resolve
from fsw.input.error_text import error_text
from fsw.input.schema import TableError
from fsw.node import End, FlightNode
from fsw.table.config import flight_config
from fsw.table.own_law import LawError
from fsw.table.table import FlightTable
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilDipole, CoilFire, WheelTorque

# --- A bench that is not armed: no request to drive a coil or a wheel reaches the bus

REQUESTS = frozenset((CoilFire.ID, CoilDipole.ID, WheelTorque.ID))


class Disarmed:
    """A :class:`fsw.bus.interface.Bus` that passes all but the requests of the flight software."""

    def __init__(self, bus: Bus) -> None:
        self.name = bus.name
        self._bus = bus

    def send(self, frames: Sequence[Frame]) -> None:
        """Send the frames that ask for no current and no torque."""
        self._bus.send([frame for frame in frames if frame.can_id not in REQUESTS])

    def receive(self, timeout_s: float | None) -> Frame | None:
        """The next frame, or None if none came within ``timeout_s``."""
        return self._bus.receive(timeout_s)

    def close(self) -> None:
        """Leave the bus."""
        self._bus.close()


# --- Runs a flight node on a bus until the run ends or the bus is gone

IDLE_S = 1.0
"""How often the parent process is checked, however busy the bus is."""
REPEAT_BOOT_AFTER_S = 0.5
"""A request for FSW_BOOT sooner than this has been answered by the one just sent."""
SILENCE_S = 5.0
"""An uncertain end counts as certain after this long without a frame."""


def run(node: FlightNode, bus: Bus, parent: int | None = None, bench: bool = False) -> None:
    """Send FSW_BOOT, then answer every SYNC; a bus that is gone ends the run.

    Args:
        node: the flight node.
        bus: the bus it is on.
        parent: process that started this one; when it is gone the run is over.
        bench: no PLANT_END ends it.
    """
    with suppress(BusClosed):
        _answer_syncs(node, bus, parent, bench)


def _answer_syncs(node: FlightNode, bus: Bus, parent: int | None, bench: bool) -> None:
    bus.send([node.start()])
    booted_s = received_s = answered_s = checked_s = time.monotonic()
    while bench or not node.ended:
        frame = bus.receive(IDLE_S)
        now_s = time.monotonic()
        if parent is not None and (frame is None or now_s - checked_s > IDLE_S):
            if os.getppid() != parent:
                return
            checked_s = now_s
        if frame is None:
            if node.end is End.DOUBTED and now_s - received_s > SILENCE_S and not bench:
                return
            continue
        received_s = now_s
        answer = node.receive(frame)
        if answer:
            bus.send(answer)
            answered_s = now_s
        elif node.is_boot_request(frame, now_s - answered_s) and now_s - booted_s > REPEAT_BOOT_AFTER_S:
            bus.send([node.start()])
            booted_s = now_s


# --- The process

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
