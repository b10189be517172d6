"""Faults of sensors, coils and boards."""

from collections.abc import Callable
from functools import partial
from math import inf, nan, sqrt
from random import Random
from typing import Literal

from fsw.wire.frame import Frame
from fsw.wire.messages import SENDERS, MagField, SunVector
from sim.faults.fault import Fault, Parameters
from sim.plant.hardware.actuators import Driven
from sim.plant.plant import Plant
from sim.plant.rotation import ZERO, Vec3, matrix, transform

BoardName = Literal["magnetometer", "sun", "coil"]
_NODE: dict[BoardName, str] = {"magnetometer": "MAG", "sun": "SUN", "coil": "COIL"}
T_PER_NT = 1e-9
FULL_FIELD_NT, FULL_SUN = 65534.0, 1.9999
Reading = Callable[[Vec3, Parameters], Vec3]


def with_axis(v: Vec3, parameters: Parameters, value: float) -> Vec3:
    """The vector with another value on the axis that is faulty."""
    axis = round(parameters["axis"])
    return (value if axis == 0 else v[0], value if axis == 1 else v[1], value if axis == 2 else v[2])


def not_a_number(v: Vec3, parameters: Parameters) -> Vec3:
    """NaN on one axis."""
    return with_axis(v, parameters, nan)


def infinite(v: Vec3, parameters: Parameters) -> Vec3:
    """Infinity on one axis."""
    return with_axis(v, parameters, inf)


def scaled(v: Vec3, parameters: Parameters) -> Vec3:
    """One axis reads ``scale`` times too much; -1 is a wrong sign."""
    return with_axis(v, parameters, v[round(parameters["axis"])] * parameters["scale"])


def swapped(v: Vec3, parameters: Parameters) -> Vec3:
    """The axis that is faulty and the next one change places."""
    first = round(parameters["axis"])
    second = (first + 1) % 3
    order = [second if axis == first else first if axis == second else axis for axis in range(3)]
    return (v[order[0]], v[order[1]], v[order[2]])


def shifted(v: Vec3, parameters: Parameters) -> Vec3:
    """One axis reads a field of ``nt`` too much."""
    return with_axis(v, parameters, v[round(parameters["axis"])] + parameters["nt"] * T_PER_NT)


def clipped(v: Vec3, parameters: Parameters) -> Vec3:
    """No axis reads more than ``nt``, and nothing tells."""
    most = parameters["nt"] * T_PER_NT
    return (min(max(v[0], -most), most), min(max(v[1], -most), most), min(max(v[2], -most), most))


class FieldReads(Fault):
    """The magnetometer reads something else, and calls it valid."""

    def __init__(self, reading: Reading, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._reading = reading

    def field(self, b_body_t: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The wrong reading."""
        return self._reading(b_body_t, self.parameters), valid


class SunReads(Fault):
    """The Sun sensor reads something else where it sees the Sun."""

    def __init__(self, reading: Reading, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._reading = reading

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The wrong reading."""
        return (self._reading(sun_body, self.parameters), True) if valid else (sun_body, False)


class FieldFrozen(Fault):
    """The magnetometer shows its last value for ever."""

    _last: Vec3 | None = None

    def field(self, b_body_t: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The value at the fault's beginning."""
        self._last = self._last or b_body_t
        return self._last, True


class SunFrozen(Fault):
    """The Sun sensor shows its last value for ever, in eclipse too."""

    _last: Vec3 | None = None

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The value at the fault's beginning."""
        self._last = self._last or (sun_body if valid else (0.0, 1.0, 0.0))
        return self._last, True


class SunTilted(Fault):
    """The direction is pulled by up to ``part`` towards the Earth, lit or not: albedo blinds the sensor."""

    _plant: Plant

    def begin(self, plant: Plant) -> None:
        """Whose attitude tells where the Earth is."""
        self._plant = plant

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The Sun and the Earth mixed; where there is no Sun, the Earth."""
        down = transform(matrix(self._plant.truth().q_body_from_orbit), (-1.0, 0.0, 0.0))
        part = self.parameters["part"] if valid else 1.0
        x, y, z = ((1.0 - part) * s + part * e for s, e in zip(sun_body, down, strict=True))
        length = sqrt(x * x + y * y + z * z)
        return (x / length, y / length, z / length), True


class SunUnseen(Fault):
    """The Sun sensor sees nothing."""

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """Darkness."""
        return ZERO, False


class ExtremeCodes(Fault):
    """Frames of one sensor (``sun`` 0 or 1) bear the extremes of their codes, called valid, the CRC right."""

    def from_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """Whole frames with impossible values."""
        return [self._extreme(frame) for frame in frames]

    def _extreme(self, frame: Frame) -> Frame:
        a, b, c = (self.rng.choice((-1.0, 1.0)) for _ in range(3))
        sun = bool(self.parameters["sun"])
        if frame.can_id == MagField.ID and not sun:
            counter = MagField.decode(frame.data).counter
            return MagField(1, a * FULL_FIELD_NT, b * FULL_FIELD_NT, c * FULL_FIELD_NT, counter).encode()
        if frame.can_id == SunVector.ID and sun:
            counter = SunVector.decode(frame.data).counter
            return SunVector(1, a * FULL_SUN, b * FULL_SUN, c * FULL_SUN, counter).encode()
        return frame


class CoilOpen(Fault):
    """A coil is cut: no current flows."""

    def driven(self, driven: Driven) -> Driven:
        """Without this coil's current."""
        return Driven(with_axis(driven.current_a, self.parameters, 0.0), driven.fraction)


class CoilWired(Fault):
    """A coil gives ``scale`` of its dipole for the same current: -1 is reversed, below 1 weak."""

    def begin(self, plant: Plant) -> None:
        """The coil changes."""
        plant.wire(round(self.parameters["axis"]), self.parameters["scale"])

    def end(self, plant: Plant) -> None:
        """The coil is as before."""
        plant.wire(round(self.parameters["axis"]), 1.0)


class StuckOn(Fault):
    """A driver's switch does not open any more: ``ampere`` flow through a coil all the time."""

    def driven(self, driven: Driven) -> Driven:
        """This coil for the whole tick, the others as the board means."""
        current_a = driven.current_a if driven.fraction else ZERO
        return Driven(with_axis(current_a, self.parameters, self.parameters["ampere"]), 1.0)


class BoardRestarts(Fault):
    """A board is switched off and on."""

    def __init__(self, board: BoardName, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._board: BoardName = board

    def begin(self, plant: Plant) -> None:
        """It restarts now."""
        plant.restart(self._board)


class BoardStorm(Fault):
    """A board restarts over and over, each time up to ``ticks`` ticks after the last."""

    def __init__(self, board: BoardName, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._board: BoardName = board
        self._next = -1

    def before(self, tick: int, plant: Plant) -> None:
        """It may be time."""
        if tick >= self._next:
            plant.restart(self._board)
            self._next = tick + self.rng.randint(1, round(self.parameters["ticks"]))


class BoardDead(Fault):
    """A board says and does nothing; when the fault is over it boots."""

    def __init__(self, board: BoardName, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._board: BoardName = board

    def from_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """What the others say."""
        return [frame for frame in frames if SENDERS.get(frame.can_id) != _NODE[self._board]]

    def driven(self, driven: Driven) -> Driven:
        """A coil driver that is dead drives nothing."""
        return Driven(ZERO, 0.0) if self._board == "coil" else driven

    def end(self, plant: Plant) -> None:
        """It boots."""
        plant.restart(self._board)


def field_reads(reading: Reading) -> Callable[[Random, Parameters], Fault]:
    """A fault of the magnetometer."""
    return partial(FieldReads, reading)


def sun_reads(reading: Reading) -> Callable[[Random, Parameters], Fault]:
    """A fault of the Sun sensor."""
    return partial(SunReads, reading)


def board(
    kind: type[BoardRestarts] | type[BoardStorm] | type[BoardDead], name: BoardName
) -> Callable[[Random, Parameters], Fault]:
    """A fault of a board."""
    return partial(kind, name)
