"""A board on a bench: follows the ticks of a bus by itself, with a stimulus of its own instead of a plant."""

from collections.abc import Callable
from typing import Final, Protocol

from fsw.wire.frame import Frame
from fsw.wire.messages import PlantBoot, Sync, TickDone, intact
from hil_stub.coils.coil_driver import CoilDriver, CoilLimits, Pin
from hil_stub.coils.dipole_driver import DipoleDriver
from hil_stub.coils.read_back import ReadBack
from hil_stub.sensors.magnetometer import Magnetometer
from hil_stub.sensors.stimulus import Stimulus, Values, three
from hil_stub.sensors.sun_cells import SunCellBoard
from hil_stub.sensors.sun_sensor import SunSensor

DEADMAN_MS: Final = 5000
"""Time without ``SYNC`` after which a board on a bench switches off, by default."""

LEVEL_A: tuple[float, float, float] = (0.1, 0.2, 0.3)
"""Current at levels 1, 2, 3 [A], by default."""


class BenchBoard(Protocol):
    """A board with its stimulus: enters ticks, receives frames.

    ``clock_ms`` is what its own clock reads; None: it has none.
    """

    def begin_tick(self, tick: int, clock_ms: int | None) -> list[Frame]:
        """Enter ``tick``: the frames to send."""

    def receive(self, frame: Frame, clock_ms: int | None) -> None:
        """Receive a frame of the bus."""

    def pass_time(self, clock_ms: int | None) -> None:
        """Time has passed without a frame."""

    def sync(self) -> None:
        """The ``SYNC`` of this tick has come."""

    def silence(self, clock_ms: int | None) -> None:
        """There has been no ``SYNC`` for too long."""

    @property
    def pin(self) -> Pin | None:
        """The coil that is on at the latest time given to the board."""


class CoilBoard:
    """A coil driver whose coils draw their nominal current at once.

    Args:
        limits: what its interlock enforces.
        level_a: currents at levels 1, 2, 3 [A].
    """

    def __init__(self, limits: CoilLimits, level_a: tuple[float, float, float] = LEVEL_A) -> None:
        self._driver = CoilDriver(limits, ReadBack(level_a))
        self._level_a = (0.0, *level_a)

    def begin_tick(self, tick: int, clock_ms: int | None) -> list[Frame]:
        """Enter ``tick``; the current is the present one, or without a clock that of the last tick's end."""
        drive = self._driver.drive()
        flows = drive.fraction == 1.0 or clock_ms is not None
        current_a = self._level_a[abs(drive.level)] if flows else 0.0
        return self._driver.begin_tick(tick, current_a if drive.level > 0 else -current_a, clock_ms)

    def receive(self, frame: Frame, clock_ms: int | None) -> None:
        """Receive a frame of the bus."""
        self._driver.receive(frame, clock_ms)

    def pass_time(self, clock_ms: int | None) -> None:
        """A pulse may end."""
        self._driver.pass_time(clock_ms)

    def sync(self) -> None:
        """The tick before is over."""
        self._driver.sync()

    def silence(self, clock_ms: int | None) -> None:
        """All off, and a full back-off from now on."""
        self._driver.silence(clock_ms)

    @property
    def pin(self) -> Pin | None:
        """The coil that is on."""
        return self._driver.pin


class Untimed:
    """A board that drives no pulses: time, SYNC and silence do not affect it."""

    pin = None

    def sync(self) -> None:
        """No drive lasts beyond a tick."""

    def pass_time(self, clock_ms: int | None) -> None:
        """No state depends on time."""

    def silence(self, clock_ms: int | None) -> None:
        """No drive lasts longer than a tick."""


class DipoleBoard(Untimed):
    """A continuous driver whose coils are without current when the sensors sample."""

    def __init__(self, tick_hz: int) -> None:
        self._driver = DipoleDriver(tick_hz)

    def begin_tick(self, tick: int, clock_ms: int | None) -> list[Frame]:
        """Enter ``tick``; the drive of the tick before has ended."""
        self._driver.drive()
        return self._driver.begin_tick(tick, 0.0)

    def receive(self, frame: Frame, clock_ms: int | None) -> None:
        """Receive a frame of the bus."""
        self._driver.receive(frame)


class SensorBoard(Untimed):
    """A sensor, which ignores received frames, time and silence."""

    def __init__(self, begin_tick: Callable[[int, Values, bool], list[Frame]], stimulus: Stimulus) -> None:
        self._begin_tick = begin_tick
        self._stimulus = stimulus

    def begin_tick(self, tick: int, clock_ms: int | None) -> list[Frame]:
        """Enter ``tick``."""
        reading = self._stimulus(tick)
        return self._begin_tick(tick, reading.numbers, reading.valid)

    def receive(self, frame: Frame, clock_ms: int | None) -> None:
        """A sensor ignores all frames."""


class MagnetometerBoard(SensorBoard):
    """A magnetometer whose stimulus is a field [T]."""

    def __init__(self, tick_hz: int, stimulus: Stimulus) -> None:
        board = Magnetometer(tick_hz)
        super().__init__(lambda tick, field, valid: board.begin_tick(tick, three(field), valid), stimulus)


class SunBoard(SensorBoard):
    """A Sun sensor whose stimulus is a direction."""

    def __init__(self, tick_hz: int, stimulus: Stimulus) -> None:
        board = SunSensor(tick_hz)
        super().__init__(lambda tick, sun, valid: board.begin_tick(tick, three(sun), valid), stimulus)


class CellsBoard(SensorBoard):
    """Sun cells whose stimulus is their currents."""

    def __init__(self, tick_hz: int, stimulus: Stimulus) -> None:
        super().__init__(SunCellBoard(tick_hz).begin_tick, stimulus)


LAST_TICK: Final = 2**32 - 1
"""Of SYNC and TICK_DONE."""


class Bench:
    """Enters the ticks of the bus: k + 1 when ``TICK_DONE(k)`` has come, or ``SYNC(k + 1)`` at the latest.

    The board vouches for its timers only while it counts every tick. When it has lost count (two unexpected
    ``SYNC`` in a row, of the same tick or of one and the next), or when the plant has restarted, it is
    replaced by a new one, which boots: for the coil driver a full lockout. A single unexpected ``SYNC``
    changes nothing. The count does not wrap: no tick follows ``LAST_TICK``, in which the board stays.
    ``PLANT_END`` is ignored: a bench is switched off by hand.

    The dead-man: when no ``SYNC`` has advanced the count of ticks for ``deadman_ms``, the board is off until
    one does. One that only repeats the last tick is no sign of life.

    Args:
        make_board: makes a board that has just been switched on.
        deadman_ms: longest silence, above 0; None: there is no dead-man.
        has_clock: whether the board has a clock of its own besides the ticks.
    """

    def __init__(
        self, make_board: Callable[[], BenchBoard], deadman_ms: int | None = None, has_clock: bool = False
    ) -> None:
        self._make_board = make_board
        self._deadman_ms = deadman_ms
        self._has_clock = has_clock
        self._board = make_board()
        self._tick = 0
        self._synced_tick: int | None = None
        self._unexpected_sync: int | None = None
        self._now_ms = self._synced_ms = 0

    @property
    def pin(self) -> Pin | None:
        """The coil that is on at the latest time given to the bench; None: all are off."""
        return self._board.pin

    def switch_on(self, tick: int = 0, now_ms: int = 0) -> list[Frame]:
        """A new board, its first tick being ``tick``: the frames to send.

        Args:
            tick: the tick it wakes up in.
            now_ms: the time on a clock that never runs back [ms].
        """
        self._board = self._make_board()
        self._tick = tick
        self._synced_tick = self._unexpected_sync = None
        self._now_ms = self._synced_ms = now_ms
        return self._enter()

    def receive(self, frame: Frame, now_ms: int = 0) -> list[Frame]:
        """Receive a frame of the bus: the frames to send in answer."""
        self.watch(now_ms)
        self._board.receive(frame, self._clock_ms)
        if not intact(frame):
            return []
        match frame.can_id:
            case TickDone.ID if TickDone.decode(frame.data).tick == self._tick < LAST_TICK:
                return self._next_tick()
            case Sync.ID:
                return self._follow(Sync.decode(frame.data).tick)
            case PlantBoot.ID if self._tick > 0:
                return self.switch_on(now_ms=now_ms)
        return []

    def watch(self, now_ms: int) -> None:
        """Time has passed, with or without a frame: pulses end, and the dead-man acts."""
        self._now_ms = now_ms
        self._board.pass_time(self._clock_ms)
        if self._deadman_ms is not None and now_ms - self._synced_ms > self._deadman_ms:
            self._board.silence(self._clock_ms)

    def due_ms(self) -> int | None:
        """When ``watch`` is due next if no frame comes; None: at any time."""
        pin = self.pin
        due_ms = [] if pin is None or pin.until_ms is None else [pin.until_ms]
        if self._deadman_ms is not None and self._now_ms - self._synced_ms <= self._deadman_ms:
            due_ms.append(self._synced_ms + self._deadman_ms + 1)
        return min(due_ms, default=None)

    def _follow(self, tick: int) -> list[Frame]:
        unexpected, self._unexpected_sync = self._unexpected_sync, None
        if tick in (self._tick, self._tick + 1):
            if tick != self._synced_tick:
                self._synced_tick, self._synced_ms = tick, self._now_ms
            frames = self._next_tick() if tick > self._tick else []
            self._board.sync()
            return frames
        if unexpected is not None and tick in (unexpected, unexpected + 1):
            frames = self.switch_on(tick, self._now_ms)
            self._synced_tick = tick
            return frames
        self._unexpected_sync = tick
        return []

    def _next_tick(self) -> list[Frame]:
        self._tick += 1
        return self._enter()

    def _enter(self) -> list[Frame]:
        return self._board.begin_tick(self._tick, self._clock_ms)

    @property
    def _clock_ms(self) -> int | None:
        return self._now_ms if self._has_clock else None
