"""The end of the loop bus of a process that serves it without a thread, whenever it sends or receives."""

import socket
from collections import deque
from collections.abc import Sequence
from time import monotonic

from fsw.bus import can_frame
from fsw.bus.hub import Hub
from fsw.bus.interface import BusClosed
from fsw.wire.frame import Frame


class HostLink:
    """A :class:`~fsw.bus.interface.Bus` whose hub is in this process: a frame takes one way, not two.

    The others wait while this node computes. That suits the plant, for whose tick all of them wait anyway.
    What they send before this end is used for the first time is not for it.

    Args:
        listener: socket on which the hub accepts clients.
        clients: connections that are on the bus from the start.
    """

    name = "loop"

    def __init__(self, listener: socket.socket, clients: Sequence[socket.socket] = ()) -> None:
        self._hub = Hub(listener)
        self.spec = f"loop:{self._hub.port}"
        self._inbox: deque[Frame] = deque()
        self._open = True
        self._used = False
        for client in clients:
            self._hub.admit(client, "a node of this flight")

    def send(self, frames: Sequence[Frame]) -> None:
        """Send all frames at once, in order."""
        records = can_frame.pack_all(frames)
        self._use()
        self._hub.send(records)

    def receive(self, timeout_s: float | None) -> Frame | None:
        """The next frame, or None if none came within ``timeout_s``."""
        if not self._inbox and not self._fill(timeout_s):
            return None
        return self._inbox.popleft()

    def close(self) -> None:
        """End the bus for all; what has been sent still reaches them."""
        if self._open:
            self._open = False
            self._hub.close()

    def _fill(self, timeout_s: float | None) -> bool:
        self._use()
        deadline = None if timeout_s is None else monotonic() + timeout_s
        left_s = timeout_s
        while True:
            self._hub.poll(None if left_s is None else max(0.0, left_s))
            if self._inbox:
                return True
            if deadline is not None and (left_s := deadline - monotonic()) <= 0.0:
                return False

    def _use(self) -> None:
        if not self._open:
            raise BusClosed(f"the bus {self.spec} is closed: this end has been closed")
        if not self._used:
            self._used = True
            self._hub.poll(0.0)
            self._hub.join(self._inbox)
