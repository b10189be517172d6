"""SocketCAN: the CAN interfaces of a Linux kernel, over the raw socket of the standard library."""

import errno
import select
import socket
import sys
from collections.abc import Sequence
from struct import pack, unpack_from
from time import monotonic, sleep

from fsw.bus import can_frame
from fsw.bus.interface import BusClosed, BusError
from fsw.wire.frame import Frame

RECEIVE_BUFFER = 32 * 2**20
"""The kernel's default holds some 278 frames and then drops silently; this holds some 80 000."""

SEND_PATIENCE_S = 0.5
"""How long to wait while the transmit queue is full: at 125 kbit/s, time for 500 frames."""

_RETRY_S = 0.0005
_CAN_RAW_ERR_FILTER = 2  # missing from the module socket before Python 3.13, like the next
_SO_RCVBUFFORCE = 33
_ALL_ERRORS = 0x1FFF_FFFF
_SIOCGIFFLAGS = 0x8913
_IFF_UP = 1


class SocketCan:
    """A :class:`fsw.bus.interface.Bus` on a CAN interface of this machine.

    Args:
        name: the interface, such as vcan0.

    Raises:
        BusError: there is no such CAN interface, or it is down.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.spec = f"socketcan:{name}"
        self._socket = _open(name)

    def send(self, frames: Sequence[Frame]) -> None:
        """Send all frames, in order; wait while the transmit queue is full, but not for ever."""
        deadline: float | None = None
        for frame in frames:
            packed = can_frame.pack(frame)
            while True:
                try:
                    self._socket.send(packed)
                    break
                except OSError as error:
                    if error.errno != errno.ENOBUFS:
                        raise self._failure(error) from error
                    deadline = deadline or monotonic() + SEND_PATIENCE_S
                    if monotonic() >= deadline:
                        full = f"the transmit queue of {self.name} stayed full for {SEND_PATIENCE_S} s"
                        raise BusError(full) from error
                sleep(_RETRY_S)

    def receive(self, timeout_s: float | None) -> Frame | None:
        """The next frame, or None if none came within ``timeout_s``."""
        try:
            try:
                received = self._socket.recv(can_frame.SIZE, socket.MSG_DONTWAIT)
            except BlockingIOError:
                left_s = None if timeout_s is None else max(0.0, timeout_s)
                if not select.select((self._socket,), (), (), left_s)[0]:
                    return None
                received = self._socket.recv(can_frame.SIZE)
        except (OSError, ValueError) as error:  # ValueError: closed on our side
            raise self._failure(error) from error
        return next(can_frame.unpack(received))

    def close(self) -> None:
        """Leave the bus."""
        self._socket.close()

    def _failure(self, error: Exception) -> BusError:
        code = error.errno if isinstance(error, OSError) else errno.EBADF
        if code == errno.ENETDOWN:
            return BusError(f"CAN interface {self.name} is down")
        if code in (errno.ENODEV, errno.ENXIO, errno.EBADF):
            return BusClosed(f"CAN interface {self.name} is gone or has been closed")
        return BusError(f"CAN interface {self.name} failed: {error}")


def interface_is_up(name: str) -> bool:
    """Whether this machine has an interface of that name, and it is up."""
    if sys.platform != "linux":
        return False
    from fcntl import ioctl  # noqa: PLC0415  (Linux only)

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        try:
            reply = ioctl(any_socket, _SIOCGIFFLAGS, pack("16s16x", name.encode()))
        except OSError:
            return False
    (flags,) = unpack_from("16xH", reply)
    return bool(flags & _IFF_UP)


def _open(name: str) -> socket.socket:
    if sys.platform != "linux":
        raise BusError("SocketCAN needs Linux: use the bus loop here")
    try:
        can = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    except OSError as error:
        raise BusError("this kernel has no SocketCAN: use the bus loop here") from error
    try:
        can.setsockopt(socket.SOL_CAN_RAW, _CAN_RAW_ERR_FILTER, _ALL_ERRORS)
        _widen(can)
        can.bind((name,))
    except OSError as error:
        can.close()
        raise BusError(f"there is no CAN interface '{name}' on this machine") from error
    if not interface_is_up(name):
        can.close()
        raise BusError(f"CAN interface {name} is down: bring it up with 'ip link set {name} up'")
    return can


def _widen(can: socket.socket) -> None:
    try:
        can.setsockopt(socket.SOL_SOCKET, _SO_RCVBUFFORCE, RECEIVE_BUFFER)
    except PermissionError:  # without CAP_NET_ADMIN: as much as the system allows
        can.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
