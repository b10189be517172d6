"""Runs a flight node on a bus until the run ends or the bus is gone."""

import os
import time
from contextlib import suppress

from fsw.bus.interface import Bus, BusClosed
from fsw.node import End, FlightNode

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
