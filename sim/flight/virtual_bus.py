"""The virtual bus: plant and flight software in one process, the same frames in an in-process queue."""

import time
from collections import deque
from collections.abc import Sequence

from mypy_extensions import mypyc_attr

from fsw.node import FlightNode
from fsw.wire.frame import Frame


@mypyc_attr(allow_interpreted_subclasses=True)
class VirtualBus:
    """The plant's end of a bus whose only other node is the flight software, which answers at once."""

    name = "virtual"

    def __init__(self, node: FlightNode) -> None:
        self._node = node
        self._queue: deque[Frame] = deque((node.start(),))

    def send(self, frames: Sequence[Frame]) -> None:
        """Hand the frames to the flight software; its answers wait in the queue."""
        for frame in frames:
            self._queue.extend(self._node.receive(frame))

    def receive(self, timeout_s: float | None) -> Frame | None:
        """The next answer, or None once the time has passed: nothing comes until something is sent."""
        if self._queue:
            return self._queue.popleft()
        if timeout_s:
            time.sleep(timeout_s)
        return None

    def close(self) -> None:
        """Nothing to release."""
