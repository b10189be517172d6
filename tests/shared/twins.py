"""The stub's board and the one in C side by side, with noise on the bus and faults of the current."""

import math
from functools import partial

from firmware_bench import LEVELS_MA, FirmwareBench, loaded

from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import CoilFire
from hil_stub.bench import Bench
from hil_stub.coils.coil_driver import CoilDriver, CoilLimits
from hil_stub.coils.read_back import ReadBack

UNKNOWN_MA = -(2**31)
"""How the board in C is told that a current cannot be measured; the stub is told that it is no number."""


class Currents:
    """What both boards measure: the nominal current, and now and then, for some ticks, another."""

    def __init__(self, random):
        self._random = random
        self._wrong_ma = None
        self._ticks = 0
        self.now_ma = 0

    def measure(self, level):
        nominal_ma = (0, *LEVELS_MA)[abs(level)] * (1 if level > 0 else -1)
        if self._ticks == 0 and self._random.random() < 0.02:
            others = (
                0,
                9,
                11,
                -nominal_ma,
                nominal_ma // 2,
                nominal_ma * 119 // 100,
                nominal_ma * 13 // 10,
                2 * nominal_ma,
                3000,
                -3000,
                2**31 - 1,
            )
            self._wrong_ma = self._random.choice((*others, UNKNOWN_MA))
            self._ticks = self._random.randint(1, 5)
        self.now_ma = nominal_ma
        if self._ticks > 0:
            self._ticks -= 1
            self.now_ma = self._wrong_ma
        return math.nan if self.now_ma == UNKNOWN_MA else self.now_ma / 1000.0


class StubBoard:
    """The stub's board with these currents."""

    def __init__(self, limits, currents):
        self._driver = CoilDriver(limits, ReadBack(tuple(level_ma / 1000.0 for level_ma in LEVELS_MA)))
        self._currents = currents

    def begin_tick(self, tick, clock_ms):
        level = self._driver.drive().level
        return self._driver.begin_tick(tick, self._currents.measure(level), clock_ms)

    def __getattr__(self, name):
        return getattr(self._driver, name)


class Twins:
    """Both boards as one bench, which compares them in all that they do."""

    def __init__(self, setup, library, random, clock_ms=0):
        self._random = random
        self._currents = Currents(random)
        limits = CoilLimits(setup.tick_hz, setup.pulse_ms, setup.backoff_ms, setup.shared)
        self._stub = Bench(partial(StubBoard, limits, self._currents), setup.deadman_ms, has_clock=True)
        self._board = FirmwareBench(loaded(library), clock_ms, current_ma=lambda: self._currents.now_ma)
        self.compared = 0
        self.kinds = set()

    @property
    def pin(self):
        return self._stub.pin

    def switch_on(self, tick=0, now_ms=0):
        stub = self._stub.switch_on(tick, now_ms)
        return self._equal(stub, self._board.switch_on(tick, now_ms), "power on")

    def receive(self, frame, now_ms=0):
        if self._random.random() < 0.1:
            self._receive(noise(frame, self._random), now_ms)
        return self._receive(frame, now_ms)

    def watch(self, now_ms):
        self._stub.watch(now_ms)
        self._board.watch(now_ms)
        self._equal([], [], "time")

    def _receive(self, frame, now_ms):
        return self._equal(self._stub.receive(frame, now_ms), self._board.receive(frame, now_ms), frame)

    def _equal(self, stub, board, on):
        assert board == stub, f"on {on}"
        assert self._board.pin == self._stub.pin, f"on {on}"
        self.compared += len(stub)
        self.kinds |= {frame.can_id for frame in stub}
        return stub


def noise(frame, random):
    """A frame that is none of ours, or hardly one."""
    data = frame.data
    place = random.randrange(len(data))
    return random.choice(
        (
            Frame(
                frame.can_id,
                data[:place] + bytes([data[place] ^ 1 << random.randrange(8)]) + data[place + 1 :],
            ),
            Frame(frame.can_id, data[:place]),
            Frame(frame.can_id, (data + b"\0")[:8]),
            Frame(frame.can_id | random.choice((EXTENDED_FLAG, REMOTE_FLAG, ERROR_FLAG)), data),
            Frame(random.getrandbits(11), random.randbytes(random.randint(0, 8))),
            Frame(CoilFire.ID, random.randbytes(random.randint(0, 8))),
            Frame(0x7FF, b""),
        )
    )
