"""Faults of sensors, coils and boards."""

from collections.abc import Callable
from functools import partial
from math import inf, nan, radians, sqrt
from random import Random
from typing import Literal

from fsw.wire.frame import Frame
from fsw.wire.messages import SENDERS, MagField, SunCells, SunVector
from sim.faults.fault import Fault, Parameters
from sim.plant.coil_drive import CoilDrive
from sim.plant.plant import Plant
from sim.plant.rotation import ZERO, Vec3, from_vector, matrix, transform

# --- Faults of Sun cells


class WrongCurrent(Fault):
    """One cell has a wrong current."""

    def __init__(self, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._cell = round(parameters["cell"]) - 1

    def cells(self, currents: tuple[float, ...]) -> tuple[float, ...]:
        """The currents with that of the faulty cell, if there is one of that number."""
        if self._cell >= len(currents):
            return currents
        wrong = self.wrong(currents[self._cell])
        return (*currents[: self._cell], wrong, *currents[self._cell + 1 :])

    def wrong(self, current: float) -> float:
        """What the faulty cell has in place of this current."""
        raise NotImplementedError


class CellDead(WrongCurrent):
    """A cell has no current."""

    def wrong(self, current: float) -> float:
        """No current."""
        return 0.0


class CellScaled(WrongCurrent):
    """A cell has ``scale`` times its true current."""

    def wrong(self, current: float) -> float:
        """The wrong current."""
        return self.parameters["scale"] * current


class CellsRandom(Fault):
    """Each cell has no current or ``percent`` of full sunlight, at random in each tick."""

    def cells(self, currents: tuple[float, ...]) -> tuple[float, ...]:
        """The random currents."""
        lit = 0.01 * self.parameters["percent"]
        return tuple([self.rng.choice((0.0, lit)) for _ in currents])


class CellStuck(WrongCurrent):
    """A cell keeps its current of the onset, or ``percent`` of full sunlight if that is above 0."""

    def __init__(self, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._held = 0.01 * parameters["percent"] or None

    def wrong(self, current: float) -> float:
        """The held current."""
        self._held = current if self._held is None else self._held
        return self._held


# --- Faults of sensors, coils and boards

BoardName = Literal["magnetometer", "sun", "coil"]
_NODE: dict[BoardName, str] = {"magnetometer": "MAG", "sun": "SUN", "coil": "COIL"}
T_PER_NT = 1e-9
FULL_FIELD_NT, FULL_SUN, FULL_CELL = 65534.0, 1.9999, 255.0 / 128.0
Reading = Callable[[Vec3, Parameters], Vec3]


def replace_axis(v: Vec3, parameters: Parameters, value: float) -> Vec3:
    """The vector with another value on the faulty axis."""
    axis = round(parameters["axis"])
    return (value if axis == 0 else v[0], value if axis == 1 else v[1], value if axis == 2 else v[2])


def set_nan(v: Vec3, parameters: Parameters) -> Vec3:
    """NaN on one axis."""
    return replace_axis(v, parameters, nan)


def set_infinity(v: Vec3, parameters: Parameters) -> Vec3:
    """Infinity on one axis."""
    return replace_axis(v, parameters, inf)


def scale(v: Vec3, parameters: Parameters) -> Vec3:
    """One axis reads ``scale`` times its value; -1 is a wrong sign."""
    return replace_axis(v, parameters, v[round(parameters["axis"])] * parameters["scale"])


def swap_axes(v: Vec3, parameters: Parameters) -> Vec3:
    """The faulty axis and the next one are swapped."""
    first = round(parameters["axis"])
    second = (first + 1) % 3
    order = [second if axis == first else first if axis == second else axis for axis in range(3)]
    return (v[order[0]], v[order[1]], v[order[2]])


def shift(v: Vec3, parameters: Parameters) -> Vec3:
    """One axis has an offset of ``nt``."""
    return replace_axis(v, parameters, v[round(parameters["axis"])] + parameters["nt"] * T_PER_NT)


def turn(v: Vec3, parameters: Parameters) -> Vec3:
    """The sensor is turned by ``deg`` about a body axis: it reads R v, R from body to sensor axes."""
    return transform(matrix(from_vector(replace_axis(ZERO, parameters, radians(parameters["deg"])))), v)


def clip(v: Vec3, parameters: Parameters) -> Vec3:
    """No axis reads more than ``nt``, and the sample is still marked as valid."""
    most = parameters["nt"] * T_PER_NT
    return (min(max(v[0], -most), most), min(max(v[1], -most), most), min(max(v[2], -most), most))


class WrongReading(Fault):
    """A sensor has a wrong reading.

    The parameter named ``size`` may change with time: size(t) = size + per_s (t - t_onset), t in seconds.
    """

    def __init__(self, reading: Reading, size: str | None, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._reading, self._size, self._now = reading, size, parameters
        self._onset_s = 0.0

    def begin(self, plant: Plant) -> None:
        """Note the time."""
        self._onset_s = plant.t_s

    def before(self, tick: int, plant: Plant) -> None:
        """Set the size that the fault has in this tick."""
        if self._size is not None:
            change = self.parameters["per_s"] * (plant.t_s - self._onset_s)
            self._now = {**self.parameters, self._size: self.parameters[self._size] + change}

    def read(self, v: Vec3) -> Vec3:
        """The wrong reading of this tick."""
        return self._reading(v, self._now)


class WrongFieldReading(WrongReading):
    """The magnetometer has a wrong reading, marked as valid."""

    def field(self, b_body_t: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The wrong reading."""
        return self.read(b_body_t), valid


class WrongSunReading(WrongReading):
    """The Sun sensor has a wrong reading where the Sun is in view."""

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The wrong reading."""
        return (self.read(sun_body), True) if valid else (sun_body, False)


class FieldFrozen(Fault):
    """The magnetometer repeats its last value."""

    _last: Vec3 | None = None

    def field(self, b_body_t: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The value at the fault's beginning."""
        self._last = self._last or b_body_t
        return self._last, True


class SunFrozen(Fault):
    """The Sun sensor repeats its last value, in eclipse too."""

    _last: Vec3 | None = None

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The value at the fault's beginning."""
        self._last = self._last or (sun_body if valid else (0.0, 1.0, 0.0))
        return self._last, True


class SunDeflection(Fault):
    """Albedo deflects the direction by up to ``part`` towards the Earth, in sunlight and in eclipse."""

    _plant: Plant

    def begin(self, plant: Plant) -> None:
        """Store the plant, whose attitude gives the direction of the Earth."""
        self._plant = plant

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The direction between Sun and Earth; without Sun, that of the Earth."""
        down = transform(matrix(self._plant.truth().q_body_from_orbit), (-1.0, 0.0, 0.0))
        part = self.parameters["part"] if valid else 1.0
        x, y, z = ((1.0 - part) * s + part * e for s, e in zip(sun_body, down, strict=True))
        length = sqrt(x * x + y * y + z * z)
        return (x / length, y / length, z / length), True


class SunBlindness(Fault):
    """The Sun sensor has no Sun in view."""

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """Darkness."""
        return ZERO, False


class ExtremeCodes(Fault):
    """Frames of one sensor (``sun`` 0 or 1) have extreme values, are marked valid and have a correct CRC."""

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
        if frame.can_id == SunCells.ID and sun:
            counter = SunCells.decode(frame.data).counter
            d, e, f, g, h, i = (self.rng.choice((0.0, FULL_CELL)) for _ in range(6))
            return SunCells(1, d, e, f, g, h, i, counter).encode()
        return frame


class CoilOpen(Fault):
    """A coil is cut: no current flows."""

    def coil_drive(self, drive: CoilDrive) -> CoilDrive:
        """Without this coil's current."""
        return CoilDrive(
            replace_axis(drive.current_a, self.parameters, 0.0),
            drive.fraction,
            replace_axis(drive.held_a, self.parameters, 0.0),
        )


class CoilRescaling(Fault):
    """A coil gives ``scale`` times its dipole for the same current: -1 is reversed, below 1 weak."""

    def begin(self, plant: Plant) -> None:
        """The coil changes."""
        plant.scale_coil(round(self.parameters["axis"]), self.parameters["scale"])

    def end(self, plant: Plant) -> None:
        """The coil is as without this fault."""
        plant.unscale_coil(round(self.parameters["axis"]), self.parameters["scale"])


class CoilStuckOn(Fault):
    """A driver's switch does not open: ``ampere`` flow through a coil all the time."""

    def coil_drive(self, drive: CoilDrive) -> CoilDrive:
        """This coil for the whole tick, the others as the board commands."""
        current_a, ampere = drive.current_a if drive.fraction else ZERO, self.parameters["ampere"]
        return CoilDrive(
            replace_axis(current_a, self.parameters, ampere),
            drive.fraction,
            replace_axis(drive.held_a, self.parameters, ampere),
        )


class BoardRestarts(Fault):
    """A board is power-cycled."""

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
        """Restart if it is due."""
        if tick >= self._next:
            plant.restart(self._board)
            self._next = tick + self.rng.randint(1, round(self.parameters["ticks"]))


class BoardDead(Fault):
    """A board sends and does nothing; when the fault ends it boots."""

    def __init__(self, board: BoardName, rng: Random, parameters: Parameters) -> None:
        super().__init__(rng, parameters)
        self._board: BoardName = board

    def from_boards(self, tick: int, frames: list[Frame]) -> list[Frame]:
        """The frames of the other boards."""
        return [frame for frame in frames if SENDERS.get(frame.can_id) != _NODE[self._board]]

    def coil_drive(self, drive: CoilDrive) -> CoilDrive:
        """A dead coil driver drives nothing."""
        return CoilDrive(ZERO, 0.0) if self._board == "coil" else drive

    def end(self, plant: Plant) -> None:
        """It boots."""
        plant.restart(self._board)


def field_fault(reading: Reading, size: str | None = None) -> Callable[[Random, Parameters], Fault]:
    """A fault of the magnetometer; ``size``: the parameter that ``per_s`` changes."""
    return partial(WrongFieldReading, reading, size)


def sun_fault(reading: Reading, size: str | None = None) -> Callable[[Random, Parameters], Fault]:
    """A fault of the Sun sensor; ``size``: the parameter that ``per_s`` changes."""
    return partial(WrongSunReading, reading, size)


def board_fault(
    kind: type[BoardRestarts] | type[BoardStorm] | type[BoardDead], name: BoardName
) -> Callable[[Random, Parameters], Fault]:
    """A fault of a board."""
    return partial(kind, name)
