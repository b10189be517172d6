"""A run as MCAP for Foxglove and PlotJuggler: signals, attitude, arrows in 3-D, each with its time.

| topic | schema | holds |
|---|---|---|
| ``/can/NAME`` | JSON | the signals of each frame of that message; units end their names |
| ``/can/other`` | JSON | frames that are no whole message, as they were |
| ``/truth`` | JSON | the plant's histories, as in truth.h5 |
| ``/tf`` | foxglove.FrameTransforms | ``body`` and ``body_estimate`` in the frame ``orbit`` |
| ``/scene`` | foxglove.SceneUpdate | body axes, field, Sun, dipole and nadir as arrows |
"""

import heapq
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from fsw.wire.frame import Frame
from fsw.wire.messages import CLASSES, NavAttitude, intact
from sim.errors import needing
from sim.export.dictionary import Message, messages
from sim.export.history_table import AXES
from sim.export.source import LogPass, Source
from sim.progress import Watch
from sim.record.candump import LogEntry
from sim.record.truth import BLOCK_ROWS, COLUMNS, TruthReader
from sim.value_types import Json

Row = dict[str, list[float]]
"""The plant's histories at a tick: the components of each, by name."""


class _Stamped(NamedTuple):
    time_ns: int
    item: LogEntry | Row


def write_mcap(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write an MCAP file; memory does not grow with the flight.

    Raises:
        HarnessError: the package foxglove-sdk is missing.
    """
    with needing("mcap", "foxglove-sdk", "export"):
        from foxglove import Context, open_mcap  # noqa: PLC0415  an extra
    from sim.export.mcap_scene import Scene  # noqa: PLC0415  needs foxglove

    log, context = LogPass(source.log), Context()
    signals, scene, truth = _SignalTopics(context), Scene(context), _truth_channel(context)
    began_ns: int | None = None
    with open_mcap(path, allow_overwrite=True, context=context) as writer:
        writer.write_metadata("torquer", {key: str(value) for key, value in source.identity.items()})
        for time_ns, item in heapq.merge(_log_items(log), _truth_items(source), key=lambda one: one.time_ns):
            if isinstance(item, LogEntry):
                signals.log(item.frame, time_ns)
                if item.frame.can_id == NavAttitude.ID and intact(item.frame):
                    scene.log_estimate(NavAttitude.decode(item.frame.data), time_ns)
            else:
                truth.log(_vectors(item), log_time=time_ns)
                scene.log_truth(item, time_ns)
            began_ns = time_ns if began_ns is None else began_ns
            watch((time_ns - began_ns) // 1000)
    return log.notes


def _log_items(log: LogPass) -> Iterator[_Stamped]:
    for entry in log:
        yield _Stamped(1000 * entry.timestamp_us, entry)


def _truth_items(source: Source) -> Iterator[_Stamped]:
    """The rows of the plant's histories, if there are any."""
    if source.truth is None or source.scenario is None:
        return
    epoch_ns, tick_hz = 10**9 * source.scenario.epoch_unix_s, source.scenario.time.tick_hz
    with TruthReader(source.truth) as truth:
        for first in range(0, truth.complete, BLOCK_ROWS):
            block = truth.rows(first, min(first + BLOCK_ROWS, truth.complete))
            lists = {name: values.reshape(len(values), -1).tolist() for name, values in block.items()}
            for index in range(len(block["t_s"])):
                time_ns = epoch_ns + 10**9 * (first + index) // tick_hz
                yield _Stamped(time_ns, {name: rows[index] for name, rows in lists.items()})


def _vectors(row: Row) -> bytes:
    """A row as JSON: vectors as objects, so that each component can be plotted by its name."""
    return json.dumps(
        {
            name.replace("/", "_"): values[0]
            if len(values) == 1
            else dict(zip(_LETTERS[len(values)], values, strict=True))
            for name, values in row.items()
        }
    ).encode()


_LETTERS = {width: tuple(axis[1:] for axis in axes) for width, axes in AXES.items()}


def _json_channel(context: Any, topic: str, schema: Json) -> Any:  # noqa: ANN401  of foxglove
    from foxglove import Channel  # noqa: PLC0415  an extra

    return Channel(topic, schema=schema, context=context)


def _truth_channel(context: Any) -> Any:  # noqa: ANN401  of foxglove
    number = {"type": "number"}
    properties: Json = {}
    for name, width, unit, meaning in COLUMNS:
        parts = {"properties": dict.fromkeys(_LETTERS[width], number), "type": "object"}
        properties[name] = (number if width == 1 else parts) | {"description": f"{meaning} [{unit}]"}
    schema = {"title": "torquer.Truth", "type": "object", "properties": properties}
    return _json_channel(context, "/truth", schema)


class _SignalTopics:
    """A topic for each message of the bus, made when its first frame comes."""

    def __init__(self, context: Any) -> None:  # noqa: ANN401  of foxglove
        self._context = context
        self._messages = {message.can_id: message for message in messages()}
        self._topics: dict[int, Any] = {}
        self._other: Any = None

    def log(self, frame: Frame, time_ns: int) -> None:
        """Log a frame, decoded if it is a whole message."""
        if not intact(frame):
            self._other = self._other or _json_channel(self._context, "/can/other", OTHER)
            why = "broken" if frame.can_id in self._messages else "unknown"
            values: Json = {"id": f"{frame.can_id:X}", "data": frame.data.hex(), "why": why}
            self._other.log(json.dumps(values).encode(), log_time=time_ns)
            return
        topic = self._topics.get(frame.can_id)
        message = self._messages[frame.can_id]
        if topic is None:
            topic = _json_channel(self._context, f"/can/{message.name}", _schema(message))
            self._topics[frame.can_id] = topic
        topic.log(json.dumps(signal_values(message, frame)).encode(), log_time=time_ns)


OTHER = {
    "title": "torquer.OtherFrame",
    "type": "object",
    "properties": {name: {"type": "string"} for name in ("id", "data", "why")},
}


def signal_values(message: Message, frame: Frame) -> Json:
    """Physical values by field; of an enumeration also its name."""
    decoded = CLASSES[frame.can_id].decode(frame.data)
    values: Json = {}
    for signal in message.signals:
        if signal.name == "crc":
            continue
        value = values[signal.field] = getattr(decoded, signal.name)
        if signal.choices:
            values[f"{signal.field}_name"] = signal.choices.get(value, "")
    return values


def _schema(message: Message) -> Json:
    properties: Json = {}
    for signal in message.signals:
        if signal.name == "crc":
            continue
        kind = "integer" if signal.is_whole else "number"
        about = "; ".join(part for part in (signal.comment, f"[{signal.unit or 'code'}]") if part)
        properties[signal.field] = {"type": kind, "description": about}
        if signal.choices:
            properties[f"{signal.field}_name"] = {"type": "string"}
    return {
        "title": f"torquer.{message.name}",
        "description": message.comment,
        "type": "object",
        "properties": properties,
    }
