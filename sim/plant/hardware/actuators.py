"""The coil driver boards of the plant, and the currents that they drive."""

from math import ceil
from typing import NamedTuple, Protocol

from fsw.wire.frame import Frame
from hil_stub.coils.coil_driver import CoilDriver
from hil_stub.coils.dipole_driver import DipoleDriver
from hil_stub.coils.read_back import ReadBack
from sim.plant.config import CoilConfig, ContinuousConfig, PlantConfig
from sim.plant.rotation import ZERO, Vec3

SETTLED_TIME_CONSTANTS = 10.0
"""Time constants after which the read-back is judged: less than 0.01 % of the change is left."""


class CoilDrive(NamedTuple):
    """The currents driven over a tick, from its start for ``fraction`` of it."""

    current_a: Vec3
    """Target current of each coil."""
    fraction: float
    held_a: Vec3 = ZERO
    """Target current of each coil for the rest of the tick: none, unless a switch does not open."""


OFF = CoilDrive(ZERO, 0.0)


class Board(Protocol):
    """A coil driver board on the bus."""

    def begin_tick(self, tick: int, current_a: float) -> list[Frame]:
        """Enter a tick, the coil current being read back: the frames to send."""

    def receive(self, frame: Frame) -> None:
        """Take a frame of the bus."""


class Actuator(Protocol):
    """A board, and the currents that it drives."""

    board: Board

    def drive(self) -> CoilDrive:
        """The currents of the tick that has begun."""


class PulsedActuator:
    """One coil at a time, at one of three levels, as the interlock allows."""

    def __init__(self, config: PlantConfig) -> None:
        coils = config.coils
        low_a, middle_a, high_a = (dipole / coils.dipole_per_ampere_am2 for dipole in coils.levels_am2)
        settle_ms = ceil(1000.0 * SETTLED_TIME_CONSTANTS * coils.time_constant_s)
        self._driver = CoilDriver(config.limits, ReadBack((low_a, middle_a, high_a), settle_ms))
        self.board: Board = self._driver
        self._level_a = [0.0, low_a, middle_a, high_a]

    def drive(self) -> CoilDrive:
        """The currents of the tick that has begun."""
        coil, level, fraction = self._driver.drive()
        if not level:
            return OFF
        current_a = self._level_a[level] if level > 0 else -self._level_a[-level]
        x, y, z = (current_a if each == coil else 0.0 for each in range(3))
        return CoilDrive((x, y, z), fraction)


class ContinuousActuator:
    """All three coils at once, for a fraction of the tick in which they are commanded."""

    def __init__(self, tick_hz: int, coils: CoilConfig, continuous: ContinuousConfig) -> None:
        self._driver = DipoleDriver(tick_hz, continuous.on_fraction)
        self.board: Board = self._driver
        self._full_a = continuous.max_dipole_am2 / coils.dipole_per_ampere_am2

    def drive(self) -> CoilDrive:
        """The currents of the tick that has begun."""
        (x, y, z), fraction = self._driver.drive()
        full_a = self._full_a
        return CoilDrive((x * full_a, y * full_a, z * full_a), fraction)


def make_actuator(config: PlantConfig) -> Actuator:
    """The configured actuator."""
    continuous = config.coils.continuous
    if continuous is None:
        return PulsedActuator(config)
    return ContinuousActuator(config.tick_hz, config.coils, continuous)
