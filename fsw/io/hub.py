"""The hub of the loop bus: hands every record that a client sends to all other clients.

The hub listens on 127.0.0.1 and speaks 16-byte records (``fsw.io.record``) after one greeting. It never
drops a record: what a slow client has not taken yet waits in memory. A client that falls behind by
``BACKLOG_LIMIT`` is disconnected, which it notices, instead of losing frames, which it would not.
"""

import os
import selectors
import socket
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from threading import Thread
from time import monotonic

from fsw.io import record

GREETING = b"torquer-loop/1\r\n"
"""First bytes from the hub: the client is on the bus, and what follows is for it."""

HOST = "127.0.0.1"
BACKLOG_LIMIT = 64 * 2**20
_CHUNK = 2**16
_BOTH = selectors.EVENT_READ | selectors.EVENT_WRITE


@dataclass(slots=True, eq=False)
class _Client:
    socket: socket.socket
    torn: bytes = b""  # beginning of a record whose end is still on its way
    backlog: bytearray = field(default_factory=bytearray)


class Hub:
    """A hub that serves when told to by ``poll``, or by itself in a daemon thread after ``start``.

    Opening a bus waits for the hub's greeting: whoever serves by ``poll`` opens none in that same thread.

    Args:
        port: TCP port on 127.0.0.1; 0 takes a free one.

    Raises:
        OSError: the port is taken.
    """

    def __init__(self, port: int = 0) -> None:
        self._clients: set[_Client] = set()
        self._thread: Thread | None = None
        self._selector = selectors.DefaultSelector()
        self._listener = _listen(port)
        self._waker, self._wake = socket.socketpair()
        self._stopping = False
        self.port: int = self._listener.getsockname()[1]
        self._selector.register(self._listener, selectors.EVENT_READ, self._accept)
        self._selector.register(self._wake, selectors.EVENT_READ, self._stop)

    @property
    def clients(self) -> int:
        """How many are on the bus."""
        return len(self._clients)

    def poll(self, timeout_s: float | None) -> bool:
        """Serve what is ready, waiting at most ``timeout_s`` for it (None: for ever); true if any was."""
        ready = self._selector.select(timeout_s)
        for key, events in ready:
            if isinstance(key.data, _Client):
                self._serve(key.data, events)
            else:
                handle: Callable[[], None] = key.data
                handle()
        return bool(ready)

    def attach(self) -> socket.socket:
        """A socket that is on the bus at once, ungreeted. Call it before ``start``, or where ``poll`` is."""
        inner, outer = socket.socketpair()
        self._admit(inner)
        return outer

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
        self._selector.unregister(self._listener)
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
            connection, _ = self._listener.accept()
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        except OSError:  # gone again before it was taken
            return
        self._deliver(self._admit(connection), GREETING)

    def _admit(self, connection: socket.socket) -> _Client:
        connection.setblocking(False)
        client = _Client(connection)
        self._clients.add(client)
        self._selector.register(connection, selectors.EVENT_READ, client)
        return client

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
        pending = sender.torn + received if sender.torn else received
        whole = len(pending) - len(pending) % record.SIZE
        records, sender.torn = pending[:whole], pending[whole:]
        if records and max(records[record.LENGTH_OFFSET :: record.SIZE]) > record.MAX_DATA:
            self._drop(sender)  # a stranger: these are no records
            return
        for client in tuple(self._clients):
            if client is not sender and records:
                self._deliver(client, records)

    def _deliver(self, client: _Client, records: bytes) -> None:
        if not client.backlog:
            records = records[self._send(client, records) :]
            if not records or client not in self._clients:
                return
            self._selector.modify(client.socket, _BOTH, client)
        client.backlog += records
        if len(client.backlog) > BACKLOG_LIMIT:
            self._drop(client)

    def _catch_up(self, client: _Client) -> None:
        del client.backlog[: self._send(client, client.backlog)]
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


def _listen(port: int) -> socket.socket:
    listener = socket.socket()
    try:
        if os.name == "posix":  # elsewhere this option would let two hubs share a port
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((HOST, port))
        listener.listen(128)
        listener.setblocking(False)
    except OSError:
        listener.close()
        raise
    return listener
