"""What a coil driver board has refused since it last spoke."""

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilRefused, CoilRefusedReason

MAX_REFUSALS = 64
"""Refusals named in one tick. A flood of requests is not answered by a flood of frames."""


class Refusals:
    """Collects refusals until the next tick, in which each of them is one ``COIL_REFUSED``."""

    def __init__(self) -> None:
        self._waiting: list[CoilRefused] = []
        self._count = 0

    def add(self, coil: int, seq: int, reason: CoilRefusedReason, tick: int | None) -> None:
        """Note one, under the names that the request bears; beyond ``MAX_REFUSALS`` it is passed over.

        Args:
            coil: coil that was asked for.
            seq: sequence number of the request.
            reason: why it was refused.
            tick: tick in which it came; None before the first.
        """
        if len(self._waiting) == MAX_REFUSALS:
            return
        self._waiting.append(CoilRefused(coil, seq, reason, tick or 0, counter=self._count))
        self._count += 1

    def take(self) -> list[Frame]:
        """The frames that name them, each given once."""
        frames = [message.encode() for message in self._waiting]
        self._waiting.clear()
        return frames
