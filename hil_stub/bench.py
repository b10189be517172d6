"""A board on a bench: follows the ticks of a bus by itself, with a stimulus of its own instead of a plant."""

from collections.abc import Callable
from typing import Protocol

from fsw.wire.frame import Frame
from fsw.wire.messages import PlantBoot, PlantEnd, Sync, TickDone, intact
from hil_stub.coil_driver import CoilDriver, CoilLimits
from hil_stub.dipole_driver import DipoleDriver
from hil_stub.magnetometer import Magnetometer
from hil_stub.read_back import ReadBack
from hil_stub.stimulus import Stimulus, Vec3
from hil_stub.sun_sensor import SunSensor

DEADMAN_MS = 5000
"""Silence of ``SYNC`` after which a board on a bench is silenced, unless it is told otherwise."""

LEVEL_A = (0.1, 0.2, 0.3)
"""Current read-back at levels 1, 2, 3, unless the board is told otherwise."""


class Board(Protocol):
    """A board with its stimulus: enters ticks, hears frames."""

    def begin_tick(self, tick: int, clock_ms: int | None) -> list[Frame]:
        """Enter ``tick``, the board's own clock reading ``clock_ms``: the frames to send."""

    def receive(self, frame: Frame) -> None:
        """Hear a frame of the bus."""

    def silence(self) -> None:
        """There has been no ``SYNC`` for too long."""


class CoilBoard:
    """A coil driver whose coils draw their nominal current at once.

    Args:
        limits: what its interlock enforces.
        level_a: currents at levels 1, 2, 3 [A].
    """

    def __init__(self, limits: CoilLimits, level_a: Vec3 = LEVEL_A) -> None:
        self._driver = CoilDriver(limits, ReadBack(level_a))
        self._level_a = (0.0, *level_a)

    def begin_tick(self, tick: int, clock_ms: int | None) -> list[Frame]:
        """Enter ``tick``; the current is that at the end of the tick before."""
        drive = self._driver.drive()
        current_a = self._level_a[abs(drive.level)] if drive.fraction == 1.0 else 0.0
        return self._driver.begin_tick(tick, current_a if drive.level > 0 else -current_a, clock_ms)

    def receive(self, frame: Frame) -> None:
        """Hear a frame of the bus."""
        self._driver.receive(frame)

    def silence(self) -> None:
        """All off, and a full back-off from now on."""
        self._driver.silence()


class DipoleBoard:
    """A continuous driver whose coils are without current when the sensors sample."""

    def __init__(self, tick_hz: int) -> None:
        self._driver = DipoleDriver(tick_hz)

    def begin_tick(self, tick: int, clock_ms: int | None) -> list[Frame]:
        """Enter ``tick``; the drive of the tick before has ended."""
        self._driver.drive()
        return self._driver.begin_tick(tick, 0.0)

    def receive(self, frame: Frame) -> None:
        """Hear a frame of the bus."""
        self._driver.receive(frame)

    def silence(self) -> None:
        """What it drives ends by itself with the tick."""


class SensorBoard:
    """A sensor: what it hears, and that it is left alone, is nothing to it."""

    def __init__(self, begin_tick: Callable[[int, Vec3, bool], list[Frame]], stimulus: Stimulus) -> None:
        self._begin_tick = begin_tick
        self._stimulus = stimulus

    def begin_tick(self, tick: int, clock_ms: int | None) -> list[Frame]:
        """Enter ``tick``."""
        vector, valid = self._stimulus(tick)
        return self._begin_tick(tick, vector, valid)

    def receive(self, frame: Frame) -> None:
        """A sensor hears nothing."""

    def silence(self) -> None:
        """A sensor guards nothing."""


class MagnetometerBoard(SensorBoard):
    """A magnetometer that is shown a field [T]."""

    def __init__(self, tick_hz: int, stimulus: Stimulus) -> None:
        super().__init__(Magnetometer(tick_hz).begin_tick, stimulus)


class SunBoard(SensorBoard):
    """A Sun sensor that is shown a direction."""

    def __init__(self, tick_hz: int, stimulus: Stimulus) -> None:
        super().__init__(SunSensor(tick_hz).begin_tick, stimulus)


class Bench:
    """Enters the ticks of the bus: k + 1 when ``TICK_DONE(k)`` has come, or ``SYNC(k + 1)`` at the latest.

    The board vouches for its timers only while it counts every tick. When it has lost count (two ``SYNC``
    in a row name consecutive ticks that are not its own), or when the plant has started anew, it is replaced
    by a new one, which boots: for the coil driver a full lockout. One strange ``SYNC`` alone moves nothing.

    The dead-man: when ``SYNC`` has stayed away for ``deadman_ms`` the board is silenced, until it is back.

    Args:
        make_board: makes a board that has just been switched on.
        deadman_ms: longest silence, above 0; None: there is no dead-man.
        has_clock: whether the board has a clock of its own beside the ticks.
    """

    def __init__(
        self, make_board: Callable[[], Board], deadman_ms: int | None = None, has_clock: bool = False
    ) -> None:
        self._make_board = make_board
        self._deadman_ms = deadman_ms
        self._has_clock = has_clock
        self._board = make_board()
        self._tick = 0
        self._strange_sync: int | None = None
        self._now_ms = self._synced_ms = 0
        self.ended = False
        """The plant has said that the run is over."""

    def switch_on(self, tick: int = 0, now_ms: int = 0) -> list[Frame]:
        """A new board, its first tick being ``tick``: the frames to send.

        Args:
            tick: the tick it wakes up in.
            now_ms: the time on a clock that never runs back [ms].
        """
        self._board = self._make_board()
        self._tick = tick
        self._strange_sync = None
        self._now_ms = self._synced_ms = now_ms
        return self._enter()

    def receive(self, frame: Frame, now_ms: int = 0) -> list[Frame]:
        """Hear a frame of the bus: the frames to send because of it."""
        self.watch(now_ms)
        self._board.receive(frame)
        if not intact(frame):
            return []
        match frame.can_id:
            case TickDone.ID if TickDone.decode(frame.data).tick == self._tick:
                return self._next_tick()
            case Sync.ID:
                return self._follow(Sync.decode(frame.data).tick)
            case PlantBoot.ID if self._tick > 0:
                return self.switch_on(now_ms=now_ms)
            case PlantEnd.ID:
                self.ended = True
        return []

    def watch(self, now_ms: int) -> None:
        """Time goes on: the dead-man, where nothing is heard too."""
        self._now_ms = now_ms
        if self._deadman_ms is not None and now_ms - self._synced_ms > self._deadman_ms:
            self._board.silence()

    def _follow(self, tick: int) -> list[Frame]:
        strange, self._strange_sync = self._strange_sync, None
        if tick == self._tick:
            self._synced_ms = self._now_ms
            return []
        if tick == self._tick + 1:
            self._synced_ms = self._now_ms
            return self._next_tick()
        if strange is not None and tick == strange + 1:
            return self.switch_on(tick, self._now_ms)
        self._strange_sync = tick
        return []

    def _next_tick(self) -> list[Frame]:
        self._tick += 1
        return self._enter()

    def _enter(self) -> list[Frame]:
        return self._board.begin_tick(self._tick, self._now_ms if self._has_clock else None)
