"""How the satellite sees the Sun: a Sun sensor or Sun cells, each with its board."""

from typing import final

from fsw.wire.frame import Frame
from hil_stub.sensors.sun_cells import SunCellBoard
from hil_stub.sensors.sun_sensor import SunSensor
from sim.plant.config import PlantConfig
from sim.plant.environment.albedo import earthlight
from sim.plant.hardware.sensors import SunSensorPhysics
from sim.plant.hardware.sun_cells import SunCellPhysics
from sim.plant.interference import Interference
from sim.plant.rotation import ZERO, Mat3, Vec3, transform
from sim.plant.sensor_config import SunCellsConfig, SunSensorConfig


@final
class SunView:
    """What there is to see at one instant: attitude, place, unit vectors to the Sun, its visible fraction."""

    __slots__ = ("body_from_eci", "lit", "r_eci_m", "sun_body", "sun_eci")

    def __init__(self, body_from_eci: Mat3, r_eci_m: Vec3, sun_eci: Vec3, sun_body: Vec3, lit: float) -> None:
        self.body_from_eci = body_from_eci
        self.r_eci_m = r_eci_m
        self.sun_eci = sun_eci
        self.sun_body = sun_body
        self.lit = lit


class SunSensing:
    """A sensor and its board."""

    def begin_tick(self, tick: int, view: SunView, faulty: Interference) -> list[Frame]:
        """The frames that the board sends in this tick."""
        raise NotImplementedError

    def restart(self) -> None:
        """Power-cycle the board."""
        raise NotImplementedError


@final
class FineSunSensing(SunSensing):
    """The Sun sensor."""

    def __init__(self, sensor: SunSensorConfig, seed: int, tick_hz: int) -> None:
        self._physics = SunSensorPhysics(sensor, seed, tick_hz)
        self._albedo, self._tick_hz = sensor.albedo, tick_hz
        self.restart()

    def begin_tick(self, tick: int, view: SunView, faulty: Interference) -> list[Frame]:
        """``SUN_VECTOR``, deflected by the Earth's light if that disturbs the sensor."""
        around = ZERO
        if self._albedo:
            around = transform(view.body_from_eci, earthlight(view.r_eci_m, view.sun_eci))
        sun_body, valid = self._physics.measure(view.sun_body, view.lit, around)
        sun_body, valid = faulty.sun(sun_body, valid)
        return self._board.begin_tick(tick, sun_body, valid)

    def restart(self) -> None:
        """Power-cycle the board."""
        self._board = SunSensor(self._tick_hz)


@final
class CellSensing(SunSensing):
    """Sun cells."""

    def __init__(self, cells: SunCellsConfig, seed: int, tick_hz: int) -> None:
        self._physics = SunCellPhysics(cells, seed, tick_hz)
        self._tick_hz = tick_hz
        self.restart()

    def begin_tick(self, tick: int, view: SunView, faulty: Interference) -> list[Frame]:
        """``SUN_CELLS``."""
        currents = self._physics.measure(view.body_from_eci, view.r_eci_m, view.sun_eci, view.lit)
        return self._board.begin_tick(tick, faulty.cells(currents), True)

    def restart(self) -> None:
        """Power-cycle the board."""
        self._board = SunCellBoard(self._tick_hz)


def make_sun_sensing(config: PlantConfig) -> SunSensing:
    """The configured sensor or cells."""
    given, seed, tick_hz = config.sun_sensor, config.seed, config.tick_hz
    if isinstance(given, SunCellsConfig):
        return CellSensing(given, seed, tick_hz)
    return FineSunSensing(given, seed, tick_hz)
