"""A frame as 16 bytes, laid out like ``struct can_frame``: on a CAN socket and on the loop bus alike."""

from collections.abc import Iterable, Iterator
from struct import Struct

from fsw.wire.frame import Frame

_RECORD = Struct("=IB3x8s")
SIZE = _RECORD.size
MAX_DATA = 8
LENGTH_OFFSET = 4
"""Offset of the number of data bytes in a record."""


def pack(frame: Frame) -> bytes:
    """The record of one frame.

    Raises:
        ValueError: more than 8 data bytes.
    """
    can_id, data = frame.can_id, frame.data
    if len(data) > MAX_DATA:
        raise ValueError(f"a classic CAN frame holds at most {MAX_DATA} data bytes, not {len(data)}")
    return _RECORD.pack(can_id, len(data), data)


def pack_all(frames: Iterable[Frame]) -> bytes:
    """The records of many frames, one after the other."""
    return b"".join(map(pack, frames))


def unpack(records: bytes) -> Iterator[Frame]:
    """The frames of whole records, in order. The data of a remote frame is as many zeros as it asks for."""
    for can_id, length, data in _RECORD.iter_unpack(records):
        yield Frame(can_id, data[:length])
