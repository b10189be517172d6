"""A plant in some forty lines of the standard library: a steady field, no coils. It prints the answers."""

import select
import socket
import struct
import sys

RECORD = struct.Struct("=IB3x8s")  # struct can_frame: identifier, number of data bytes, 3 spare, data
SYNC, TICK_DONE, MAG_FIELD, FSW_BOOT, PLANT_BOOT, PLANT_END = 0x180, 0x280, 0x110, 0x510, 0x500, 0x700


def sealed(can_id: int, body: bytes) -> bytes:
    """A record whose data ends with the CRC-8 of identifier and body."""
    register = 0xFF
    for byte in struct.pack(">H", can_id) + body:
        register ^= byte
        for _ in range(8):
            register = (register << 1 ^ (0x1D if register & 0x80 else 0)) & 0xFF
    data = body + bytes([register ^ 0xFF])
    return RECORD.pack(can_id, len(data), data)


def fly(port: int, ticks: int, epoch_unix_s: int) -> None:
    """Boot, send so many ticks in lockstep, end."""
    with socket.create_connection(("127.0.0.1", port)) as bus, bus.makefile("rb") as received:
        assert received.read(16) == b"torquer-loop/1\r\n", "the hub of a loop bus greets so"
        while not select.select([bus], [], [], 0.25)[0]:  # one soon after its boot is not answered
            bus.sendall(sealed(PLANT_BOOT, bytes([0, 1, 0, 0, 0, 0])))

        def wait_for(last: int) -> None:
            can_id = -1
            while can_id != last:
                can_id, length, data = RECORD.unpack(received.read(RECORD.size))
                print(f"{can_id:03X}#{data[:length].hex().upper()}")

        wait_for(FSW_BOOT)
        for tick in range(ticks):
            field = struct.pack("<B3h", tick % 16 | 1 << 4, 10_000, -5_000, 8_000)  # valid; 2 nT each
            sync = RECORD.pack(SYNC, 8, struct.pack("<II", tick, epoch_unix_s + tick))
            bus.sendall(sealed(MAG_FIELD, field) + sync)
            wait_for(TICK_DONE)
        bus.sendall(sealed(PLANT_END, struct.pack("<BI", 0, ticks)[:4]))


if __name__ == "__main__":
    try:
        fly(*map(int, sys.argv[1:]))
    except ConnectionRefusedError:
        sys.exit(f"nothing listens on port {sys.argv[1]}: start torquer fsw --bus loop:{sys.argv[1]} first")
