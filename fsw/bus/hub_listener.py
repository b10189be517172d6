"""The listening socket of the hub: accepts a client with a greeting, or refuses it with one."""

import os
import socket
from collections.abc import Callable
from contextlib import suppress

GREETING = b"torquer-loop/1\r\n"
"""First bytes from the hub: the client is on the bus, and what follows is for it."""

FULL = b"torquer-full/1\r\n"
"""First and last bytes from a hub that accepts no more clients; as many as the greeting has."""

HOST = "127.0.0.1"
_SEND_BUFFER = 2**18
"""Bytes. Left to itself the kernel would keep 4 MiB for each client that does not read."""


class NoDescriptorError(OSError):
    """There is no descriptor left even to refuse a client: it stays in the backlog of the socket."""


class HubListener:
    """A listening socket on 127.0.0.1, and a spare descriptor to refuse a client when no other is left.

    Args:
        listener: a listening socket, as ``listen`` gives it.
        report: called with a sentence about refused clients, at the first, tenth, hundredth ... of them.
    """

    def __init__(self, listener: socket.socket, report: Callable[[str], None]) -> None:
        self._listener = listener
        self._spare: int | None = _descriptor()
        self._report = report
        self._refused = 0
        self._report_at = 1
        self.port: int = self._listener.getsockname()[1]

    def fileno(self) -> int:
        """The descriptor to wait on; negative once closed."""
        return self._listener.fileno()

    def accept(self, has_room: bool) -> tuple[socket.socket, int] | None:
        """Accept the next client: its greeted connection and its port; None if it was refused or is gone.

        Raises:
            NoDescriptorError: it cannot be answered now.
        """
        try:
            connection, (_, port) = self._listener.accept()
        except (BlockingIOError, ConnectionError):  # gone before it was accepted
            return None
        except OSError as error:
            self._refuse_with_spare(error)
            return None
        if not has_room:
            self._refuse(connection, "it has as many clients as it serves")
            return None
        return (connection, port) if _greet(connection) else None

    def close(self) -> None:
        """Accept no more clients."""
        self._listener.close()
        if self._spare is not None:
            os.close(self._spare)
            self._spare = None

    def _refuse_with_spare(self, why: OSError) -> None:
        if self._spare is not None:
            os.close(self._spare)
        try:
            connection, _ = self._listener.accept()
        except (BlockingIOError, ConnectionError):
            return
        except OSError as error:
            raise NoDescriptorError(error.errno, error.strerror) from error
        else:
            self._refuse(connection, str(why.strerror))
        finally:
            self._spare = _descriptor()

    def _refuse(self, connection: socket.socket, why: str) -> None:
        with connection, suppress(OSError):  # gone already
            connection.setblocking(False)
            connection.send(FULL)
        self._refused += 1
        if self._refused == self._report_at:
            self._report_at *= 10
            self._report(
                f"the loop bus on port {self.port} accepts no more clients ({why}): {self._refused} refused"
            )


def _greet(connection: socket.socket) -> bool:
    try:
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER)
        connection.send(GREETING)
    except OSError:  # gone again
        connection.close()
        return False
    return True


def _descriptor() -> int | None:
    try:
        return os.open(os.devnull, os.O_RDONLY)
    except OSError:
        return None


def listen(port: int) -> socket.socket:
    """A socket that listens on 127.0.0.1; 0 takes a free port.

    Raises:
        OSError: the port is taken.
    """
    listener = socket.socket()
    try:
        if os.name == "posix":  # elsewhere this option would let two hubs share a port
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((HOST, port))
        listener.listen(1024)
        listener.setblocking(False)
    except OSError:
        listener.close()
        raise
    return listener
