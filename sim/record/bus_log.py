"""The writer of bus.log and its index."""

import gzip
import hashlib
import os
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Self, final

from fsw.input.gzip_text import is_compressed
from fsw.wire.candump_line import format_lines, format_time
from fsw.wire.frame import Frame
from sim.errors import FlightError
from sim.record.log_index import LogIndex

BLOCK_WRITES = 64
"""Number of writes, as a rule ticks, that go to the disk together."""
BLOCK_S = 0.5
"""Time after the last block from which a write goes to the disk at once: at 1 Hz, every tick by itself."""
LEVEL = 1
"""Of compression: a quarter of the text remains; the next levels take three times as long for little gain."""


@final
class _Write:
    __slots__ = ("lines", "stamp", "text")

    def __init__(self, stamp: str, text: bytes, lines: int) -> None:
        self.stamp = stamp
        self.text = text
        self.lines = lines


class BusLog:
    """bus.log and its index, written in blocks: a kill leaves whole ticks, at most a block short.

    Each block of a log whose name ends in ``.gz`` is a member of it, so that it too can be read after a kill.
    ``sha256`` is of the text that was given to ``write``, in hex.

    Args:
        path: of the log.
        channel: name of the bus.
        clock_s: a clock that never goes back.

    Raises:
        FlightError: the disk is full. The file then ends with its last whole tick, each line once.
    """

    def __init__(self, path: Path, channel: str, clock_s: Callable[[], float] = time.monotonic) -> None:
        self._path = path
        self._channel = channel
        self._clock_s = clock_s
        self._compressed = is_compressed(path)
        self._waiting: list[_Write] = []
        self._written_s = -BLOCK_S
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
        text = format_lines(stamp, self._channel, frames).encode("ascii")
        self._waiting.append(_Write(stamp, text, len(frames)))
        if len(self._waiting) >= BLOCK_WRITES or self._clock_s() - self._written_s >= BLOCK_S:
            self._write_block()

    def _write_block(self) -> None:
        waiting, self._waiting, self._written_s = self._waiting, [], self._clock_s()
        try:
            self._put(b"".join([write.text for write in waiting]), sum([write.lines for write in waiting]))
        except OSError:
            self._put_one_by_one(waiting)

    def _put_one_by_one(self, waiting: list[_Write]) -> None:
        """Write as much as there is room for of a block that does not fit."""
        for write in waiting:
            try:
                self._put(write.text, write.lines)
            except OSError as error:
                raise FlightError(
                    f"{self._path}: cannot be written at {write.stamp}: {error.strerror}; "
                    "the log up to then is kept"
                ) from None

    def _put(self, text: bytes, lines: int) -> None:
        stored = gzip.compress(text, LEVEL, mtime=0) if self._compressed and text else text
        rest = stored
        try:
            while rest:
                rest = rest[os.write(self._descriptor, rest) :]
        except OSError:
            os.ftruncate(self._descriptor, self._size)
            os.lseek(self._descriptor, 0, os.SEEK_END)
            raise
        self._size += len(stored)
        self._sha256.update(text)
        try:
            self._index.add(text, lines)
        except OSError as error:  # not one of the log: what was written is not to be written again
            raise self._index_error(error) from None

    def _index_error(self, error: OSError) -> FlightError:
        return FlightError(f"{self._path}: its index cannot be written: {error.strerror}; the log is kept")

    @property
    def sha256(self) -> str:
        """Of all that is on the disk, uncompressed, in hex."""
        return self._sha256.hexdigest()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        ended = error is None
        try:
            if self._waiting:
                self._write_block()
        except FlightError:
            ended = False
            raise
        finally:
            os.close(self._descriptor)
            self._close_index(ended)

    def _close_index(self, ended: bool) -> None:
        try:
            self._index.close(ended)
        except OSError as fault:
            if ended:
                raise self._index_error(fault) from None
