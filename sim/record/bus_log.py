"""The writer of bus.log and its index."""

import hashlib
import os
from pathlib import Path
from types import TracebackType
from typing import Self

from fsw.wire.candump_line import format_line, format_time
from fsw.wire.frame import Frame
from sim.errors import FlightError
from sim.record.log_index import LogIndex


class BusLog:
    """bus.log and its index, written a whole tick at a time: a kill leaves whole ticks.

    Raises:
        FlightError: the disk is full. The file then ends with its last whole tick.
    """

    def __init__(self, path: Path, channel: str) -> None:
        self._path = path
        self._channel = channel
        self._size = 0
        self._sha256 = hashlib.sha256()
        try:
            self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
            self._index = LogIndex(path)
        except OSError as error:
            raise FlightError(f"{path}: cannot be written: {error.strerror}") from None

    def write(self, timestamp_us: int, frames: list[Frame]) -> None:
        """Append frames that share one time stamp."""
        stamp = format_time(timestamp_us)
        channel = self._channel
        text = "".join([format_line(stamp, channel, frame) for frame in frames]).encode("ascii")
        rest = text
        try:
            while rest:
                rest = rest[os.write(self._descriptor, rest) :]
            self._index.add(text, len(frames))
        except OSError as error:
            if rest:
                os.ftruncate(self._descriptor, self._size)
            raise FlightError(
                f"{self._path}: cannot be written at {stamp}: {error.strerror}; the log up to then is kept"
            ) from None
        self._size += len(text)
        self._sha256.update(text)

    @property
    def sha256(self) -> str:
        """Of all that was written, in hex."""
        return self._sha256.hexdigest()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        os.close(self._descriptor)
        try:
            self._index.close(ended=error is None)
        except OSError as fault:
            if error is None:
                raise FlightError(f"{self._path}: its index cannot be written: {fault.strerror}") from None
