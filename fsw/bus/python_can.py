"""Any bus that python-can opens, with its configuration file and environment."""

import logging
import re
from collections import deque
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from time import monotonic
from typing import Any

import can

from fsw.bus.interface import Bus, BusClosed, BusError
from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame

# --- Frames as python-can's messages, and back

_FLAGS = EXTENDED_FLAG | REMOTE_FLAG | ERROR_FLAG


def message_of(frame: Frame, timestamp_s: float = 0.0, channel: str | None = None) -> can.Message:
    """The frame as python-can's message."""
    can_id, data = frame.can_id, frame.data
    remote = bool(can_id & REMOTE_FLAG)
    return can.Message(
        timestamp=timestamp_s,
        channel=channel,
        arbitration_id=can_id & ~_FLAGS,
        is_extended_id=bool(can_id & EXTENDED_FLAG),
        is_remote_frame=remote,
        is_error_frame=bool(can_id & ERROR_FLAG),
        dlc=len(data),
        data=None if remote else data,
    )


def frame_of(message: can.Message) -> Frame:
    """The message as a frame; a remote one holds as many zeros as it asks for."""
    can_id = message.arbitration_id
    if message.is_extended_id:
        can_id |= EXTENDED_FLAG
    if message.is_error_frame:
        can_id |= ERROR_FLAG
    if message.is_remote_frame:
        return Frame(can_id | REMOTE_FLAG, bytes(message.dlc))
    return Frame(can_id, bytes(message.data))


# --- A bus

SEND_PATIENCE_S = 5.0
"""An adapter that accepts no data for this long has stalled."""
IN_PROCESS = "virtual"
"""The interface of python-can that joins only nodes of the same process."""

ECHOING = frozenset({"udp_multicast"})
"""Interfaces that return a node's own frames to it, and have no option against that."""
MOST_ECHOES = 1024
"""Sent frames whose echo is awaited, at most; the oldest beyond that are forgotten as lost."""

LONGEST_NAME = 64
_FAULTS = (can.CanError, OSError, ValueError)
logging.getLogger("can").addHandler(logging.NullHandler())  # what matters of its messages is in the error


class PythonCan:
    """A :class:`fsw.bus.interface.Bus` over an open python-can bus, which ``close`` shuts down.

    Args:
        bus: of python-can.
        name: as written into logs.
        spec: the one it was opened by.
        echoes: the bus gives back what is sent on it, in order, unless it is lost.
    """

    def __init__(self, bus: can.BusABC, name: str, spec: str, echoes: bool = False) -> None:
        self.name = name
        self.spec = spec
        self._bus = bus
        self._open = True
        self._echoes: deque[Frame] = deque(maxlen=MOST_ECHOES if echoes else 0)

    def send(self, frames: Sequence[Frame]) -> None:
        """Send all frames, in order."""
        try:
            for frame in frames:
                self._bus.send(message_of(frame), SEND_PATIENCE_S)
                self._echoes.append(frame)
        except _FAULTS as error:
            raise self._failure(error) from error

    def receive(self, timeout_s: float | None) -> Frame | None:
        """The next frame of classic CAN, or None if none came within ``timeout_s``."""
        deadline = None if timeout_s is None else monotonic() + timeout_s
        while True:
            try:
                message = self._bus.recv(None if deadline is None else max(0.0, deadline - monotonic()))
            except _FAULTS as error:
                raise self._failure(error) from error
            if message is None:
                return None
            if not message.is_fd and not self._is_echo(frame := frame_of(message)):
                return frame

    def close(self) -> None:
        """Leave the bus."""
        if self._open:
            self._open = False
            self._bus.shutdown()

    def _is_echo(self, frame: Frame) -> bool:
        """Whether a frame is one that this node has sent; it and those sent before it are then forgotten."""
        if frame not in self._echoes:
            return False
        while self._echoes.popleft() != frame:
            pass
        return True

    def _failure(self, error: Exception) -> BusError:
        if not self._open:
            return BusClosed(f"{self.name} has been closed")
        return BusError(f"{self.name} failed: {error}")


def resolve_python_can(argument: str) -> str:
    """``INTERFACE:CHANNEL`` in full: what is not given is taken from python-can's configuration.

    Raises:
        BusError: no interface is given or configured, it is unknown, or joins only nodes of one process.
    """
    interface, _, channel = argument.partition(":")
    given = {key: value for key, value in (("interface", interface), ("channel", channel)) if value}
    config = _configuration(f"can:{argument}" if argument else "can", given)
    interface, chosen = str(config["interface"]), config.get("channel")
    if interface == IN_PROCESS:
        raise BusError(
            f"bus 'can:{IN_PROCESS}' joins nodes of one process: it cannot be opened by a node of its own"
        )
    return f"can:{interface}" if chosen is None else f"can:{interface}:{chosen}"


def open_python_can(spec: str) -> Bus:
    """The bus of a spec that ``resolve_python_can`` has given.

    Everything but interface and channel, such as the bit rate, is as python-can's configuration says.

    Raises:
        BusError: the interface does not open; the message is its own.
    """
    _, interface, channel = (*spec.split(":", 2), "")[:3]
    given = {"interface": interface} | ({"channel": channel} if channel else {})
    echo = _configuration(spec, given).get("receive_own_messages")
    own = {"receive_own_messages": False} if echo else {}  # a node does not receive what it sends
    try:
        bus = can.Bus(**given, **own)  # type: ignore[arg-type]  # two strings and a flag
    except Exception as error:  # of drivers by many makers: what they raise is not defined
        raise BusError(f"bus '{spec}' cannot be opened: {error}") from error
    return PythonCan(bus, _name(interface, channel), spec, echoes=interface in ECHOING)


def _configuration(spec: str, given: dict[str, str]) -> Mapping[str, Any]:
    """What is given, completed from python-can's files and environment.

    Raises:
        BusError: there is no such interface, or what they say cannot be read.
    """
    try:
        return can.util.load_config(config=dict(given))
    except Exception as error:  # of several parsers, by what files and environment hold
        known = ", ".join(sorted(can.VALID_INTERFACES))
        raise BusError(
            f"bus '{spec}': {error}: write can:INTERFACE:CHANNEL, or set python-can's CAN_INTERFACE and "
            f"CAN_CHANNEL or its file ~/.canrc; it has {known}"
        ) from None


def _name(interface: str, channel: str) -> str:
    """A name for logs: one word."""
    return re.sub(r"[^A-Za-z0-9_.:-]", "_", PurePath(channel).name)[:LONGEST_NAME] or interface


# --- Serial CAN adapters by the slcan protocol, at the bit rate of the bench

SLCAN_BITRATE = 500_000


def open_slcan(port: str) -> Bus:
    """The serial CAN adapter at ``port``, set to 500 kbit/s.

    Raises:
        BusError: pyserial is missing, or there is no adapter.
    """
    try:
        bus = can.Bus(interface="slcan", channel=port, bitrate=SLCAN_BITRATE)
    except can.CanInterfaceNotImplementedError as error:
        raise BusError("a serial CAN adapter needs pyserial: install it with pip install pyserial") from error
    except (can.CanError, OSError, ValueError) as error:
        raise BusError(f"there is no serial CAN adapter at {port}: {error}") from error
    return PythonCan(bus, PurePath(port).name, f"slcan:{port}")
