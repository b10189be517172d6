"""Faults of the bus: frames altered on their way, and frames of nodes that do not belong on the bus."""

from collections.abc import Callable
from functools import partial
from random import Random

from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import CLASSES, SENDERS, CoilFire, PlantEnd, Sync, TickDone
from sim.faults.fault import Fault, Parameters

# --- Forged messages that control a flight: the plant's SYNC and PLANT_END, and TICK_DONE of fsw

MOST_TICKS = 2**24
LAST_TICK = 2**32 - 1
NEAR_TICKS = 10_000
"""Counts nearer to the true one than this may fit ticks that were lost."""


class ForgedSync(Fault):
    """``count`` forged SYNCs precede the true one, in each tick with probability ``part``.

    The first is ``ticks`` from the true one, or random if ``ticks`` is 0; each further one is ``step`` later.
    """

    def strangers(self, tick: int) -> list[Frame]:
        """The forged SYNCs."""
        rng, parameters = self.rng, self.parameters
        if rng.random() >= parameters["part"]:
            return []
        off, step = round(parameters["ticks"]), round(parameters["step"])
        first = max(0, tick + off) if off else rng.randrange(LAST_TICK - 10)
        return [Sync(first + step * i, first & 0xFFFF).encode() for i in range(round(parameters["count"]))]


class ForgedEnd(Fault):
    """A PLANT_END in each tick, with any count except those that may be true."""

    def strangers(self, tick: int) -> list[Frame]:
        """The forged PLANT_END."""
        ticks = (tick + self.rng.randrange(NEAR_TICKS, MOST_TICKS - NEAR_TICKS)) % MOST_TICKS
        return [PlantEnd(ticks, counter=tick & 0xF).encode()]


class ForgedTickDone(Fault):
    """TICK_DONE of this tick under the identifier of fsw, in each tick with probability ``part``."""

    def strangers(self, tick: int) -> list[Frame]:
        """The forged TICK_DONE."""
        if self.rng.random() >= self.parameters["part"]:
            return []
        return [TickDone(tick, self.rng.getrandbits(32)).encode()]


# --- Frames lost, late, altered, added

FULL = 8
IDS = 0x800
_OF_FSW = {can_id for can_id, sender in SENDERS.items() if sender == "FSW"}
Tamper = Callable[[list[Frame], Random, Parameters], list[Frame]]


def lose(frames: list[Frame], rng: Random, parameters: Parameters) -> list[Frame]:
    """Each frame is lost with probability ``part``."""
    return [frame for frame in frames if rng.random() >= parameters["part"]]


def duplicate(frames: list[Frame], rng: Random, parameters: Parameters) -> list[Frame]:
    """Each frame comes a second time with probability ``part``."""
    return [copy for frame in frames for copy in [frame] * (1 + (rng.random() < parameters["part"]))]


def reorder(frames: list[Frame], rng: Random, parameters: Parameters) -> list[Frame]:
    """The frames of a tick come in random order."""
    return rng.sample(frames, len(frames))


def corrupt(frames: list[Frame], rng: Random, parameters: Parameters) -> list[Frame]:
    """Bits of the data are flipped, in each frame with probability ``part``."""
    return [_flip_bits(frame, rng) if rng.random() < parameters["part"] else frame for frame in frames]


def resize(frames: list[Frame], rng: Random, parameters: Parameters) -> list[Frame]:
    """Each frame has a wrong length with probability ``part``."""
    return [_resize(frame, rng) if rng.random() < parameters["part"] else frame for frame in frames]


def readdress(frames: list[Frame], rng: Random, parameters: Parameters) -> list[Frame]:
    """Each frame gets an unassigned identifier with probability ``part``."""
    unknown = [can_id for can_id in range(IDS) if can_id not in CLASSES]
    return [
        Frame(rng.choice(unknown), frame.data) if rng.random() < parameters["part"] else frame
        for frame in frames
    ]


def set_flag(flag: int, frames: list[Frame], rng: Random, parameters: Parameters) -> list[Frame]:
    """Each frame gets a flag, so that it is no data frame of the contract, with probability ``part``."""
    return [
        Frame(frame.can_id | flag, b"" if flag == REMOTE_FLAG else frame.data)
        if rng.random() < parameters["part"]
        else frame
        for frame in frames
    ]


def _flip_bits(frame: Frame, rng: Random) -> Frame:
    """The frame with one to four bits of its data flipped; without data it is as it was."""
    if not frame.data:
        return frame
    data = bytearray(frame.data)
    for _ in range(rng.randint(1, 4)):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return Frame(frame.can_id, bytes(data))


def _resize(frame: Frame, rng: Random) -> Frame:
    length = rng.choice([length for length in range(FULL + 1) if length != len(frame.data)])
    return Frame(frame.can_id, (frame.data + rng.randbytes(FULL))[:length])


class FrameTampering(Fault):
    """Tampers with the frames of both directions in the same way."""

    def __init__(self, tamper: Tamper, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._tamper = tamper

    def from_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """Tamper."""
        return self._tamper(frames, self.rng, self.parameters)

    def to_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """Tamper."""
        return self._tamper(frames, self.rng, self.parameters)


class Bursts(Fault):
    """Nothing gets through for some ticks, then all for some ticks, each up to ``ticks``."""

    def __init__(self, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._open, self._until = True, -1

    def from_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """All frames, or none."""
        if tick >= self._until:
            self._open = not self._open
            self._until = tick + self.rng.randint(1, round(self.parameters["ticks"]))
        return frames if self._open else []

    def to_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """All frames, or none."""
        return frames if self._open else []


class FrameDelay(Fault):
    """Each frame of either direction is ``ticks`` ticks late; with ``jitter`` 0 to ``ticks``, at random."""

    def __init__(self, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._inward: list[tuple[int, Frame]] = []
        self._outward: list[tuple[int, Frame]] = []

    def from_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """What is due."""
        return self._due(self._inward, tick, frames)

    def to_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """What is due."""
        return self._due(self._outward, tick, frames)

    def _due(self, queue: list[tuple[int, Frame]], tick: int, frames: list[Frame]) -> list[Frame]:
        most = round(self.parameters["ticks"])
        jitter = bool(self.parameters["jitter"])
        queue += [(tick + (self.rng.randint(0, most) if jitter else most), frame) for frame in frames]
        due = [frame for at, frame in queue if at <= tick]
        queue[:] = [(at, frame) for at, frame in queue if at > tick]
        return due


class SampleDelay(FrameDelay):
    """The frames of ``can_id`` are ``ticks`` ticks late: at first none, then the old ones, counters in order.

    With ``jitter`` each is 0 to ``ticks`` ticks late, at random.
    """

    def __init__(self, can_id: int, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._can_id = can_id

    def from_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """The other frames, and the samples that are due."""
        samples = [frame for frame in frames if frame.can_id == self._can_id]
        others = [frame for frame in frames if frame.can_id != self._can_id]
        return others + super().from_boards(tick, samples)

    def to_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """All frames."""
        return frames


class LinkDown(Fault):
    """The interface is down: nothing gets through, not even SYNC."""

    def from_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """Nothing."""
        return []

    def to_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """Nothing."""
        return []

    def sync(self, tick: int, frame: Frame) -> list[Frame]:
        """Nothing."""
        return []


class QueueFull(Fault):
    """ENOBUFS: the interface's queue takes only the first frames of each answer of fsw."""

    def to_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """The first frames."""
        return frames[: self.rng.randint(0, len(frames))]


class RandomFrames(Fault):
    """A stranger sends ``frames`` random frames a tick: any identifier but SYNC's, any flags, any data.

    With ``as_fsw`` 0 it does not use the identifiers of fsw, so that the senders in a log stay distinct.
    """

    def __init__(self, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        taken = {Sync.ID} | (set() if parameters["as_fsw"] else _OF_FSW)
        self._can_ids = [can_id for can_id in CLASSES if can_id not in taken]
        self._any = [can_id for can_id in range(IDS) if can_id not in taken]

    def strangers(self, tick: int) -> list[Frame]:
        """Random frames."""
        return [self._frame() for _ in range(round(self.parameters["frames"]))]

    def _frame(self) -> Frame:
        rng = self.rng
        data = rng.randbytes(rng.randint(0, FULL))
        if rng.random() < 0.5:  # half of them on identifiers of the contract
            return Frame(rng.choice(self._can_ids), data)
        match rng.choice((0, 0, EXTENDED_FLAG, REMOTE_FLAG, ERROR_FLAG)):
            case 0:
                return Frame(rng.choice(self._any), data)
            case flag if flag == EXTENDED_FLAG:
                return Frame(rng.randrange(1 << 29) | flag, data)
            case flag if flag == REMOTE_FLAG:
                return Frame(rng.choice(self._any) | flag, b"")
            case flag:
                return Frame(rng.choice(self._any) | flag, data)


class Flood(Fault):
    """A babbling node sends ``frames`` frames a tick under one identifier, which nobody else has."""

    def strangers(self, tick: int) -> list[Frame]:
        """The same frame over and over."""
        return [Frame(0x001, bytes(FULL))] * round(self.parameters["frames"])


class ForgedRequests(Fault):
    """Another node sends well-formed COIL_FIRE on fsw's identifier, ``frames`` a tick."""

    def strangers(self, tick: int) -> list[Frame]:
        """Requests that answer this tick."""
        rng = self.rng
        return [
            CoilFire(
                rng.choice((-3, -2, -1, 1, 2, 3)),
                rng.randrange(3),
                rng.randrange(256),
                tick & 0xFF,
                rng.choice((3000, 1500, 3001, 40000)),
                rng.randrange(16),
            ).encode()
            for _ in range(round(self.parameters["frames"]))
        ]


def sample_delay(can_id: int) -> Callable[[Random, Parameters], Fault]:
    """A delay of the samples of one sensor."""
    return partial(SampleDelay, can_id)


def frame_fault(tamper: Tamper) -> Callable[[Random, Parameters], Fault]:
    """A fault that tampers with frames."""
    return partial(FrameTampering, tamper)


def flag_fault(flag: int) -> Callable[[Random, Parameters], Fault]:
    """A fault that sets a flag of SocketCAN."""
    return partial(FrameTampering, partial(set_flag, flag))
