"""A CAN frame as plain data, and the CRC-8 that seals it."""

from typing import Final, final

from librt.strings import read_i64_le

from fsw.wire.value import Value

EXTENDED_FLAG: Final = 0x8000_0000
REMOTE_FLAG: Final = 0x4000_0000
ERROR_FLAG: Final = 0x2000_0000
"""Flags above the identifier, as in SocketCAN's ``can_id``. A frame that carries one is never ours."""


@final
class Frame(Value):
    """One classic CAN frame: identifier (with SocketCAN's flags) and at most 8 data bytes."""

    FIELDS = ("can_id", "data")
    __slots__ = FIELDS

    def __init__(self, can_id: int, data: bytes) -> None:
        self.can_id = can_id
        self.data = data

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Frame) and self.can_id == other.can_id and self.data == other.data

    def __hash__(self) -> int:
        return hash((self.can_id, self.data))


def _crc8_table(polynomial: int) -> tuple[int, ...]:
    table = bytearray(256)
    for index in range(256):
        remainder = index
        for _ in range(8):
            remainder = (remainder << 1) ^ polynomial if remainder & 0x80 else remainder << 1
            remainder &= 0xFF
        table[index] = remainder
    return tuple(table)  # read faster than bytes


_TABLE: Final = _crc8_table(0x1D)
_BYTE: Final = tuple([bytes((value,)) for value in range(256)])
_TO_EVEN: Final = 1.5 * 2.0**52
"""Beside this the doubles are whole numbers: added and taken away again it rounds."""


def crc8(data: bytes, register: int = 0xFF) -> int:
    """CRC-8 SAE J1850: polynomial 0x1D, initial value 0xFF, final XOR 0xFF.

    Args:
        data: the bytes to protect.
        register: value of the register before ``data``, for a prefix that has been processed already.
    """
    table = _TABLE
    for place in range(len(data)):  # each byte as it is, where an iterator would make an object of it
        register = table[register ^ data[place]]
    return register ^ 0xFF


REMAINDER: Final = crc8(b"\x00")
"""The CRC of any bytes and their own CRC after them."""


def word_of(data: bytes) -> int:
    """The first 7 bytes as a number, little-endian: all of a message but its CRC."""
    if len(data) == 8:  # as most have
        return read_i64_le(data, 0) & 0xFF_FFFF_FFFF_FFFF
    return int.from_bytes(data[:7], "little")


def id_register(can_id: int) -> int:
    """The CRC register after the identifier, two bytes big-endian, has been processed."""
    return crc8(can_id.to_bytes(2, "big")) ^ 0xFF


def seal(can_id: int, word: int, length: int, register: int) -> Frame:
    """A frame of ``length`` bytes: ``word`` little-endian, its last byte replaced by the CRC."""
    payload = word.to_bytes(length - 1, "little")
    return Frame(can_id, payload + _BYTE[crc8(payload, register)])


def raw(value: float, scale: float, low: int, high: int) -> int:
    """``value / scale`` as the nearest integer in ``[low, high]``; what is not a number becomes ``low``.

    The range is within 32 bits; a half is rounded to the even neighbour.
    """
    units = value / scale
    if units >= high:
        return high
    return int(units + _TO_EVEN - _TO_EVEN) if units > low else low
