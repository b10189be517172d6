"""A flight software of another team: it knows the wire by its bytes alone, from docs/own-firmware.md.

    python firmware.py PORT [MISTAKE]

It brakes a tumble by B-dot with one self-ending pulse at a time; with the mistake "modelled" or "epoch" by a
field of its own over an orbit of its own. The other mistakes are those of teams before their first flight.
"""

import os
import socket
import struct
import sys
import time
from math import cos, pi, radians, sin, sqrt

RECORD = struct.Struct("=IB3x8s")
SYNC, TICK_DONE, MAG_FIELD, COIL_STATUS, COIL_FIRE = 0x180, 0x280, 0x110, 0x100, 0x080
FSW_BOOT, PLANT_BOOT, PLANT_END, REF_ATTITUDE, REF_RATE = 0x510, 0x500, 0x700, 0x120, 0x121

FIELD = {"bytes": ">3h", "unsigned": "<3H"}
PULSE_MS, SPAN, DEAD_NT_PER_S, STRONG_NT_PER_S = 3000, 10, 130.0, 300.0
EPOCH, PERIOD_S, U0, INCLINATION, FIELD_NT = 1742461200, 6052.4, 0.0, radians(98.6), 21_500.0


def sealed(can_id, body):
    register = 0xFF
    for byte in struct.pack(">H", can_id) + body:
        register ^= byte
        for _ in range(8):
            register = (register << 1 ^ (0x1D if register & 0x80 else 0)) & 0xFF
    data = body + bytes([register ^ 0xFF])
    return RECORD.pack(can_id, len(data), data)


def signed(word, first, bits):
    value = word >> first & (1 << bits) - 1
    return value - (1 << bits) if value >> bits - 1 else value


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def connected(port):
    """Tries until the hub listens, and once connected does not try again."""
    while True:
        try:
            return socket.create_connection(("127.0.0.1", port))
        except ConnectionRefusedError:
            time.sleep(0.05)


class Firmware:
    def __init__(self, port, mistake):
        self.mistake, self.restarted = mistake, "RESTARTED" in os.environ
        self.bus = connected(port)
        self.bus.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.received = self.bus.makefile("rb")
        assert self.received.read(16) == b"torquer-loop/1\r\n"
        self.field, self.fields, self.on, self.stuck = None, [], False, False
        self.lockout_ms, self.fires, self.quiet_until = [-1, -1, -1], 0, 0
        if os.environ.get("PATIENCE_S"):
            self.bus.settimeout(float(os.environ["PATIENCE_S"]))
        self.attitude = self.rate = None
        self.boots = 0
        self.boot()

    def boot(self):
        self.boots += 1
        if self.mistake == "boot-gives-up" and self.boots > 3:
            raise TimeoutError
        record = bytearray(sealed(FSW_BOOT, struct.pack("<BBI", 0, 1, 0)))
        record[14] ^= self.mistake in ("boot-crc", "boot-gives-up")
        record[3] |= 0x80 if self.mistake == "boot-extended" else 0  # on a little-endian machine
        record[4] -= self.mistake == "boot-short"
        self.bus.sendall(bytes(record))

    def run(self):
        while record := self.received.read(RECORD.size):
            can_id, _, data = RECORD.unpack(record)
            word = int.from_bytes(data[:7], "little")
            if can_id == MAG_FIELD:
                self.field = struct.unpack(FIELD.get(self.mistake, "<3h"), data[1:7])
            elif can_id == REF_ATTITUDE:
                self.attitude = [signed(word, first, 17) / 65536.0 for first in (5, 22, 39)]
            elif can_id == REF_RATE:
                self.rate = [signed(word, first, 17) / 524288.0 for first in (5, 22, 39)]
            elif can_id == COIL_STATUS:
                level, coil = signed(word, 4, 4), word >> 8 & 3
                self.on = level != 0
                self.lockout_ms[coil] = (word >> 34 & 0x3FFF) * 10
                self.stuck = level == 0 and abs(signed(word, 22, 12)) > 10
            elif can_id == SYNC:
                self.answer(*struct.unpack("<II", data))
            elif can_id == PLANT_BOOT:
                self.boot()
            elif can_id == PLANT_END:
                return

    def answer(self, tick, unix_time_s):
        if self.mistake == "hang" and tick == 150:
            self.mistake = ""
            time.sleep(float(os.environ["HANG_S"]))
        if self.mistake == "restart" and tick == 700 and not self.restarted:
            os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, "RESTARTED": "1"})
        if self.mistake == "dead" and tick >= 3600:
            self.bus.shutdown(socket.SHUT_WR)
            time.sleep(3600.0)
        request = b""
        dot = self.field_change(unix_time_s)
        if dot is not None and tick >= self.quiet_until and (not self.stuck or self.mistake == "stuck"):
            request = self.request(tick, dot)
        if self.mistake == "twice" and request:
            request += self.request(tick, dot)
        named = tick + 1 if self.mistake == "done-next" else tick
        order = ">" if self.mistake == "done-order" else "<"
        done = RECORD.pack(TICK_DONE, 8, struct.pack(f"{order}II", named, 0))
        self.bus.sendall(done + request if self.mistake == "late" else request + done)

    def field_change(self, unix_time_s):
        """Of the field in body axes, nT/s; None: not known."""
        if self.mistake in ("modelled", "epoch"):
            return self.modelled_change(unix_time_s)
        if self.field is None:  # a SYNC that is repeated comes alone
            return None
        self.fields = [*self.fields[-SPAN:], [2.0 * one for one in self.field]]
        if self.on or len(self.fields) <= SPAN:
            return None
        return [(new - old) / SPAN for old, new in zip(self.fields[0], self.fields[-1], strict=True)]

    def modelled_change(self, unix_time_s):
        """B x w, with an axial dipole at the place where the orbit is by its epoch."""
        if self.attitude is None or self.rate is None:
            return None
        epoch = EPOCH - 1800 if self.mistake == "epoch" else EPOCH
        u = U0 + 2.0 * pi * (unix_time_s - epoch) / PERIOD_S
        b = [
            -2.0 * FIELD_NT * sin(INCLINATION) * sin(u),
            FIELD_NT * sin(INCLINATION) * cos(u),
            FIELD_NT * cos(INCLINATION),
        ]
        qv = self.attitude
        q0 = sqrt(max(0.0, 1.0 - sum(one * one for one in qv)))
        along, turned = sum(one * two for one, two in zip(qv, b, strict=True)), cross(qv, b)
        size = sum(one * one for one in qv)
        body = [(q0 * q0 - size) * b[n] + 2.0 * along * qv[n] - 2.0 * q0 * turned[n] for n in range(3)]
        return cross(body, self.rate)

    def request(self, tick, dot):
        axis = max(range(3), key=lambda n: abs(dot[n]))
        size = abs(dot[axis])
        waits = self.mistake == "early" and tick >= 99  # its own timer says so, a second too soon
        if size < DEAD_NT_PER_S or not (waits or self.lockout_ms[axis] == 0):
            return b""
        level = (3 if size > STRONG_NT_PER_S else 2) * (-1 if dot[axis] > 0.0 else 1)
        if self.mistake == "sign":
            level = -level
        coil = {0: 1, 1: 0, 2: 2}[axis] if self.mistake == "axes" else axis
        duration = PULSE_MS + 100 if self.mistake == "long" else PULSE_MS
        order = ">" if self.mistake == "order" else "<"
        self.quiet_until = tick + (102 if self.mistake == "early" else 103)
        body = struct.pack(
            "<BBBB", self.fires & 0xF | (level & 0xF) << 4, coil, self.fires & 0xFF, tick & 0xFF
        ) + struct.pack(f"{order}H", duration)
        self.fires += 1
        return sealed(COIL_FIRE, body)


if __name__ == "__main__":
    try:
        Firmware(int(sys.argv[1]), (sys.argv[2:] or [""])[0]).run()
    except TimeoutError:
        sys.exit("the plant does not go on")
