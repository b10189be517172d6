"""The board of the Sun cells: their currents as frames."""

from collections.abc import Sequence
from math import isnan
from typing import Final

from fsw.wire.frame import Frame
from fsw.wire.messages import SunBoot, SunCells, SunHeartbeat
from hil_stub.node import Node

CELLS: Final = 6
_MOST: Final = 255.0 / 128.0
"""Range of the signals ``cell_1`` to ``cell_6``."""


class SunCellBoard:
    """Up to six Sun cells on the bus, in place of the Sun sensor.

    Args:
        tick_hz: ticks a second.
    """

    def __init__(self, tick_hz: int) -> None:
        self._node = Node(SunBoot, SunHeartbeat, tick_hz)
        self._samples = 0

    def begin_tick(self, tick: int, currents: Sequence[float], valid: bool) -> list[Frame]:
        """Enter ``tick``: ``SUN_BOOT`` at the first, ``SUN_CELLS``, ``SUN_HEARTBEAT`` every 60 s.

        A current out of range is sent as the nearest limit of the range. One that is not a number makes the
        sample invalid: all currents are then zero. A tick that does not advance is ignored.

        Args:
            tick: number of the tick that begins.
            currents: by cell, as fractions of the nominal current in full sunlight; at most six.
            valid: False when the board has failed its self-test.

        Raises:
            ValueError: more than six currents.
        """
        if len(currents) > CELLS:
            raise ValueError(f"the board has inputs for {CELLS} cells, not {len(currents)}")
        if self._node.advance(tick) is None:
            return []
        shown = [0.0] * CELLS
        for cell, current in enumerate(currents):
            valid = valid and not isnan(current)
            shown[cell] = min(max(current, 0.0), _MOST)
        first, second, third, fourth, fifth, sixth = shown if valid else [0.0] * CELLS
        sample = SunCells(int(valid), first, second, third, fourth, fifth, sixth, counter=self._samples)
        self._samples += 1
        return [*self._node.boot(), sample.encode(), *self._node.heartbeat()]
