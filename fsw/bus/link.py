"""One end of the loop bus: a TCP connection to the hub, which the first process to open it hosts."""

import atexit
import select
import socket
from collections import deque
from collections.abc import Sequence
from time import monotonic, sleep

from fsw.bus import can_frame
from fsw.bus.hub import Hub
from fsw.bus.hub_listener import FULL, GREETING, HOST
from fsw.bus.interface import DEFAULT_LOOP_PORT, BusClosed, BusError
from fsw.wire.frame import Frame

_RETRY_S = 0.01
_PARTING_S = 1.0
SEND_PATIENCE_S = 20.0
"""A hub that accepts no data for this long has stalled."""
_CHUNK = 2**16


class LoopLink:
    """A :class:`~fsw.bus.interface.Bus` on the loop bus of ``port``. Once open, it misses nothing.

    If no hub serves the port, this process hosts one, in a daemon thread, until ``close``: that ends the bus
    for all.

    Args:
        port: the hub's TCP port on 127.0.0.1.
        timeout_s: how long to try.
        may_host: whether to host the hub if there is none.
        end: a socket that is on the bus already; None: connect to the port.

    Raises:
        BusError: no hub came up in time, it accepts no more clients, or another program listens there.
    """

    name = "loop"

    def __init__(
        self,
        port: int = DEFAULT_LOOP_PORT,
        timeout_s: float = 10.0,
        may_host: bool = True,
        end: socket.socket | None = None,
    ) -> None:
        self.spec = f"loop:{port}"
        self._inbox: deque[Frame] = deque()
        self._partial = b""  # beginning of a record whose end is still on its way
        self._hub: Hub | None = None
        try:
            self._socket = end or self._join(port, monotonic() + timeout_s, may_host)
        except OSError as error:  # for example no descriptor or port left
            raise BusError(f"the bus {self.spec} cannot be opened: {error.strerror}") from error
        self._socket.setblocking(False)  # both ways wait in select
        atexit.register(self.close)

    def send(self, frames: Sequence[Frame]) -> None:
        """Send all frames at once, in order."""
        records = memoryview(can_frame.pack_all(frames))
        try:
            self._send(records)
        except (OSError, ValueError) as error:  # ValueError: closed on our side
            raise self._closed() from error

    def receive(self, timeout_s: float | None) -> Frame | None:
        """The next frame, or None if none came within ``timeout_s``."""
        if not self._inbox and not self._fill(timeout_s):
            return None
        return self._inbox.popleft()

    def close(self) -> None:
        """Leave the bus; what has been sent still reaches the others."""
        if self._socket.fileno() < 0:
            return
        atexit.unregister(self.close)
        self._shut_down()
        self._socket.close()
        if self._hub is not None:
            self._hub.close()

    def _send(self, records: memoryview) -> None:
        deadline: float | None = None
        while records:
            try:
                records = records[self._socket.send(records) :]
            except BlockingIOError:
                deadline = deadline or monotonic() + SEND_PATIENCE_S
                if not select.select((), (self._socket,), (), max(0.0, deadline - monotonic()))[1]:
                    still = f"the bus {self.spec} accepts no more data: its hub stands still"
                    raise BusError(still) from None

    def _fill(self, timeout_s: float | None) -> bool:
        deadline = None if timeout_s is None else monotonic() + timeout_s
        while True:
            timeout_s = None if deadline is None else max(0.0, deadline - monotonic())
            try:
                if not select.select((self._socket,), (), (), timeout_s)[0]:
                    return False
                received = self._socket.recv(_CHUNK)
            except BlockingIOError:  # ready for nothing: Linux may say so
                continue
            except (OSError, ValueError) as error:  # ValueError: closed on our side
                raise self._closed() from error
            if not received:
                raise self._closed()
            pending = self._partial + received if self._partial else received
            whole = len(pending) - len(pending) % can_frame.SIZE
            self._partial = pending[whole:]
            if whole:
                self._inbox.extend(can_frame.unpack(pending[:whole]))
                return True

    def _closed(self) -> BusClosed:
        if self._socket.fileno() < 0:
            return BusClosed(f"the bus {self.spec} is closed: this end has been closed")
        return BusClosed(
            f"the bus {self.spec} is closed: its hub is gone, or dropped this end, which read too slowly"
        )

    def _shut_down(self) -> None:
        """Shut down sending, and read until the hub does the same.

        Closing on unread data would reset the connection and could destroy what the hub has not read yet.
        """
        try:
            self._socket.shutdown(socket.SHUT_WR)
            deadline = monotonic() + _PARTING_S
            while (left_s := deadline - monotonic()) > 0:
                if not select.select((self._socket,), (), (), left_s)[0] or not self._socket.recv(_CHUNK):
                    return
        except OSError:
            return

    def _join(self, port: int, deadline: float, may_host: bool) -> socket.socket:
        while True:
            connection = _connect(port, deadline)
            if connection is None and may_host:
                connection = self._host(port)
            if connection is not None:
                return connection
            if monotonic() >= deadline:
                raise BusError(f"no hub answers on port {port} of this machine")
            sleep(_RETRY_S)

    def _host(self, port: int) -> socket.socket | None:
        """The host's own end, on the bus before any other; None if another process was quicker."""
        try:
            hub = Hub(port)
        except OSError:
            return None
        end = hub.attach()
        hub.start()
        self._hub = hub
        return end


def _connect(port: int, deadline: float) -> socket.socket | None:
    """A connection that the hub has greeted; None if no hub listens (yet, or any more)."""
    connection = socket.socket()
    try:
        connection.settimeout(max(_RETRY_S, deadline - monotonic()))
        connection.connect((HOST, port))
        if connection.getsockname() == connection.getpeername():  # TCP may connect a free port to itself
            raise ConnectionRefusedError
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        greeting = b""
        while len(greeting) < len(GREETING):
            received = connection.recv(len(GREETING) - len(greeting))
            if not received:
                raise ConnectionResetError
            greeting += received
        if greeting == FULL:
            raise BusError(f"the loop bus on port {port} is full: its hub accepts no more clients")
        if greeting != GREETING:
            raise BusError(f"port {port} of this machine is taken by another program, which is no hub")
    except (ConnectionError, TimeoutError):
        connection.close()
        return None
    except BaseException:
        connection.close()
        raise
    return connection


# --- The end of the loop bus of a process that serves it without a thread, whenever it sends or receives


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
