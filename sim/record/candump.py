"""The bus log: a file in candump's format, one frame a line (``fsw.wire.candump_line``)."""

import os
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO, NamedTuple

from fsw.input.gzip_text import is_compressed, last_member, open_text
from fsw.wire.candump_line import LONGEST, LineReader, is_beginning, is_fd
from fsw.wire.frame import Frame
from sim.errors import HarnessError


class LogError(HarnessError):
    """The file is not a candump log, or has been altered."""


class LogTruncatedError(LogError):
    """The log ends inside a line. Raised after every whole line has been yielded.

    Attributes:
        line: number of the line that is cut.
    """

    exit_code = 1

    def __init__(self, path: Path, line: int) -> None:
        super().__init__(f"{path}: truncated: line {line} is incomplete")
        self.line = line


class LogEntry(NamedTuple):
    """One line of a log: its number from 1, the time in whole microseconds, the channel and the frame."""

    line: int
    timestamp_us: int
    channel: str
    frame: Frame


TAIL_BYTES = 1 << 16
"""More than a block of a log."""
More = Callable[[], bool]
"""Called at the end of a log that is being written: waits, and says whether to look for more."""


def read_log(path: Path, more: More | None = None, channel: str | None = None) -> Iterator[LogEntry]:
    """The frames of a candump log, one by one, in the order of the file.

    Empty lines, and comments, which begin with ``#``, are passed over.

    Args:
        path: of the log.
        more: given where the log is still being written.
        channel: the one to read; None: the log must have one alone.

    Raises:
        LogTruncatedError: at the end, if the last line is cut; every whole line has been yielded by then.
        LogError: the file cannot be read, one of its lines is not a candump line, or it has other channels.
    """
    try:
        with open_text(path) as file:
            yield from _entries(path, file.readline if more is None else _growing(file, more), channel)
    except OSError as error:
        raise LogError(f"{path}: cannot be read: {error.strerror}") from None


def whole_entries(path: Path) -> Iterator[LogEntry]:
    """The whole entries of a log that may be cut."""
    with suppress(LogTruncatedError):
        yield from read_log(path)


def last_lines(path: Path) -> list[bytes]:
    """The last whole lines of a log that is being written; none while there are none."""
    try:
        with path.open("rb") as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - TAIL_BYTES))
            tail = file.read()
    except OSError:
        return []
    if is_compressed(path):
        tail = last_member(tail)
    return [line for line in tail.splitlines(keepends=True)[1:] if line.endswith(b"\n")]


def _growing(file: BinaryIO, more: More) -> Callable[[int], bytes]:
    """Reads whole lines as they are written, and what is left once there is no more."""

    def readline(most: int) -> bytes:
        text = b""
        while True:
            text += file.readline(most - len(text))
            if text.endswith(b"\n") or len(text) == most or not more():
                return text

    return readline


def _entries(path: Path, readline: Callable[[int], bytes], asked: str | None) -> Iterator[LogEntry]:
    read = LineReader().read
    number = 0
    channel: str | None = None  # the one that is read
    other: str | None = None
    while text := readline(LONGEST):
        number += 1
        fields = read(text)
        if fields is None:
            if not _is_comment(text):
                raise _refusal(path, number, text)
            while not text.endswith(b"\n") and text:
                text = readline(LONGEST)
            continue
        if fields[1] != channel:
            if asked is not None and fields[1] != asked:
                other = fields[1]
                continue
            if channel is not None:
                raise LogError(
                    f"{path}: line {number} is of channel {fields[1]}, those before it are of {channel}: "
                    "keep the lines of one; torquer check and replay read one by --channel"
                )
            channel = fields[1]
        yield LogEntry(number, *fields)
    if number == 0:
        raise LogError(f"{path}: not a candump log: the file is empty")
    if channel is None:
        what = "no line of a frame" if other is None else f"no frame of channel {asked}, only of {other}"
        raise LogError(f"{path}: not a candump log: {what}" if other is None else f"{path}: {what}")


def _is_comment(text: bytes) -> bool:
    """Whether can-utils' player passes over a line, as it does over comments and empty ones."""
    return text.startswith(b"#") or not text.strip()


def _refusal(path: Path, number: int, text: bytes) -> LogError:
    if len(text) < LONGEST and not text.endswith(b"\n") and is_beginning(text):
        return LogTruncatedError(path, number)
    if is_fd(text):
        return LogError(f"{path}: line {number} is a CAN FD frame: only classic CAN is read")
    if number == 1:
        return LogError(f"{path}: not a candump log: line 1 is not '(seconds) channel id#data'")
    return LogError(f"{path}: line {number} is not a candump line: the log has been altered")
