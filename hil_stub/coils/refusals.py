"""The requests that a coil driver board has refused since its last tick."""

from typing import Final

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilRefused, CoilRefusedReason

MAX_REFUSALS: Final = 64
"""Refusals reported in one tick. A flood of requests is not answered by a flood of frames."""


class Refusals:
    """Collects refusals until the next tick, in which each of them is one ``COIL_REFUSED``."""

    def __init__(self) -> None:
        self._waiting: list[CoilRefused] = []
        self._count = 0

    def add(self, coil: int, seq: int, reason: CoilRefusedReason, tick: int | None) -> None:
        """Note one, with coil and number of the request; beyond ``MAX_REFUSALS`` it is dropped.

        Args:
            coil: of the request.
            seq: sequence number of the request.
            reason: why it was refused.
            tick: tick in which it came; None before the first.
        """
        if len(self._waiting) == MAX_REFUSALS:
            return
        self._waiting.append(CoilRefused(coil, seq, reason, tick or 0, counter=self._count))
        self._count += 1

    def take(self) -> list[Frame]:
        """Their frames, each returned once."""
        frames = [message.encode() for message in self._waiting]
        self._waiting.clear()
        return frames
