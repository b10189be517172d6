"""Runs a flight node on a bus until the run ends or the bus is gone."""

import os
import time

from fsw.io.bus import Bus, BusClosed
from fsw.io.node import FlightNode

IDLE_S = 1.0
REPEAT_BOOT_AFTER_S = 0.5
"""A plant that asks for FSW_BOOT sooner than this has been answered by the one just sent."""


def run(node: FlightNode, bus: Bus, parent: int | None = None) -> None:
    """Send FSW_BOOT, then answer every SYNC.

    Args:
        node: the flight node.
        bus: where it lives.
        parent: process that started this one; when it is gone the run is over.
    """
    bus.send([node.start()])
    booted = time.monotonic()
    while not node.ended:
        try:
            frame = bus.receive(IDLE_S)
        except BusClosed:
            return
        if frame is None:
            if parent is not None and os.getppid() != parent:
                return
            continue
        answer = node.receive(frame)
        if answer:
            bus.send(answer)
        elif node.hears_plant_start(frame) and time.monotonic() - booted > REPEAT_BOOT_AFTER_S:
            bus.send([node.start()])
            booted = time.monotonic()
