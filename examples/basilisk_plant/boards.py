"""The bus side of a plant, written from docs/icd.md alone: frames, the loop bus, and three boards.

Nothing of torquer is imported. The coil board is the least that is safe where ticks are the only clock and no
frame is lost, as in lockstep: it has no dead-man, skips no ticks and has no clock of its own. Hardware needs
these (ICD, section 4).
"""

import socket
import struct
import time
from dataclasses import dataclass, field
from typing import NamedTuple, Self

VERSION = 1
HEARTBEAT_S = 60

SYNC, TICK_DONE = 0x180, 0x280
PLANT_BOOT, FSW_BOOT, COIL_BOOT, MAG_BOOT, SUN_BOOT = 0x500, 0x510, 0x520, 0x530, 0x540
PLANT_END, COIL_HEARTBEAT, MAG_HEARTBEAT, SUN_HEARTBEAT = 0x700, 0x620, 0x630, 0x640
COIL_FIRE, COIL_STATUS, COIL_REFUSED, MAG_FIELD, SUN_VECTOR = 0x080, 0x100, 0x108, 0x110, 0x118

Vec3 = tuple[float, float, float]


# --- Frames: section 1 of the ICD


class Frame(NamedTuple):
    """A classic CAN frame."""

    can_id: int
    data: bytes


def _shift(register: int) -> int:
    for _ in range(8):
        register = (register << 1) ^ (0x11D if register & 0x80 else 0)
    return register


_TABLE = [_shift(byte) for byte in range(256)]


def crc8(can_id: int, data: bytes) -> int:
    """CRC-8 over the identifier, high byte first, and the data before the CRC."""
    register = 0xFF
    for byte in can_id.to_bytes(2, "big") + data:
        register = _TABLE[register ^ byte]
    return register ^ 0xFF


def encode(can_id: int, length: int, counter: int, *signals: tuple[int, int, int]) -> Frame:
    """A frame with ``counter`` and CRC; each signal is its first bit, its bits and its raw value."""
    word = counter % 16
    for first_bit, bits, raw in signals:
        word |= (raw & ((1 << bits) - 1)) << first_bit
    data = word.to_bytes(length - 1, "little")
    return Frame(can_id, data + bytes([crc8(can_id, data)]))


def unsigned(data: bytes, first_bit: int, bits: int) -> int:
    """The raw value of an unsigned signal."""
    return (int.from_bytes(data, "little") >> first_bit) & ((1 << bits) - 1)


def signed(data: bytes, first_bit: int, bits: int) -> int:
    """The raw value of a signed signal."""
    raw = unsigned(data, first_bit, bits)
    return raw - (1 << bits) if raw >> (bits - 1) else raw


def intact(frame: Frame, length: int) -> bool:
    """Whether length and CRC are right."""
    return len(frame.data) == length and frame.data[-1] == crc8(frame.can_id, frame.data[:-1])


def sync(tick: int, unix_time_s: int) -> Frame:
    """``SYNC``, which has no counter and no CRC."""
    return Frame(SYNC, struct.pack("<II", tick, unix_time_s))


def boot(can_id: int) -> Frame:
    """A boot message: power on, version of the contract, no table."""
    return encode(can_id, 7, 0, (8, 8, VERSION))


def plant_end(ticks: int) -> Frame:
    """``PLANT_END`` after so many ticks."""
    return encode(PLANT_END, 5, 0, (8, 24, ticks))


# --- The loop bus: a TCP connection to the hub, which the flight software hosts


class LoopBus:
    """One end of the loop bus.

    The hub greets with 16 bytes. From then on each frame is 16 bytes, like ``struct can_frame`` of Linux:
    identifier, number of data bytes, three bytes of padding, eight data bytes.
    """

    GREETING = b"torquer-loop/1\r\n"
    RECORD = struct.Struct("=IB3x8s")

    def __init__(self, port: int, timeout_s: float = 30.0) -> None:
        self._pending = b""
        deadline = time.monotonic() + timeout_s
        while True:
            self._socket = socket.socket()
            try:
                self._socket.connect(("127.0.0.1", port))
                if self._socket.getsockname() != self._socket.getpeername():
                    break  # otherwise TCP has connected the port to itself
            except ConnectionRefusedError:
                pass
            self._socket.close()
            if time.monotonic() > deadline:
                raise TimeoutError(f"no flight software on port {port}")
            time.sleep(0.05)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        greeting = self._socket.recv(len(self.GREETING), socket.MSG_WAITALL)
        if greeting != self.GREETING:
            raise ConnectionError(f"port {port} is not a loop bus: {greeting!r}")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def send(self, frames: list[Frame]) -> None:
        """Send frames in order."""
        records = (self.RECORD.pack(can_id, len(data), data) for can_id, data in frames)
        self._socket.sendall(b"".join(records))

    def receive(self, timeout_s: float) -> list[Frame]:
        """What has come, at least one frame unless the time is over."""
        self._socket.settimeout(timeout_s)
        while len(self._pending) < self.RECORD.size:
            try:
                received = self._socket.recv(65536)
            except TimeoutError:
                return []
            if not received:
                raise ConnectionError("the flight software has left the bus")
            self._pending += received
        whole = len(self._pending) - len(self._pending) % self.RECORD.size
        records, self._pending = self._pending[:whole], self._pending[whole:]
        return [Frame(can_id, data[:length]) for can_id, length, data in self.RECORD.iter_unpack(records)]


# --- The sensors: section 10 of the ICD


@dataclass
class SensorBoard:
    """A board that sends a vector of three axes every tick.

    Args:
        sample_id: identifier of its sample.
        boot_id: of its boot message.
        heartbeat_id: of its heartbeat.
        scale: physical value of one raw unit.
        tick_hz: ticks a second.
    """

    sample_id: int
    boot_id: int
    heartbeat_id: int
    scale: float
    tick_hz: int

    def begin_tick(self, tick: int, vector: Vec3, valid: bool) -> list[Frame]:
        """The frames of this tick; a sample that is not valid is sent as zeros."""
        axes = [round(axis / self.scale) for axis in vector]
        if not valid or not all(-(2**15) <= axis < 2**15 for axis in axes):  # out of range: not valid either
            valid, axes = False, [0, 0, 0]
        signals = [(8 + 16 * place, 16, raw) for place, raw in enumerate(axes)]
        sample = encode(self.sample_id, 8, tick, (4, 1, int(valid)), *signals)
        boots = [boot(self.boot_id)] if tick == 0 else []
        return [*boots, sample, *heartbeat(self.heartbeat_id, tick, self.tick_hz)]


def heartbeat(can_id: int, tick: int, tick_hz: int, state: int = 0, rejects: int = 0) -> list[Frame]:
    """The heartbeat of a board that booted in tick 0 and misses no tick, when it is due."""
    beats, rest = divmod(tick, HEARTBEAT_S * tick_hz)
    if not beats or rest:
        return []
    return [encode(can_id, 8, beats - 1, (4, 4, state), (8, 16, min(rejects, 0xFFFF)), (40, 16, tick))]


# --- The coil driver: sections 3 to 7 of the ICD

MALFORMED, WRONG_TICK, REPEATED_SEQ, BAD_COIL, BAD_LEVEL, BAD_DURATION, COIL_ON, LOCKOUT = range(1, 9)
MOST_REFUSALS = 64
TICK_UNITS = 1000
"""A tick in the units of the timers: then a millisecond is ``tick_hz`` of them, and all are integers."""


@dataclass
class CoilBoard:
    """The pulsed coil driver with a back-off that all coils share, locked out in full at boot.

    In each tick: ``enter``, ``frames``, ``receive`` for each frame of the answer.

    Args:
        tick_hz: ticks a second.
        pulse_ms: longest pulse.
        backoff_ms: from the end of a pulse to the next start.
    """

    tick_hz: int
    pulse_ms: int
    backoff_ms: int
    rejects: int = 0
    _tick: int = 0
    _coil: int = 0
    _level: int = 0
    _remaining: int = 0
    _driven: bool = False
    _lockout: int = 0
    _seq: int | None = None
    _refusals: list[tuple[int, int, int]] = field(default_factory=list)
    _refused: int = 0

    def enter(self, tick: int) -> None:
        """A tick is over: a pulse and the back-off have run on."""
        self._tick = tick
        if tick == 0:
            self._lockout = self.backoff_ms * self.tick_hz
            return
        self._driven = self._remaining > 0
        self._remaining = max(0, self._remaining - TICK_UNITS)
        self._lockout = max(0, self._lockout - TICK_UNITS)

    @property
    def drive(self) -> tuple[int, int, float]:
        """Coil, level, and for what part of the coming tick it is driven, from its start."""
        return self._coil, self._level, min(1.0, self._remaining / TICK_UNITS)

    def frames(self, current_ma: int) -> list[Frame]:
        """The frames of this tick; ``current_ma`` is the current that is measured at its instant."""
        tick, driven = self._tick, self._driven
        status = encode(
            COIL_STATUS,
            8,
            tick,
            (4, 4, self._level if driven else 0),
            (8, 2, self._coil if driven else tick % 3),
            (10, 12, -(-self._remaining // self.tick_hz)),
            (22, 12, current_ma),
            (34, 14, -(-self._lockout // (10 * self.tick_hz))),
            (48, 8, self._seq or 0),
        )
        refused = []
        for coil, seq, reason in self._refusals:
            signals = ((4, 2, coil), (8, 8, seq), (16, 8, reason), (24, 8, tick - 1))
            refused.append(encode(COIL_REFUSED, 5, self._refused, *signals))
            self._refused += 1
        self._refusals = []
        state = 1 if self._remaining else 2 if self._lockout else 0
        boots = [boot(COIL_BOOT)] if tick == 0 else []
        return [*boots, status, *refused, *heartbeat(COIL_HEARTBEAT, tick, self.tick_hz, state, self.rejects)]

    def receive(self, frame: Frame) -> None:
        """Take a frame of the answer to this tick: a request is accepted, or refused with a reason."""
        if frame.can_id != COIL_FIRE:
            return
        data = frame.data
        whole = intact(frame, 7)
        self.rejects += not whole
        if len(data) < 3:
            return
        coil, seq, level = unsigned(data, 8, 2), data[2], signed(data, 4, 4)
        reason = self._judge(coil, seq, level, data[3], unsigned(data, 32, 16)) if whole else MALFORMED
        if reason:
            if len(self._refusals) < MOST_REFUSALS:
                self._refusals.append((coil, seq, reason))
            return
        self._coil, self._level, self._seq = coil, level, seq
        self._remaining = unsigned(data, 32, 16) * self.tick_hz
        self._lockout = self._remaining + self.backoff_ms * self.tick_hz

    def _judge(self, coil: int, seq: int, level: int, tick: int, duration_ms: int) -> int:
        """The first reason to refuse a request; 0 if there is none."""
        reasons = {
            WRONG_TICK: tick != self._tick % 256,
            REPEATED_SEQ: seq == self._seq,
            BAD_COIL: coil > 2,
            BAD_LEVEL: not 1 <= abs(level) <= 3,
            BAD_DURATION: not 0 < duration_ms <= self.pulse_ms,
            COIL_ON: self._remaining > 0,
            LOCKOUT: self._lockout > 0,
        }
        return next((reason for reason, applies in reasons.items() if applies), 0)
