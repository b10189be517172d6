# SPDX-License-Identifier: Apache-2.0
"""The loop bus: TCP to this machine, records of 16 bytes as struct can_frame of Linux."""

import socket
import struct

GREETING = b"torquer-loop/1\r\n"
RECORD = "@IB3x8s"  # identifier, number of data bytes, 3 spare, data
SIZE = 16
IPPROTO_TCP, TCP_NODELAY = 6, 1  # of Linux; MicroPython does not name them


def fly(flight_software, port):
    """Carry frames between the bus and the flight software, until the flight or the bus ends."""
    bus = socket.socket()
    bus.connect(socket.getaddrinfo("127.0.0.1", port)[0][-1])
    bus.setsockopt(IPPROTO_TCP, TCP_NODELAY, 1)
    try:
        if received(bus) != GREETING:
            raise OSError("the hub of a loop bus greets otherwise")
        send(bus, flight_software.boot())
        record = received(bus)
        while record:
            can_id, length, data = struct.unpack(RECORD, record)
            data = data[:length]
            send(bus, flight_software.take(can_id, data))
            if flight_software.is_end(can_id, data):
                return
            record = received(bus)
    finally:
        bus.close()


def send(bus, frames):
    """All of an answer at once."""
    if frames:
        bus.sendall(b"".join([struct.pack(RECORD, can_id, len(data), data) for can_id, data in frames]))


def received(bus):
    """The next 16 bytes; none: the bus is closed. TCP may cut them anywhere."""
    whole = b""
    while len(whole) < SIZE:
        part = bus.recv(SIZE - len(whole))
        if not part:
            return b""
        whole += part
    return whole
