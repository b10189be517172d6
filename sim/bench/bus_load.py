"""How many bits a frame is on a CAN bus, stuff bits included."""

from fsw.wire.frame import EXTENDED_FLAG, REMOTE_FLAG, Frame

BITRATE = 125_000
"""Of a CAN bus that a nanosatellite has; the load is stated as a part of it."""
_AFTER_CRC = 1 + 2 + 7 + 3
"""CRC delimiter, acknowledge slot and its delimiter, end of frame, interframe space: never stuffed."""


def frame_bits(frame: Frame) -> int:
    """Bits of a classic frame from start of frame to interframe space (ISO 11898-1).

    From start of frame to the end of the CRC a bit of the other value follows five that are equal.
    """
    stuffed = _with_crc(_header_and_data(frame))
    stuff = run = 0
    last = ""
    for bit in stuffed:
        run = run + 1 if bit == last else 1
        last = bit
        if run == 5:
            stuff += 1
            last, run = ("1" if bit == "0" else "0"), 1
    return len(stuffed) + stuff + _AFTER_CRC


def _header_and_data(frame: Frame) -> str:
    remote = bool(frame.can_id & REMOTE_FLAG)
    length = f"{len(frame.data):04b}"
    data = "" if remote else "".join(f"{byte:08b}" for byte in frame.data)
    if frame.can_id & EXTENDED_FLAG:
        identifier = f"{frame.can_id & 0x1FFF_FFFF:029b}"
        return f"0{identifier[:11]}11{identifier[11:]}{int(remote)}00{length}{data}"
    return f"0{frame.can_id & 0x7FF:011b}{int(remote)}00{length}{data}"


def _with_crc(bits: str) -> str:
    register = 0
    for bit in bits:
        feedback = (register >> 14 & 1) ^ (bit == "1")
        register = register << 1 & 0x7FFF
        if feedback:
            register ^= 0x4599
    return f"{bits}{register:015b}"
