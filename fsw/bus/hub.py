"""The hub of the loop bus: hands every record that a client sends to all other clients.

The hub listens on 127.0.0.1 and speaks 16-byte records (``fsw.bus.can_frame``) after one greeting. It never
drops a record: what a slow client has not taken yet waits in memory. When the backlog of all clients exceeds
``BACKLOG_LIMIT``, the slowest is disconnected: it notices that, but would not notice lost frames. At most
``MOST_CLIENTS`` are accepted.
"""

import selectors
import socket
import sys
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from threading import Thread
from time import monotonic

from fsw.bus import can_frame
from fsw.bus.hub_listener import HubListener, NoDescriptorError, listen
from fsw.wire.frame import Frame

MOST_CLIENTS = 64
"""Each of them gets a copy of every record: more would slow the bus for all."""

BACKLOG_LIMIT = 64 * 2**20
"""Bytes that wait for all clients together."""

_PAUSE_S = 0.1
_CHUNK = 2**16
_PIECE = 2**16
"""Bytes. A backlog that is one block would be moved as it grows, and leave holes of all sizes behind."""
_BOTH = selectors.EVENT_READ | selectors.EVENT_WRITE


@dataclass(slots=True, eq=False)
class _Client:
    socket: socket.socket
    name: str
    partial: bytes = b""  # beginning of a record whose end is still on its way
    backlog: deque[bytearray] = field(default_factory=deque)
    waiting: int = 0
    """Bytes of the backlog."""

    def keep(self, records: bytes) -> None:
        """Add to the backlog."""
        if not self.backlog or len(self.backlog[-1]) >= _PIECE:
            self.backlog.append(bytearray())
        self.backlog[-1] += records
        self.waiting += len(records)

    def discard(self, count: int) -> None:
        """Remove so many bytes of the first piece."""
        first = self.backlog[0]
        del first[:count]
        if not first:
            self.backlog.popleft()
        self.waiting -= count


def report_on_stderr(sentence: str) -> None:
    """Write a sentence to standard error, if that is open: the bus does not depend on it."""
    with suppress(OSError, ValueError):
        print(f"hub: {sentence}", file=sys.stderr, flush=True)


class Hub:
    """A hub that serves when ``poll`` is called, or by itself in a daemon thread after ``start``.

    Opening a bus waits for the hub's greeting: a thread that serves by ``poll`` must not open one.

    Args:
        port: TCP port on 127.0.0.1; 0 takes a free one. Or a socket that listens there.
        report: called with a sentence about each client that is dropped for being slow, and about some of
            those that are refused. It must not block: the bus waits for it.

    Raises:
        OSError: the port is taken.
    """

    def __init__(
        self, port: int | socket.socket = 0, report: Callable[[str], None] = report_on_stderr
    ) -> None:
        self._clients: set[_Client] = set()
        self._inbox: deque[Frame] | None = None
        self._thread: Thread | None = None
        self._selector = selectors.DefaultSelector()
        self._report = report
        self._listener = HubListener(listen(port) if isinstance(port, int) else port, report)
        self._paused_until: float | None = None
        self._waker, self._wake = socket.socketpair()
        self._stopping = False
        self.port: int = self._listener.port
        self._selector.register(self._listener, selectors.EVENT_READ, self._accept)
        self._selector.register(self._wake, selectors.EVENT_READ, self._stop)

    @property
    def clients(self) -> int:
        """How many are on the bus."""
        return len(self._clients)

    def poll(self, timeout_s: float | None) -> bool:
        """Serve what is ready, waiting at most ``timeout_s`` for it (None: for ever); true if any was."""
        if self._paused_until is not None:
            timeout_s = self._pause(self._paused_until, timeout_s)
        ready = self._selector.select(timeout_s)
        for key, events in ready:
            if isinstance(key.data, _Client):
                self._serve(key.data, events)
            else:
                handle: Callable[[], None] = key.data
                handle()
        return bool(ready)

    def attach(self) -> socket.socket:
        """A socket that is on the bus at once, ungreeted. Call before ``start``, or in that of ``poll``."""
        inner, outer = socket.socketpair()
        self.admit(inner, "this process's own end")
        return outer

    def admit(self, connection: socket.socket, name: str) -> None:
        """Put a connection on the bus, ungreeted; by the thread that serves."""
        connection.setblocking(False)
        client = _Client(connection, name)
        self._clients.add(client)
        self._selector.register(connection, selectors.EVENT_READ, client)

    def join(self, inbox: deque[Frame]) -> None:
        """Be on the bus without a socket: what others send goes into ``inbox``, too, as it is served."""
        self._inbox = inbox

    def send(self, records: bytes) -> None:
        """Hand records to all clients, by the thread that serves."""
        for client in tuple(self._clients):
            self._deliver(client, records)
        self._shed()

    def start(self) -> None:
        """Serve in a daemon thread until ``close``."""
        self._thread = Thread(target=self._run, name=f"hub:{self.port}", daemon=True)
        self._thread.start()

    def close(self, linger_s: float = 1.0) -> None:
        """Hand over what has been sent so far, for at most ``linger_s``, then disconnect all."""
        if self._listener.fileno() < 0:
            return
        if self._thread is not None:
            self._waker.send(b"\0")
            self._thread.join()
        if self._paused_until is None:
            self._selector.unregister(self._listener)
        self._paused_until = None
        self._listener.close()
        deadline = monotonic() + linger_s
        while (self.poll(0.0) or self._backlogged()) and monotonic() < deadline:
            if self._backlogged():
                self.poll(0.01)
        for client in tuple(self._clients):
            self._drop(client)
        self._selector.close()
        self._wake.close()
        self._waker.close()

    def _run(self) -> None:
        while not self._stopping:
            self.poll(None)

    def _stop(self) -> None:
        self._wake.recv(1)
        self._stopping = True

    def _backlogged(self) -> bool:
        return any(client.backlog for client in self._clients)

    def _accept(self) -> None:
        try:
            accepted = self._listener.accept(has_room=len(self._clients) < MOST_CLIENTS)
        except NoDescriptorError:  # select would return for the same client again and again
            self._selector.unregister(self._listener)
            self._paused_until = monotonic() + _PAUSE_S
            return
        if accepted is not None:
            connection, port = accepted
            self.admit(connection, f"the client on port {port}")

    def _pause(self, until: float, timeout_s: float | None) -> float | None:
        """How long to wait for traffic while no client is accepted; ``timeout_s`` once that is over."""
        left_s = until - monotonic()
        if left_s > 0.0:
            return left_s if timeout_s is None else min(left_s, timeout_s)
        self._selector.register(self._listener, selectors.EVENT_READ, self._accept)
        self._paused_until = None
        return timeout_s

    def _serve(self, client: _Client, events: int) -> None:
        if events & selectors.EVENT_WRITE and client in self._clients:
            self._catch_up(client)
        if events & selectors.EVENT_READ and client in self._clients:
            self._forward(client)

    def _forward(self, sender: _Client) -> None:
        try:
            received = sender.socket.recv(_CHUNK)
        except BlockingIOError:
            return
        except OSError:
            received = b""
        if not received:
            self._drop(sender)
            return
        pending = sender.partial + received if sender.partial else received
        whole = len(pending) - len(pending) % can_frame.SIZE
        records, sender.partial = pending[:whole], pending[whole:]
        if records and max(records[can_frame.LENGTH_OFFSET :: can_frame.SIZE]) > can_frame.MAX_DATA:
            self._drop(sender)  # not a client of ours: these are not records
            return
        if not records:
            return
        if self._inbox is not None:
            self._inbox.extend(can_frame.unpack(records))
        for client in tuple(self._clients):
            if client is not sender:
                self._deliver(client, records)
        self._shed()

    def _deliver(self, client: _Client, records: bytes) -> None:
        if not client.backlog:
            records = records[self._send(client, records) :]
            if not records or client not in self._clients:
                return
            self._selector.modify(client.socket, _BOTH, client)
        client.keep(records)

    def _shed(self) -> None:
        """Drop the slowest clients until the backlog is within its limit."""
        while sum(client.waiting for client in self._clients) > BACKLOG_LIMIT:
            slowest = max(self._clients, key=lambda client: client.waiting)
            self._report(
                f"{slowest.name} is dropped from the loop bus on port {self.port}: it reads too slowly, "
                f"{slowest.waiting / 2**20:.1f} MiB wait for it"
            )
            self._drop(slowest)

    def _catch_up(self, client: _Client) -> None:
        while client.backlog and (sent := self._send(client, client.backlog[0])):
            client.discard(sent)
        if not client.backlog and client in self._clients:
            self._selector.modify(client.socket, selectors.EVENT_READ, client)

    def _send(self, client: _Client, records: bytes | bytearray) -> int:
        try:
            return client.socket.send(records)
        except BlockingIOError:
            return 0
        except OSError:
            self._drop(client)
            return 0

    def _drop(self, client: _Client) -> None:
        self._clients.discard(client)
        with suppress(KeyError):
            self._selector.unregister(client.socket)
        client.socket.close()
