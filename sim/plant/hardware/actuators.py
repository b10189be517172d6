"""The coil driver boards of the plant, and the currents that they drive."""

from math import ceil
from typing import final

from mypy_extensions import mypyc_attr

from fsw.wire.frame import Frame
from hil_stub.coils.coil_driver import CoilDriver
from hil_stub.coils.dipole_driver import DipoleDriver
from hil_stub.coils.read_back import ReadBack
from sim.plant.coil_drive import OFF, CoilDrive
from sim.plant.config import CoilConfig, ContinuousConfig, PlantConfig

SETTLED_TIME_CONSTANTS = 10.0
"""Time constants after which the read-back is judged: less than 0.01 % of the change is left."""


@mypyc_attr(allow_interpreted_subclasses=True)
class Actuator:
    """A coil driver board on the bus, and the currents that it drives."""

    def begin_tick(self, tick: int, current_a: float) -> list[Frame]:
        """Enter a tick, the coil current being read back: the frames to send."""
        raise NotImplementedError

    def receive(self, frame: Frame) -> None:
        """Take a frame of the bus."""
        raise NotImplementedError

    def drive(self) -> CoilDrive:
        """The currents of the tick that has begun."""
        raise NotImplementedError


@final
class PulsedActuator(Actuator):
    """One coil at a time, at one of three levels, as the interlock allows."""

    def __init__(self, config: PlantConfig) -> None:
        coils = config.coils
        low_a, middle_a, high_a = (dipole / coils.dipole_per_ampere_am2 for dipole in coils.levels_am2)
        settle_ms = ceil(1000.0 * SETTLED_TIME_CONSTANTS * coils.time_constant_s)
        self._driver = CoilDriver(config.limits, ReadBack((low_a, middle_a, high_a), settle_ms))
        self._level_a = [0.0, low_a, middle_a, high_a]

    def begin_tick(self, tick: int, current_a: float) -> list[Frame]:
        """The frames of the board in this tick."""
        return self._driver.begin_tick(tick, current_a)

    def receive(self, frame: Frame) -> None:
        """Hand the board a frame of the bus."""
        self._driver.receive(frame)

    def drive(self) -> CoilDrive:
        """The currents of the tick that has begun."""
        driven = self._driver.drive()
        level, coil = driven.level, driven.coil
        if not level:
            return OFF
        current_a = self._level_a[level] if level > 0 else -self._level_a[-level]
        by_coil = (
            current_a if coil == 0 else 0.0,
            current_a if coil == 1 else 0.0,
            current_a if coil == 2 else 0.0,
        )
        return CoilDrive(by_coil, driven.fraction)


@final
class ContinuousActuator(Actuator):
    """All three coils at once, for a fraction of the tick in which they are commanded."""

    def __init__(self, tick_hz: int, coils: CoilConfig, continuous: ContinuousConfig) -> None:
        self._driver = DipoleDriver(tick_hz, continuous.on_fraction)
        self._full_a = continuous.max_dipole_am2 / coils.dipole_per_ampere_am2

    def begin_tick(self, tick: int, current_a: float) -> list[Frame]:
        """The frames of the board in this tick."""
        return self._driver.begin_tick(tick, current_a)

    def receive(self, frame: Frame) -> None:
        """Hand the board a frame of the bus."""
        self._driver.receive(frame)

    def drive(self) -> CoilDrive:
        """The currents of the tick that has begun."""
        driven, full_a = self._driver.drive(), self._full_a
        x, y, z = driven.dipole
        return CoilDrive((x * full_a, y * full_a, z * full_a), driven.fraction)


def make_actuator(config: PlantConfig) -> Actuator:
    """The configured actuator."""
    continuous = config.coils.continuous
    if continuous is None:
        return PulsedActuator(config)
    return ContinuousActuator(config.tick_hz, config.coils, continuous)
