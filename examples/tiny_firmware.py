"""A flight software in some forty lines of the standard library: B-dot with one pulse at a time."""

import socket
import struct
import sys

RECORD = struct.Struct("=IB3x8s")  # struct can_frame: identifier, number of data bytes, 3 spare, data
SYNC, TICK_DONE, MAG_FIELD, COIL_STATUS, COIL_FIRE = 0x180, 0x280, 0x110, 0x100, 0x080
FSW_BOOT, PLANT_BOOT, PLANT_END = 0x510, 0x500, 0x700
SPAN, LEAST_NT = 10, 1300.0  # over so many ticks the field must change by so much, or nothing is fired


def sealed(can_id: int, body: bytes) -> bytes:
    """A record whose data ends with the CRC-8 of identifier and body."""
    register = 0xFF
    for byte in struct.pack(">H", can_id) + body:
        register ^= byte
        for _ in range(8):
            register = (register << 1 ^ (0x1D if register & 0x80 else 0)) & 0xFF
    data = body + bytes([register ^ 0xFF])
    return RECORD.pack(can_id, len(data), data)


def request(tick: int, change: list[float], lockout_ms: list[int], count: int) -> bytes:
    """A pulse of the coil along which the field changes most, against that change; none in its back-off."""
    coil = max(range(3), key=lambda axis: abs(change[axis]))
    if abs(change[coil]) < LEAST_NT or lockout_ms[coil]:
        return b""
    level = -3 if change[coil] > 0.0 else 3
    head = bytes([count & 0xF | (level & 0xF) << 4, coil, count & 0xFF, tick & 0xFF])
    return sealed(COIL_FIRE, head + struct.pack("<H", 3000))


def fly(port: int) -> None:
    """Boot, answer every SYNC, end with the plant."""
    fields, lockout_ms, driven, count = [[0.0] * 3] * SPAN, [1, 1, 1], False, 0
    with socket.create_connection(("127.0.0.1", port)) as bus, bus.makefile("rb") as received:
        assert received.read(16) == b"torquer-loop/1\r\n", "the hub of a loop bus greets so"
        bus.sendall(sealed(FSW_BOOT, struct.pack("<BBI", 0, 1, 0)))
        while record := received.read(RECORD.size):
            can_id, _, data = RECORD.unpack(record)
            if can_id == MAG_FIELD:  # a whole flight software looks at CRC and valid, too
                fields = [*fields[1:], [2.0 * axis for axis in struct.unpack("<3h", data[1:7])]]
            elif can_id == COIL_STATUS:
                driven = data[0] >> 4 != 0
                lockout_ms[data[1] & 3] = (int.from_bytes(data[:7], "little") >> 34 & 0x3FFF) * 10
                lockout_ms = [lockout_ms[data[1] & 3]] * 3 if driven else lockout_ms
            elif can_id == SYNC:
                tick, _ = struct.unpack("<II", data)
                change = [new - old for old, new in zip(fields[0], fields[-1], strict=True)]
                fire = b"" if driven else request(tick, change, lockout_ms, count)
                count += bool(fire)
                bus.sendall(fire + RECORD.pack(TICK_DONE, 8, struct.pack("<II", tick, 0)))
            elif can_id == PLANT_BOOT:
                bus.sendall(sealed(FSW_BOOT, struct.pack("<BBI", 0, 1, 0)))
            elif can_id == PLANT_END:
                return


if __name__ == "__main__":
    fly(int(sys.argv[1]))
