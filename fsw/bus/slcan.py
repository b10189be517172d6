"""Serial CAN adapters, and any other bus that python-can opens."""

from collections.abc import Sequence
from pathlib import PurePath

import can

from fsw.bus.can_message import frame_of, message_of
from fsw.bus.interface import Bus, BusClosed, BusError
from fsw.wire.frame import Frame

BITRATE = 500_000
SEND_PATIENCE_S = 5.0
"""An adapter that accepts no data for so long stands still."""


class PythonCan:
    """A :class:`fsw.bus.interface.Bus` over an open python-can bus, which ``close`` shuts down."""

    def __init__(self, bus: can.BusABC, name: str, spec: str) -> None:
        self.name = name
        self.spec = spec
        self._bus = bus
        self._open = True

    def send(self, frames: Sequence[Frame]) -> None:
        """Send all frames, in order."""
        try:
            for frame in frames:
                self._bus.send(message_of(frame), SEND_PATIENCE_S)
        except can.CanError as error:
            raise self._failure(error) from error

    def receive(self, timeout_s: float | None) -> Frame | None:
        """The next frame, or None if none came within ``timeout_s``."""
        try:
            message = self._bus.recv(None if timeout_s is None else max(0.0, timeout_s))
        except can.CanError as error:
            raise self._failure(error) from error
        return None if message is None else frame_of(message)

    def close(self) -> None:
        """Leave the bus."""
        if self._open:
            self._open = False
            self._bus.shutdown()

    def _failure(self, error: Exception) -> BusError:
        if not self._open:
            return BusClosed(f"{self.name} has been closed")
        return BusError(f"{self.name} failed: {error}")


def open_slcan(port: str) -> Bus:
    """The serial CAN adapter at ``port``, set to 500 kbit/s.

    Raises:
        BusError: pyserial is missing, or there is no adapter.
    """
    try:
        bus = can.Bus(interface="slcan", channel=port, bitrate=BITRATE)
    except can.CanInterfaceNotImplementedError as error:
        raise BusError("a serial CAN adapter needs pyserial: install it with pip install pyserial") from error
    except (can.CanError, OSError, ValueError) as error:
        raise BusError(f"there is no serial CAN adapter at {port}: {error}") from error
    return PythonCan(bus, PurePath(port).name, f"slcan:{port}")
