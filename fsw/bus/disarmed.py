"""A bench that is not armed: no request to drive a coil or a wheel reaches the bus."""

from collections.abc import Sequence

from fsw.bus.interface import Bus
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilDipole, CoilFire, WheelTorque

REQUESTS = frozenset((CoilFire.ID, CoilDipole.ID, WheelTorque.ID))


class Disarmed:
    """A :class:`fsw.bus.interface.Bus` that passes all but the requests of the flight software."""

    def __init__(self, bus: Bus) -> None:
        self.name = bus.name
        self._bus = bus

    def send(self, frames: Sequence[Frame]) -> None:
        """Send the frames that ask for no current and no torque."""
        self._bus.send([frame for frame in frames if frame.can_id not in REQUESTS])

    def receive(self, timeout_s: float | None) -> Frame | None:
        """The next frame, or None if none came within ``timeout_s``."""
        return self._bus.receive(timeout_s)

    def close(self) -> None:
        """Leave the bus."""
        self._bus.close()
