"""One frame as a line of text: the format of can-utils' ``candump -l``.

    (1427513417.000000) vcan0 110#133E0014F79838B7

An 11-bit identifier has three hex digits, an extended one eight; an error frame has eight, SocketCAN's error
flag among them; a remote frame has ``R`` in place of data. Newer candumps append the direction (``R`` or
``T``), pad the channel, write nanoseconds or mark a raw DLC (``_9``): that is read, and dropped.
"""

import re
from typing import TypeVar

from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame

LONGEST = 256
"""Bytes: no line is longer, so that a longer one is refused without being read to its end."""
MOST_REMEMBERED = 4096
"""Words that a reader remembers."""

_LINE = re.compile(
    rb"\((\d{1,12})\.(\d{6})(?:\d{3})?\) +(\S{1,64}) "
    rb"([0-7][0-9A-Fa-f]{2}|[0-3][0-9A-Fa-f]{7})#"
    rb"(?:((?:[0-9A-Fa-f]{2}){0,8})|(R)[0-8]?)(?:_[9A-Fa-f])?(?: [RT])?\r?\n"
)
_FD_LINE = re.compile(rb"\(\d{1,12}\.\d{6}(?:\d{3})?\) +\S{1,64} [0-9A-Fa-f]{3,8}##")
_TEMPLATES = (b"(0.000000) c 000#00\n", b"(0.000000) c 00000000#00\n", b"_9\n", b" R\n")
_ENDINGS = frozenset(template[cut:] for template in _TEMPLATES for cut in range(len(template)))

_DIGITS = [f"{can_id:03X}" for can_id in range(0x800)]
"""By identifier of 11 bits: formatting each anew takes longer than the rest of its line."""

_Value = TypeVar("_Value")


LoggedFrame = tuple[int, str, Frame]
"""What a line holds: the time in whole microseconds, the channel and the frame."""


class LineReader:
    """Reads lines one by one; recurring words are converted once."""

    def __init__(self) -> None:
        self._identifiers: dict[bytes, int] = {}
        self._channels: dict[bytes, str] = {}
        self._stamp: tuple[bytes, bytes] = (b"", b"")
        self._timestamp_us = 0

    def read(self, text: bytes) -> LoggedFrame | None:
        """The frame of a line that ends with its newline; None if it is not such a line."""
        found = _LINE.fullmatch(text)
        if found is None:
            return None
        seconds, microseconds, name, digits, data, remote = found.groups()
        if self._stamp != (seconds, microseconds):
            self._stamp = (seconds, microseconds)
            self._timestamp_us = int(seconds) * 1_000_000 + int(microseconds)
        channel = self._channels.get(name)
        if channel is None:
            channel = _remember(self._channels, name, name.decode("latin-1"))
        can_id = self._identifiers.get(digits)
        if can_id is None:
            can_id = _remember(self._identifiers, digits, _identifier(digits))
        frame = (
            Frame(can_id, bytes.fromhex(data.decode()))
            if remote is None
            else Frame(can_id | REMOTE_FLAG, b"")
        )
        return self._timestamp_us, channel, frame


def format_time(timestamp_us: int) -> str:
    """The timestamp as it stands between the parentheses."""
    seconds, microseconds = divmod(timestamp_us, 1_000_000)
    return f"{seconds:010d}.{microseconds:06d}"


def format_line(timestamp: str, channel: str, frame: Frame) -> str:
    """One line of the log, with its newline.

    Args:
        timestamp: as ``format_time`` gives it.
        channel: name of the bus, without spaces.
        frame: any classic frame; of a remote frame the length is lost.
    """
    return format_lines(timestamp, channel, [frame])


def format_lines(timestamp: str, channel: str, frames: list[Frame]) -> str:
    """The lines of frames that share a time stamp."""
    beginning = f"({timestamp}) {channel} "
    return "".join([f"{beginning}{frame_text(frame)}\n" for frame in frames])


def frame_text(frame: Frame) -> str:
    """Identifier and data, ``180#0000000000000000``; of a remote frame ``R`` in place of the data."""
    can_id, data = frame.can_id, frame.data
    if can_id < len(_DIGITS):
        return f"{_DIGITS[can_id]}#{data.hex().upper()}"
    payload = "R" if can_id & REMOTE_FLAG else data.hex().upper()
    number = can_id & ~(EXTENDED_FLAG | REMOTE_FLAG)
    width = 8 if can_id & (EXTENDED_FLAG | ERROR_FLAG) else 3
    return f"{number:0{width}X}#{payload}"


def is_beginning(text: bytes) -> bool:
    """Whether ``text`` is a line that has been cut short: some ending completes it."""
    return any(_LINE.fullmatch(text + ending) for ending in _ENDINGS)


def is_fd(text: bytes) -> bool:
    """Whether it is the line of a CAN FD frame, which is not read."""
    return _FD_LINE.match(text) is not None


def _remember(words: dict[bytes, _Value], word: bytes, value: _Value) -> _Value:
    """What a word means, stored for its next occurrence; a full store is cleared first."""
    if len(words) >= MOST_REMEMBERED:
        words.clear()
    words[word] = value
    return value


def _identifier(digits: bytes) -> int:
    number = int(digits, 16)
    return number if len(digits) == 3 or number & ERROR_FLAG else number | EXTENDED_FLAG
