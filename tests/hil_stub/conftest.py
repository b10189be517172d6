"""A coil driver on a rig: ticks one by one, requests in, what was said and driven out."""

from dataclasses import dataclass

import pytest

from fsw.wire.messages import (
    CLASSES,
    CoilFire,
    CoilHeartbeat,
    CoilRefused,
    CoilStatus,
    intact,
)
from hil_stub.bench import Bench, CoilBoard
from hil_stub.coils.coil_driver import CoilDriver, CoilLimits, Drive


def read_frames(frames):
    """The messages in frames, each of which must be intact."""
    assert all(intact(frame) for frame in frames)
    return [CLASSES[frame.can_id].decode(frame.data) for frame in frames]


@dataclass
class Step:
    """One tick: the messages at its beginning, and the drive over it."""

    said: list
    drive: Drive

    def only(self, kind):
        return [message for message in self.said if isinstance(message, kind)]

    @property
    def status(self):
        (message,) = self.only(CoilStatus)
        return message

    @property
    def refused(self):
        return self.only(CoilRefused)

    @property
    def reasons(self):
        return [message.reason for message in self.refused]

    @property
    def beats(self):
        return self.only(CoilHeartbeat)


class Rig:
    """A board and the tick it is in."""

    def __init__(self, limits, first_tick=0):
        self.board = CoilDriver(limits)
        self.tick = first_tick - 1

    def step(self, *requests, current_a=0.0):
        """The next tick, with requests that come in it."""
        self.tick += 1
        said = read_frames(self.board.begin_tick(self.tick, current_a))
        for request in requests:
            self.board.receive(request.encode())
        return Step(said, self.board.drive())

    def skip_to(self, tick):
        """Ticks without requests, so that ``tick`` is the next."""
        while self.tick < tick - 1:
            assert self.step().drive.level == 0

    def fire(self, coil=1, level=3, seq=1, duration_ms=3000, tick=None):
        """A request that answers the next tick, unless another is named."""
        answered = self.tick + 1 if tick is None else tick
        return CoilFire(level=level, coil=coil, seq=seq, tick=answered & 0xFF, duration_ms=duration_ms)


@pytest.fixture
def rig_with():
    """Makes a rig from limits and a first tick."""
    return Rig


@pytest.fixture
def read():
    """Turns frames into messages."""
    return read_frames


@pytest.fixture
def bench():
    """A coil driver that follows a bus by itself, switched on."""
    bench = Bench(lambda: CoilBoard(CoilLimits(1)))
    bench.switch_on()
    return bench
