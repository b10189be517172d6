"""The live view in Foxglove: attitude and directions in its 3-D panel, series, events, by its own server."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from fsw.core.algebra.quaternion import IDENTITY
from sim.errors import HarnessError, needing
from sim.watch.flight_view import FlightView
from sim.watch.happening import Weight
from sim.watch.snapshot import STATE_SCHEMA, state

if TYPE_CHECKING:
    from foxglove import Context

HOST = "127.0.0.1"
STOPPED_WITHIN_S = 1.0
"""Time that the server has to take leave of its clients [s]."""
COLOURS: dict[str, dict[str, float]] = {
    "body 1": {"r": 0.0, "g": 0.45, "b": 0.70},
    "body 2": {"r": 0.84, "g": 0.37, "b": 0.0},
    "body 3": {"r": 0.0, "g": 0.62, "b": 0.45},
    "field": {"r": 0.48, "g": 0.25, "b": 0.63},
    "Sun": {"r": 0.90, "g": 0.62, "b": 0.0},
    "dipole": {"r": 0.80, "g": 0.47, "b": 0.65},
    "torque": {"r": 0.70, "g": 0.15, "b": 0.12},
}
"""Of arrows; the others are grey."""
GREY = {"r": 0.5, "g": 0.5, "b": 0.5}


@contextmanager
def foxglove_server(port: int) -> Iterator["Publisher"]:
    """A server for Foxglove on this machine alone.

    Args:
        port: of TCP; 0: any that is free.

    Raises:
        HarnessError: the package is not installed, or the port is taken.
    """
    with needing("--foxglove", "foxglove-sdk", "watch"):
        import foxglove
    context = foxglove.Context()
    try:
        server = foxglove.start_server(name="torquer", host=HOST, port=port, context=context)
    except RuntimeError as error:
        raise HarnessError(f"--port {port}: no server can be started there: {error}") from None
    try:
        yield Publisher(context, server.port)
    finally:
        # it waits for each connection, also for one that has never said a word; the process ends without it
        stopping = threading.Thread(target=server.stop, daemon=True)
        stopping.start()
        stopping.join(STOPPED_WITHIN_S)


class Publisher:
    """Sends what the view shows to whoever is connected, on /tf, /scene, /state and /events.

    Args:
        context: of foxglove.
        port: on which it is served.
    """

    def __init__(self, context: "Context", port: int) -> None:
        from foxglove import Channel
        from foxglove.channels import FrameTransformsChannel, LogChannel, SceneUpdateChannel

        self.port = port
        self._transforms = FrameTransformsChannel("/tf", context=context)
        self._scene = SceneUpdateChannel("/scene", context=context)
        self._events = LogChannel("/events", context=context)
        self._state = Channel("/state", schema=STATE_SCHEMA, context=context)
        self._last_sent = 0
        self._shown: set[str] = set()

    def publish(self, view: FlightView) -> None:
        """Everything of this moment, and what has happened since the last one; from the first SYNC on.

        Of what happened before, the last is shown, and how many are left out.
        """
        from foxglove.messages import (
            Color,
            Log,
            LogLevel,
            SceneEntity,
            SceneEntityDeletion,
            SceneEntityDeletionType,
            SceneUpdate,
        )

        from sim.drawing.foxglove_scene import ESTIMATE, ORBIT, arrow, attitude, stamp_of

        if view.unix_s is None:
            return
        now_ns = view.unix_s * 10**9
        self._transforms.log(attitude(ESTIMATE, view.attitude or IDENTITY, now_ns), log_time=now_ns)
        shown = view.arrows()
        by_id = SceneEntityDeletionType.MatchingId
        gone = [
            SceneEntityDeletion(timestamp=stamp_of(now_ns), type=by_id, id=name)
            for name in sorted(self._shown - shown.keys())
        ]
        self._shown = set(shown)
        arrows = [
            SceneEntity(
                id=name,
                frame_id=ORBIT,
                timestamp=stamp_of(now_ns),
                arrows=[arrow(vector, Color(**COLOURS.get(name, GREY), a=1.0))],
            )
            for name, vector in shown.items()
        ]
        self._scene.log(SceneUpdate(entities=arrows, deletions=gone), log_time=now_ns)
        self._state.log(state(view), log_time=now_ns)
        levels = {Weight.WARNING: LogLevel.Warning, Weight.ERROR: LogLevel.Error}
        for one in view.happenings:
            if one.number > self._last_sent:
                then_ns = (one.unix_s or view.unix_s) * 10**9
                level = levels.get(one.weight, LogLevel.Info)
                left_out = one.number - self._last_sent - 1
                words = f"{one.words}; {left_out} before it are left out" if left_out else one.words
                log = Log(timestamp=stamp_of(then_ns), level=level, message=words, name="bus")
                self._events.log(log, log_time=then_ns)
                self._last_sent = one.number
