# SPDX-License-Identifier: Apache-2.0
"""A flight software for MicroPython: B-dot, paid in the pulses of PoSAT-1. Frames go in, frames come out.

    micropython main.py PORT

A frame is an identifier and its data, as bytes. There is no clock: time is the tick that SYNC names.
"""

import struct
import sys

import satellite
from pulses import DURATION_MS, TICK_S, Scheduler, cross

COIL_FIRE, COIL_STATUS, MAG_FIELD, SYNC, TICK_DONE = 0x080, 0x100, 0x110, 0x180, 0x280
PLANT_BOOT, FSW_BOOT, COIL_BOOT, PLANT_END = 0x500, 0x510, 0x520, 0x700
LENGTHS = {COIL_STATUS: 8, MAG_FIELD: 8, PLANT_BOOT: 7, COIL_BOOT: 7, PLANT_END: 5}
TESLA_PER_LSB = 2.0e-9
CONTRACT_VERSION = 1


def crc_of(can_id, body):
    """CRC-8 of a message: polynomial 0x1D, over its identifier and what stands before the CRC."""
    register = 0xFF
    for byte in struct.pack(">H", can_id) + body:
        register ^= byte
        for _ in range(8):
            register = (register << 1 ^ (0x1D if register & 0x80 else 0)) & 0xFF
    return register ^ 0xFF


def sealed(can_id, body):
    return can_id, body + bytes([crc_of(can_id, body)])


def is_intact(can_id, data):
    return len(data) == LENGTHS.get(can_id) and crc_of(can_id, data[:-1]) == data[-1]


def signed(word, first, bits):
    """A signal of a message, its data being one number."""
    value = word >> first & (1 << bits) - 1
    return value - (1 << bits) if value >> bits - 1 else value


class FlightSoftware:
    """All that it knows, from boot on."""

    def __init__(self):
        self._boots = 0
        self._fires = 0
        self._begin()

    def boot(self):
        """The first frames."""
        body = struct.pack("<BBI", self._boots & 0xF, CONTRACT_VERSION, 0)
        self._boots += 1
        return [sealed(FSW_BOOT, body)]

    def take(self, can_id, data):
        """The frames that answer this one, in order."""
        if can_id == SYNC and len(data) == 8:
            return self._take_sync(struct.unpack("<II", data)[0])
        if not is_intact(can_id, data):
            return []
        if can_id == PLANT_BOOT:
            return self._take_plant_boot()
        if can_id == COIL_BOOT:  # a board that boots counts anew, and is locked out
            self._lockout_ms = [None, None, None]
            self._counters.pop(COIL_STATUS, None)
        elif self._counters.get(can_id) != data[0] & 0xF:  # else it is repeated
            self._counters[can_id] = data[0] & 0xF
            self._take_reading(can_id, data)
        return []

    def is_end(self, can_id, data):
        """Whether the flight is over with this frame; noise may look like one."""
        if can_id != PLANT_END or self._tick is None or not is_intact(can_id, data):
            return False
        ticks = int.from_bytes(data[1:4], "little")
        return (ticks - self._tick - 1) & 0xFFFFFF <= satellite.LEAP_TICKS

    # --- what is known

    def _begin(self):
        """The tick count begins: whatever was known is of another time."""
        self._scheduler = Scheduler()
        self._counters = {}  # of the last frame, by identifier
        self._lockout_ms = [None, None, None]  # as the board has reported since it booted
        self._seq = 0  # of the last request that it accepted
        self._tick = self._strange_tick = None
        self._is_asked = False
        self._fields = []  # fresh samples of the field: tick, and nT / 2 in body axes
        self._clear()

    def _clear(self):
        """A tick begins: nothing has been said in it."""
        self._reading = None
        self._is_off = self._is_stuck = self._has_status = False

    def _take_reading(self, can_id, data):
        word = int.from_bytes(data, "little")
        if can_id == MAG_FIELD:
            self._reading = struct.unpack("<hhh", data[1:7]) if word >> 4 & 1 else None
        elif can_id == COIL_STATUS and word >> 8 & 3 < 3:
            idle = signed(word, 4, 4) == 0
            quiet = abs(signed(word, 22, 12)) <= satellite.OFF_MA
            self._has_status, self._is_off, self._is_stuck = True, idle and quiet, idle and not quiet
            self._lockout_ms[word >> 8 & 3] = 10 * (word >> 34 & 0x3FFF)
            self._seq = word >> 48 & 0xFF

    # --- the count of ticks

    def _take_plant_boot(self):
        """The plant asks who is there. In flight once alone is noise: it asks until it is answered."""
        if self._tick is not None and not self._is_asked:
            self._is_asked = True
            return []
        if self._is_asked:
            self._begin()
        return self.boot()

    def _take_sync(self, tick):
        ahead = 1 if self._tick is None else (tick - self._tick) & 0xFFFFFFFF
        if ahead == 0:  # the plant has not received the answer
            answer = [self._done()]
        elif ahead == 1:
            answer = self._enter(tick)
        elif ahead <= satellite.LEAP_TICKS or self._counts_anew(tick):
            left = self._tick
            if ahead > satellite.LEAP_TICKS:
                self._begin()
            answer = self._enter(tick)  # those between were lost,
            self._strange_tick = left  # or SYNC was forged, and the true count goes on from the last
        else:
            self._strange_tick, answer = tick, []
        self._clear()
        return answer

    def _counts_anew(self, tick):
        """A second SYNC goes on from the one that was ignored."""
        return self._strange_tick is not None and (tick - self._strange_tick) & 0xFFFFFFFF <= 1

    def _enter(self, tick):
        if self._tick is not None:
            self._scheduler.tick()
        self._tick, self._strange_tick, self._is_asked = tick, None, False
        self._fields = [sample for sample in self._fields if tick - sample[0] <= satellite.SPAN_TICKS]
        if self._reading and self._is_off:  # coils that are on add a field of their own
            self._fields.append((tick, self._reading))
        if self._is_stuck:  # whatever is owed, coils that do not obey cannot pay it
            self._scheduler.forget()
            return [self._done()]
        return self._actuate() + [self._done()]

    # --- what is to be done

    def _actuate(self):
        """At most one request, when the own timer and the board's last report of the coil agree."""
        if not self._fields:
            return []
        b_t = [TESLA_PER_LSB * axis for axis in self._fields[-1][1]]
        torque_nm = cross(self._bdot_am2(), b_t)
        self._scheduler.owe(torque_nm, b_t)
        coil, level = self._scheduler.choose(torque_nm, b_t)
        if level == 0 or not self._has_status or self._lockout_ms[coil] != 0:
            return []
        self._scheduler.fire(coil, level, b_t)
        return [self._fire(coil, level)]

    def _bdot_am2(self):
        """The dipole against the change of the field, body axes; of a single sample none."""
        (first, before), (last, now) = self._fields[0], self._fields[-1]
        if first == last:
            return [0.0, 0.0, 0.0]
        gain = -satellite.K_W * TESLA_PER_LSB / ((last - first) * TICK_S)
        return [gain * (now[n] - before[n]) for n in range(3)]

    # --- what is sent

    def _fire(self, coil, level):
        head = self._fires & 0xF | (level & 0xF) << 4
        seq = (self._seq + 1) & 0xFF
        self._fires += 1
        return sealed(COIL_FIRE, struct.pack("<BBBBH", head, coil, seq, self._tick & 0xFF, DURATION_MS))

    def _done(self):
        return TICK_DONE, struct.pack("<II", self._tick, 0)


if __name__ == "__main__":  # a board runs this at power-on: with the module of its bus in place of this one
    import loop_bus

    loop_bus.fly(FlightSoftware(), int(sys.argv[1]))
