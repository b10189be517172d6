"""The bus log: the format of can-utils' ``candump -l``, one frame a line.

    (1427513417.000000) vcan0 110#133E0014F79838B7

An 11-bit identifier has three hex digits, an extended one eight; an error frame has eight, SocketCAN's error
flag among them; a remote frame bears ``R`` in place of data. Newer candumps append the direction (``R`` or
``T``), pad the channel, write nanoseconds or mark a raw DLC (``_9``): that is read, and dropped.
"""

import re
from binascii import unhexlify
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple, TypeVar

from fsw.input.regular_file import check_regular
from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from sim.errors import HarnessError

_LINE = re.compile(
    rb"\((\d{1,12})\.(\d{6})(?:\d{3})?\) +(\S{1,64}) "
    rb"([0-7][0-9A-Fa-f]{2}|[0-3][0-9A-Fa-f]{7})#"
    rb"(?:((?:[0-9A-Fa-f]{2}){0,8})|(R)[0-8]?)(?:_[9A-Fa-f])?(?: [RT])?\r?\n"
)
_FD_LINE = re.compile(rb"\(\d{1,12}\.\d{6}(?:\d{3})?\) +\S{1,64} [0-9A-Fa-f]{3,8}##")
_LONGEST = 256
"""No line of a candump log is longer; what is longer need not be read to its end to be refused."""

MOST_KNOWN = 4096
_Value = TypeVar("_Value")

_TEMPLATES = (b"(0.000000) c 000#00\n", b"(0.000000) c 00000000#00\n", b"_9\n", b" R\n")
_ENDINGS = frozenset(template[cut:] for template in _TEMPLATES for cut in range(len(template)))


class LogError(HarnessError):
    """The file is no candump log, or is one that has been altered."""


class LogTruncatedError(LogError):
    """The log ends inside a line. Raised after every whole line has been handed out.

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


def format_time(timestamp_us: int) -> str:
    """The timestamp as it stands between the parentheses."""
    seconds, microseconds = divmod(timestamp_us, 1_000_000)
    return f"{seconds:010d}.{microseconds:06d}"


def format_line(timestamp: str, channel: str, frame: Frame) -> str:
    """One line of the log, with its newline.

    Args:
        timestamp: as ``format_time`` gives it.
        channel: name of the bus, without spaces.
        frame: any classic frame; of a remote frame the length is not kept.
    """
    can_id, data = frame
    if can_id < 0x800:
        return f"({timestamp}) {channel} {can_id:03X}#{data.hex().upper()}\n"
    payload = "R" if can_id & REMOTE_FLAG else data.hex().upper()
    number = can_id & ~(EXTENDED_FLAG | REMOTE_FLAG)
    width = 8 if can_id & (EXTENDED_FLAG | ERROR_FLAG) else 3
    return f"({timestamp}) {channel} {number:0{width}X}#{payload}\n"


def read_log(path: Path) -> Iterator[LogEntry]:
    """The frames of a candump log, one by one, in the order of the file.

    Raises:
        LogTruncatedError: at the end, if the last line is cut; every whole line has been yielded by then.
        LogError: the file cannot be read, its first line is no candump line, or a later one is not.
    """
    try:
        check_regular(path)
        with path.open("rb") as file:
            yield from _entries(path, file.readline)
    except OSError as error:
        raise LogError(f"{path}: cannot be read: {error.strerror}") from None


def _entries(path: Path, readline: Callable[[int], bytes]) -> Iterator[LogEntry]:
    match = _LINE.fullmatch
    identifiers: dict[bytes, int] = {}
    channels: dict[bytes, str] = {}
    stamp: tuple[bytes, bytes] = (b"", b"")
    timestamp_us = 0
    number = 0
    while text := readline(_LONGEST):
        number += 1
        found = match(text)
        if found is None:
            raise _refusal(path, number, text)
        seconds, microseconds, name, digits, data, remote = found.groups()
        if stamp != (seconds, microseconds):
            stamp = (seconds, microseconds)
            timestamp_us = int(seconds) * 1_000_000 + int(microseconds)
        channel = channels.get(name)
        if channel is None:
            channel = _remember(channels, name, name.decode("latin-1"))
        can_id = identifiers.get(digits)
        if can_id is None:
            can_id = _remember(identifiers, digits, _identifier(digits))
        frame = Frame(can_id, unhexlify(data)) if remote is None else Frame(can_id | REMOTE_FLAG, b"")
        yield LogEntry(number, timestamp_us, channel, frame)
    if number == 0:
        raise LogError(f"{path}: not a candump log: the file is empty")


def _remember(known: dict[bytes, _Value], name: bytes, value: _Value) -> _Value:
    """What a word means, kept for its next time; a log in which every line has another is forgotten."""
    if len(known) >= MOST_KNOWN:
        known.clear()
    known[name] = value
    return value


def _identifier(digits: bytes) -> int:
    number = int(digits, 16)
    return number if len(digits) == 3 or number & ERROR_FLAG else number | EXTENDED_FLAG


def _refusal(path: Path, number: int, text: bytes) -> LogError:
    if len(text) < _LONGEST and not text.endswith(b"\n") and _is_beginning(text):
        return LogTruncatedError(path, number)
    if _FD_LINE.match(text):
        return LogError(f"{path}: line {number} is a CAN FD frame: only classic CAN is read")
    if number == 1:
        return LogError(f"{path}: not a candump log: line 1 is not '(seconds) channel id#data'")
    return LogError(f"{path}: line {number} is no candump line: the log has been altered")


def _is_beginning(text: bytes) -> bool:
    """Whether some ending makes a line of it."""
    return any(_LINE.fullmatch(text + ending) for ending in _ENDINGS)
