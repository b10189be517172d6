"""A board on a bench: follows the ticks of a bus by itself, with a fixed stimulus instead of a plant."""

from collections.abc import Callable
from typing import Protocol

from fsw.wire.frame import Frame
from fsw.wire.messages import PlantBoot, PlantEnd, Sync, TickDone, intact
from hil_stub.coil_driver import CoilDriver, CoilLimits
from hil_stub.dipole_driver import DipoleDriver
from hil_stub.interlock import MAX_LEVEL
from hil_stub.magnetometer import Magnetometer
from hil_stub.sun_sensor import SunSensor

Vec3 = tuple[float, float, float]

FULL_CURRENT_A = 0.3
"""Current read-back at the highest level: the coil on the bench is nominal."""


class Board(Protocol):
    """A board with its stimulus: enters ticks, hears frames."""

    def begin_tick(self, tick: int) -> list[Frame]:
        """Enter ``tick``: the frames to send."""

    def receive(self, frame: Frame) -> None:
        """Hear a frame of the bus."""


class CoilBoard:
    """A coil driver whose coils draw their nominal current at once: level / 3 of 0.3 A while on."""

    def __init__(self, limits: CoilLimits) -> None:
        self._driver = CoilDriver(limits)

    def begin_tick(self, tick: int) -> list[Frame]:
        """Enter ``tick``; the current is that at the end of the tick before."""
        drive = self._driver.drive()
        current_a = FULL_CURRENT_A * drive.level / MAX_LEVEL if drive.fraction == 1.0 else 0.0
        return self._driver.begin_tick(tick, current_a)

    def receive(self, frame: Frame) -> None:
        """Hear a frame of the bus."""
        self._driver.receive(frame)


class DipoleBoard:
    """A continuous driver whose coils are without current when the sensors sample."""

    def __init__(self, tick_hz: int) -> None:
        self._driver = DipoleDriver(tick_hz)

    def begin_tick(self, tick: int) -> list[Frame]:
        """Enter ``tick``; the drive of the tick before has ended."""
        self._driver.drive()
        return self._driver.begin_tick(tick, 0.0)

    def receive(self, frame: Frame) -> None:
        """Hear a frame of the bus."""
        self._driver.receive(frame)


class MagnetometerBoard:
    """A magnetometer in a constant field [T]."""

    def __init__(self, tick_hz: int, b_body_t: Vec3) -> None:
        self._sensor = Magnetometer(tick_hz)
        self._b_body_t = b_body_t

    def begin_tick(self, tick: int) -> list[Frame]:
        """Enter ``tick``."""
        return self._sensor.begin_tick(tick, self._b_body_t, True)

    def receive(self, frame: Frame) -> None:
        """A sensor hears nothing."""


class SunBoard:
    """A Sun sensor before a lamp that stands still."""

    def __init__(self, tick_hz: int, sun_body: Vec3) -> None:
        self._sensor = SunSensor(tick_hz)
        self._sun_body = sun_body

    def begin_tick(self, tick: int) -> list[Frame]:
        """Enter ``tick``."""
        return self._sensor.begin_tick(tick, self._sun_body, True)

    def receive(self, frame: Frame) -> None:
        """A sensor hears nothing."""


class Bench:
    """Enters the ticks of the bus: k + 1 when ``TICK_DONE(k)`` has come, or ``SYNC(k + 1)`` at the latest.

    The board vouches for its timers only while it counts every tick. When it has lost count (two ``SYNC``
    in a row name consecutive ticks that are not its own), or when the plant has started anew, it is replaced
    by a new one, which boots: for the coil driver a full lockout. One strange ``SYNC`` alone moves nothing.

    Args:
        make_board: makes a board that has just been switched on.
    """

    def __init__(self, make_board: Callable[[], Board]) -> None:
        self._make_board = make_board
        self._board = make_board()
        self._tick = 0
        self._strange_sync: int | None = None
        self.ended = False
        """The plant has said that the run is over."""

    def switch_on(self, tick: int = 0) -> list[Frame]:
        """A new board, its first tick being ``tick``: the frames to send."""
        self._board = self._make_board()
        self._tick = tick
        self._strange_sync = None
        return self._board.begin_tick(tick)

    def receive(self, frame: Frame) -> list[Frame]:
        """Hear a frame of the bus: the frames to send because of it."""
        self._board.receive(frame)
        if not intact(frame):
            return []
        match frame.can_id:
            case TickDone.ID if TickDone.decode(frame.data).tick == self._tick:
                return self._next_tick()
            case Sync.ID:
                return self._follow(Sync.decode(frame.data).tick)
            case PlantBoot.ID if self._tick > 0:
                return self.switch_on()
            case PlantEnd.ID:
                self.ended = True
        return []

    def _follow(self, tick: int) -> list[Frame]:
        strange, self._strange_sync = self._strange_sync, None
        if tick == self._tick:
            return []
        if tick == self._tick + 1:
            return self._next_tick()
        if strange is not None and tick == strange + 1:
            return self.switch_on(tick)
        self._strange_sync = tick
        return []

    def _next_tick(self) -> list[Frame]:
        self._tick += 1
        return self._board.begin_tick(self._tick)
