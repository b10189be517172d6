"""Runs a board on a bus, and logs the state of its pins."""

import os
import time
from typing import TextIO

from fsw.bus.interface import Bus
from hil_stub.bench import Bench
from hil_stub.coils.coil_driver import Pin

POLL_S = 0.5
"""How often Ctrl-C is noticed on a silent bus, where waiting cannot be interrupted."""


def now_ms() -> int:
    """A clock that never runs back [ms]."""
    return time.monotonic_ns() // 1_000_000


class PinLog:
    """Each change of the coil outputs as a line: what a logic analyser would show of a real board.

    ``1234 on 2 -3 until 4234``: since 1234 ms of this machine's monotonic clock coil 2 is on at level -3, and
    the timer that was armed with it ends that at 4234 ms. ``2345 off``: it has ended earlier, for another
    reason.

    Args:
        file: where the lines go; each is flushed at once.
    """

    def __init__(self, file: TextIO) -> None:
        self._file = file
        self._shown: Pin | None = None

    def note(self, at_ms: int, pin: Pin | None) -> None:
        """What is on at this instant."""
        if pin == self._shown:
            return
        output = "off" if pin is None else f"on {pin.coil} {pin.level}"
        timer = "" if pin is None or pin.until_ms is None else f" until {pin.until_ms}"
        self._file.write(f"{at_ms} {output}{timer}\n")
        self._file.flush()
        self._shown = pin


def run(bench: Bench, bus: Bus, pins: PinLog | None = None, parent: int | None = None) -> None:
    """Serve the bus until the process is ended.

    Args:
        bench: the board.
        bus: the bus it is on.
        pins: receives each change of the outputs.
        parent: process that started this one; when it is gone the board ends.
    """
    bus.send(bench.switch_on(now_ms=now_ms()))
    while parent is None or os.getppid() == parent:
        frame = bus.receive(_patience_s(bench.due_ms()))
        at_ms = now_ms()
        if frame is None:
            bench.watch(at_ms)
        elif answer := bench.receive(frame, at_ms):
            bus.send(answer)
        if pins is not None:
            pins.note(at_ms, bench.pin)


def _patience_s(due_ms: int | None) -> float:
    """How long to wait for a frame: until ``watch`` is due at the latest."""
    return POLL_S if due_ms is None else min(POLL_S, max(0.0, (due_ms - now_ms()) / 1000.0))
