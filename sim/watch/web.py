"""The live view as a page on this machine: snapshots over a websocket, to anyone who opens it here."""

import asyncio
import socket
import threading
from collections.abc import Callable
from contextlib import contextmanager
from typing import TYPE_CHECKING, Literal

from sim.drawing.pages import live_page
from sim.errors import HarnessError, needing
from sim.watch.flight_view import FlightView
from sim.watch.snapshot import snapshot
from sim.watch.source import FrameSource, take_batch

if TYPE_CHECKING:
    from collections.abc import Iterator

    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.websockets import WebSocket

HOST = "127.0.0.1"
EVERY_S = 0.2
"""Time between two snapshots [s]."""
SCRIPTS = ("script/watch.js",)
WEBSOCKETS: Literal["websockets-sansio"] = "websockets-sansio"
"""How uvicorn speaks it: by what the package websockets keeps, not by its legacy interface."""


class LiveView:
    """What the frames show, filled by one thread and read by another.

    Args:
        source: of the frames.
        view: what they show.
    """

    def __init__(self, source: FrameSource, view: FlightView) -> None:
        self.source = source
        self._view = view
        self._lock = threading.Lock()
        self.failure: BaseException | None = None

    def read(self) -> None:
        """Take all frames of the source, until there are no more."""
        try:
            for batch in self.source.batches():
                with self._lock:
                    take_batch(self._view, batch)
        except Exception as error:  # it ends another thread, which raises it
            self.failure = error

    def snapshot(self, after: int, sampled: int) -> dict[str, object]:
        """As of ``sim.watch.snapshot``, and what is waited for; empty once there is a SYNC."""
        with self._lock:
            return {**snapshot(self._view, after, sampled), "waits_for": self._waits_for()}

    def _waits_for(self) -> str:
        if self._view.tick is not None:
            return ""
        if not self._view.frames:
            return self.source.waits_for
        return (
            f"{sum(self._view.frames.values())} frames, waits for SYNC, which the plant sends with each tick"
        )


def application(view: LiveView) -> "Starlette":
    """The page and its websocket; answers to this machine's names alone, and to pages that it served."""
    from starlette.applications import Starlette
    from starlette.middleware import Middleware
    from starlette.middleware.trustedhost import TrustedHostMiddleware
    from starlette.responses import HTMLResponse
    from starlette.routing import Route, WebSocketRoute

    html = live_page("sim.watch", "watch.html", SCRIPTS, source=view.source.name)

    async def index(request: "Request") -> "Response":
        return HTMLResponse(html, headers={"Cache-Control": "no-store", "X-Frame-Options": "DENY"})

    async def live(socket: "WebSocket") -> None:
        if socket.headers.get("origin") != f"http://{socket.headers.get('host')}":
            await socket.close(1008)
            return
        await socket.accept()
        await _send(socket, view)

    return Starlette(
        routes=[Route("/", index), WebSocketRoute("/live", live)],
        middleware=[Middleware(TrustedHostMiddleware, allowed_hosts=[HOST, "localhost"])],
    )


async def _send(socket: "WebSocket", view: LiveView) -> None:
    """Snapshots, until the page is closed."""
    from starlette.websockets import WebSocketDisconnect

    after = sampled = 0
    try:
        while True:
            now = view.snapshot(after, sampled)
            await socket.send_json(now)
            sampled = int(str(now["sampled"]))
            after = max(after, int(str(now["happened"])))
            await asyncio.sleep(EVERY_S)
    except WebSocketDisconnect:
        return


@contextmanager
def listening(port: int) -> "Iterator[socket.socket]":
    """A socket on this machine alone; connections wait until they are served.

    Raises:
        HarnessError: the port is taken.
    """
    with socket.socket() as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind((HOST, port))
            listener.listen()
        except OSError as error:
            raise HarnessError(f"--port {port}: the page cannot be served there: {error.strerror}") from None
        yield listener


def serve(view: LiveView, port: int, announce: Callable[[str], None]) -> None:
    """Serve the page until Ctrl-C; what has been shown stays when the source has ended.

    Args:
        view: what the frames show.
        port: of TCP; 0: any that is free.
        announce: called with the address of the page.

    Raises:
        HarnessError: a package is not installed, or the port is taken.
    """
    with needing("--web", "starlette, uvicorn and websockets", "watch"):
        import uvicorn
        import websockets  # noqa: F401  uvicorn imports it itself
    with listening(port) as listener:
        server = uvicorn.Server(
            uvicorn.Config(application(view), log_level="warning", ws=WEBSOCKETS, timeout_graceful_shutdown=1)
        )
        announce(f"http://{HOST}:{listener.getsockname()[1]}/")

        def read() -> None:
            view.read()
            server.should_exit = view.failure is not None

        threading.Thread(target=read, daemon=True).start()
        server.run(sockets=[listener])
    if view.failure is not None:
        raise view.failure
