"""Faults of the flight software's process, of its memory, and of its clock, which is SYNC."""

import struct
from random import Random
from typing import TYPE_CHECKING, Any

import numpy as np

from fsw.core.packing import field_names
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilFire, Sync
from sim.faults.fault import Condition, Fault, Parameters
from sim.plant.plant import Plant

if TYPE_CHECKING:  # the plant's process, which loads the faults of a scenario, has no flight software
    from fsw.core.state import FlightState


class FswKill(Fault):
    """fsw's process is killed; it boots when the fault is over."""

    def condition(self, tick: int) -> Condition:
        """Dead."""
        return Condition.DEAD


class FswStop(Fault):
    """fsw's process is stopped; when it continues, it receives all frames that were sent meanwhile."""

    def condition(self, tick: int) -> Condition:
        """Stopped."""
        return Condition.STOPPED


class FswKillStorm(Fault):
    """fsw is killed over and over: runs up to ``up`` ticks, is dead up to ``down`` ticks."""

    def __init__(self, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._running, self._until = True, -1

    def condition(self, tick: int) -> Condition:
        """Dead or running."""
        if tick >= self._until:
            self._running = not self._running
            most = self.parameters["up" if self._running else "down"]
            self._until = tick + self.rng.randint(1, round(most))
        return Condition.RUNNING if self._running else Condition.DEAD


class AllRestart(FswKill):
    """fsw and the boards are power-cycled."""

    def end(self, plant: Plant) -> None:
        """The boards boot in the same tick as fsw."""
        for board in ("magnetometer", "sun", "coil", "wheel"):
            plant.restart(board)


class SyncLoss(Fault):
    """SYNC is lost with probability ``part``."""

    def sync(self, tick: int, frame: Frame) -> list[Frame]:
        """Nothing, or SYNC."""
        return [] if self.rng.random() < self.parameters["part"] else [frame]


class SyncRepetition(Fault):
    """SYNC is repeated up to ``times`` times."""

    def sync(self, tick: int, frame: Frame) -> list[Frame]:
        """SYNC and its repetitions."""
        return [frame] * (1 + self.rng.randint(1, round(self.parameters["times"])))


class TickHold(Fault):
    """Each tick is held for ``seconds``; after one with a request, ``rushed`` ticks follow without delay."""

    def __init__(self, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._rush = 0

    def held_ms(self, tick: int) -> int:
        """The whole time, or 0 during a rush."""
        return 0 if self._rush else round(1000 * self.parameters["seconds"])

    def to_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """A request begins a rush."""
        requested = any(frame.can_id == CoilFire.ID for frame in frames)
        self._rush = round(self.parameters["rushed"]) if requested else max(0, self._rush - 1)
        return frames


class TickRepetition(TickHold):
    """As ``TickHold``, and SYNC is repeated while a tick is held."""

    repeats_sync = True


class TickJumps(Fault):
    """The tick in SYNC is off by ``ticks``; its time is that of its tick if ``with_time`` is not 0."""

    _tick_hz = 1

    def begin(self, plant: Plant) -> None:
        """Time goes by its ticks."""
        self._tick_hz = plant.tick_hz

    def sync(self, tick: int, frame: Frame) -> list[Frame]:
        """A wrong SYNC."""
        true = Sync.decode(frame.data)
        off = round(self.parameters["ticks"])
        hz, jumped = self._tick_hz, true.tick + off
        off_s = jumped // hz - true.tick // hz if self.parameters["with_time"] else 0
        return [Sync(max(0, jumped), max(0, true.unix_time_s + off_s)).encode()]


class TimeJumps(Fault):
    """SYNC's time is off by ``seconds``; its tick is right."""

    def sync(self, tick: int, frame: Frame) -> list[Frame]:
        """A SYNC with a wrong time."""
        true = Sync.decode(frame.data)
        return [Sync(true.tick, true.unix_time_s + round(self.parameters["seconds"])).encode()]


class BitFlip(Fault):
    """One bit of one double of the flight state flips, once."""

    _done = False

    def upset(self, state: "FlightState") -> "FlightState":
        """The state with one bit flipped."""
        if self._done:
            return state
        self._done = True
        places = count_doubles(state)
        flipped: FlightState = flip(state, self.rng.randrange(places), self.rng.randrange(64))
        return flipped


def flip_bit(value: float, bit: int) -> float:
    """The double with one bit of its 64 flipped."""
    (word,) = struct.unpack("<Q", struct.pack("<d", value))
    (flipped,) = struct.unpack("<d", struct.pack("<Q", word ^ (1 << bit)))
    return float(flipped)


def count_doubles(value: Any) -> int:  # noqa: ANN401  (any part of a state)
    """How many doubles there are in a state."""
    if isinstance(value, float):
        return 1
    if isinstance(value, np.ndarray):
        return int(value.size)
    return sum(count_doubles(part) for part in _parts(value).values())


def flip(value: Any, place: int, bit: int) -> Any:  # noqa: ANN401  (any part of it)
    """The value with one bit of its double number ``place`` flipped."""
    if isinstance(value, float):
        return flip_bit(value, bit)
    if isinstance(value, np.ndarray):
        flipped = value.copy()
        flipped.flat[place] = flip_bit(float(flipped.flat[place]), bit)
        return flipped
    parts = _parts(value)
    for name, part in parts.items():
        inside = count_doubles(part)
        if place < inside:
            parts[name] = flip(part, place, bit)
            whole = type(value)
            return whole(parts.values()) if whole in (tuple, list) else whole(**parts)
        place -= inside
    raise IndexError(place)


def _parts(value: Any) -> dict[Any, Any]:  # noqa: ANN401  (any part of it)
    """The parts of an object by the names of its fields, or of a tuple or list by place."""
    if value is None or isinstance(
        value, int | str
    ):  # and any member of an enumeration, which is one of them
        return {}
    if type(value) in (tuple, list):
        return dict(enumerate(value))
    return {name: getattr(value, name) for name in field_names(type(value))}
