"""Runs a flight node on a bus until the run ends or the bus is gone."""

import os
import time

from fsw.bus.interface import Bus, BusClosed
from fsw.node import End, FlightNode

IDLE_S = 1.0
"""How often a parent is looked for, whatever others say on the bus."""
REPEAT_BOOT_AFTER_S = 0.5
"""A plant that asks for FSW_BOOT sooner than this has been answered by the one just sent."""
SILENCE_S = 5.0
"""An end that is in doubt is believed when nothing has come for so long."""


def run(node: FlightNode, bus: Bus, parent: int | None = None, bench: bool = False) -> None:
    """Send FSW_BOOT, then answer every SYNC.

    Args:
        node: the flight node.
        bus: where it lives.
        parent: process that started this one; when it is gone the run is over.
        bench: no PLANT_END ends it.
    """
    bus.send([node.start()])
    booted = heard = answered = looked = time.monotonic()
    while bench or not node.ended:
        try:
            frame = bus.receive(IDLE_S)
        except BusClosed:
            return
        now = time.monotonic()
        if parent is not None and (frame is None or now - looked > IDLE_S):
            if os.getppid() != parent:
                return
            looked = now
        if frame is None:
            if node.end is End.DOUBTED and now - heard > SILENCE_S and not bench:
                return
            continue
        heard = now
        answer = node.receive(frame)
        if answer:
            bus.send(answer)
            answered = now
        elif node.is_boot_request(frame, now - answered) and now - booted > REPEAT_BOOT_AFTER_S:
            bus.send([node.start()])
            booted = now
