"""The loop bus for python-can: ``can.Bus(interface="loop", channel=PORT)``, for all of python-can's tools."""

from collections.abc import Sequence
from time import time
from typing import Any

import can

from fsw.bus.interface import DEFAULT_LOOP_PORT, BusError
from fsw.bus.link import LoopLink
from fsw.bus.open_bus import resolve
from fsw.bus.python_can import frame_of, message_of
from fsw.wire.frame import Frame


class LoopBus(can.BusABC):
    """The loop bus as a python-can backend, registered as interface ``loop``.

    It has no file descriptor to offer: one read may return many records, which are then received one by one,
    so that waiting on a descriptor would miss those that have been read already. ``can.Notifier`` then uses a
    thread.

    Args:
        channel: the hub's TCP port; None takes the default.
        **kwargs: of ``can.BusABC``.

    Raises:
        can.CanInitializationError: the bus cannot be opened.
    """

    def __init__(self, channel: int | str | None = None, **kwargs: Any) -> None:  # noqa: ANN401  (as in python-can)
        try:
            spec = resolve(f"loop:{DEFAULT_LOOP_PORT if channel is None else channel}")
            self._link = LoopLink(int(spec.removeprefix("loop:")))
        except BusError as error:
            raise can.CanInitializationError(str(error)) from error
        self.channel_info = f"loop bus on port {spec.removeprefix('loop:')}"
        super().__init__(channel=spec, **kwargs)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send one classic CAN message; ``timeout`` is not needed.

        Raises:
            can.CanOperationError: the bus is gone, or the message is not classic CAN.
        """
        if msg.is_fd:
            raise can.CanOperationError("the loop bus carries classic CAN only")
        self.send_frames((frame_of(msg),))

    def send_frames(self, frames: Sequence[Frame]) -> None:
        """Send many frames at once, in order.

        Raises:
            can.CanOperationError: the bus is gone.
        """
        try:
            self._link.send(frames)
        except BusError as error:
            raise can.CanOperationError(str(error)) from error

    def shutdown(self) -> None:
        """Leave the bus; what has been sent still reaches the others."""
        super().shutdown()
        self._link.close()

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        try:
            frame = self._link.receive(timeout)
        except BusError as error:
            raise can.CanOperationError(str(error)) from error
        return (None if frame is None else message_of(frame, time(), "loop")), False
