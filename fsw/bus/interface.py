"""What a bus is to a node: send frames, receive frames, leave; and what goes wrong with it."""

from collections.abc import Sequence
from typing import Protocol

from fsw.wire.frame import Frame

DEFAULT_LOOP_PORT = 28011
"""Below the ephemeral ports, so that no outgoing connection ever occupies it."""


class BusError(Exception):
    """A bus that cannot be opened or used; the message is one sentence for the user."""


class BusClosed(BusError):  # noqa: N818  (a state, not a fault: it ends every run)
    """The bus is gone, or this end of it has been closed: nothing more will come."""


class Bus(Protocol):
    """One end of a bus. It does not receive what it sends.

    Frames that are not ours (extended, remote, error) are received too and carry their SocketCAN flag in
    ``can_id``.
    """

    name: str
    """The interface as written into logs."""

    def send(self, frames: Sequence[Frame]) -> None:
        """Send all frames, in order.

        Raises:
            BusClosed: the bus is gone.
            BusError: the interface does not accept them.
        """

    def receive(self, timeout_s: float | None) -> Frame | None:
        """The next frame, or None if none came within ``timeout_s``.

        A timeout of None waits for ever; 0, or a deadline already passed, does not wait.

        Raises:
            BusClosed: the bus is gone, and all earlier frames have been returned.
            BusError: the interface failed.
        """

    def close(self) -> None:
        """Leave the bus; what has been sent still reaches the others."""
