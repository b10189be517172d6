"""A scheduler on a bench: what it hears, what it may ask, and a board that drives whatever it is asked.

The board has no interlock, so that what the scheduler does wrong is done. It only drops a request that the
bus has lost. What it says of its lockout is true: how long it would refuse each coil if it did refuse. So a
scheduler that is started anew in the middle of a pulse can know of it, as it can in flight. Lost are
COIL_STATUS and requests; COIL_BOOT always arrives.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import Flag
from typing import NamedTuple, Protocol

from fsw.core.attitude import UNKNOWN, Attitude
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilBoot, CoilFire, CoilStatus, Sync
from sim.harness.candump import LogEntry

EPOCH_S = 1_427_513_417
PATTERN_TICKS = 8
UNITS_PER_TICK = 1000
MOST_LOCKOUT_MS = 655_350
"""What COIL_STATUS can tell."""

Vec3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Limits:
    """What must be kept: the longest pulse, the back-off after it, of any coil (shared) or of the same."""

    tick_hz: int = 1
    pulse_ms: int = 3000
    backoff_ms: int = 100_000
    shared: bool = True


class Fire(NamedTuple):
    """A request: coil 0..2, level -3..3 without zero, duration; as COIL_FIRE carries it."""

    coil: int
    level: int
    duration_ms: int


class Heard(NamedTuple):
    """What a scheduler knows in a tick.

    Attributes:
        tick: number of the tick; rises by one.
        m_body_am2: the mean dipole that the law asks for, body axes, A m^2.
        b_body_t: the field, body axes, T.
        attitude: for a law of your own.
        status: what the board says of one coil in this tick; None where the message was lost.
        booted: the board has just started, all coils locked out.
    """

    tick: int
    m_body_am2: Vec3
    b_body_t: Vec3
    attitude: Attitude
    status: CoilStatus | None
    booted: bool


class Scheduler(Protocol):
    """Decides in every tick what to fire. A request is driven from the tick on in which it is made."""

    def step(self, heard: Heard, /) -> Sequence[Fire]:
        """The requests of this tick: none or one, where the limits are to be kept."""


MakeScheduler = Callable[[Limits], Scheduler]
"""Called whenever the scheduler boots."""


class Reboot(Flag):
    """Who is started anew."""

    NOBODY = 0
    SCHEDULER = 1
    BOARD = 2


class Stretch(NamedTuple):
    """Some ticks with one demand. In tick n a message is lost if bit n modulo 8 is set."""

    ticks: int
    m_body_am2: Vec3
    b_body_t: Vec3
    attitude: Attitude = UNKNOWN
    reboot: Reboot = Reboot.NOBODY
    lost_statuses: int = 0
    lost_requests: int = 0


class Flight(NamedTuple):
    """What is flown: the limits, the first tick, and the stretches, at whose begin reboots happen."""

    limits: Limits
    first_tick: int
    stretches: tuple[Stretch, ...]


class _On(NamedTuple):
    """A coil that is driven: its level, and the rest in units of 1 / (1000 tick_hz) s."""

    level: int
    rest: int


class _Board:
    """Drives each coil as it was last asked."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._on: dict[int, _On] = {}
        self._lockout = [limits.backoff_ms * limits.tick_hz] * 3
        self._statuses = 0
        self._seq = 0
        self._boots: list[Frame] = [CoilBoot(reason=0, version=1, table_crc=0).encode()]

    def begin_tick(self, tick: int, elapsed: bool) -> list[Frame]:
        """COIL_BOOT in its first tick, and a COIL_STATUS for each coil that was driven, or for one."""
        frames, self._boots = self._boots, []
        step = UNITS_PER_TICK if elapsed else 0
        self._lockout = [max(0, units - step) for units in self._lockout]
        driven = [(coil, on.level, max(0, on.rest - step)) for coil, on in self._on.items()]
        self._on = {coil: _On(level, rest) for coil, level, rest in driven if rest > 0}
        frames += [self._status(*one) for one in driven or [(tick % 3, 0, 0)]]
        self._statuses += 1
        return frames

    def fire(self, request: CoilFire) -> None:
        """Drive it, whatever else is driven."""
        duration = request.duration_ms * self._limits.tick_hz
        if duration == 0 or request.level == 0:
            return
        self._on[request.coil] = _On(request.level, duration)
        self._seq = request.seq
        again = duration + self._limits.backoff_ms * self._limits.tick_hz
        for coil in range(3):
            if self._limits.shared or coil == request.coil:
                self._lockout[coil] = max(self._lockout[coil], again)

    def _status(self, coil: int, level: int, rest: int) -> Frame:
        lockout = self._lockout[coil] if coil < len(self._lockout) else 0
        hz = self._limits.tick_hz
        return CoilStatus(
            level=level,
            coil=coil,
            remaining_ms=-(-rest // hz),
            current_ma=0,
            lockout_ms=min(-(-lockout // (10 * hz)) * 10, MOST_LOCKOUT_MS),
            seq=self._seq,
            counter=self._statuses,
        ).encode()


def fly(make: MakeScheduler, flight: Flight) -> Iterator[LogEntry]:
    """Fly a scheduler: the log of the board, as it would stand in bus.log."""
    limits, tick, line, seq = flight.limits, flight.first_tick, 0, 0
    board, scheduler = _Board(limits), make(limits)
    began = tick
    for stretch in flight.stretches:
        if Reboot.BOARD in stretch.reboot:
            board, began = _Board(limits), tick
        if Reboot.SCHEDULER in stretch.reboot:
            scheduler = make(limits)
        for index in range(stretch.ticks):
            said = board.begin_tick(tick, elapsed=tick > began)
            sync = Sync(tick, EPOCH_S + tick // limits.tick_hz).encode()
            stamp_us = EPOCH_S * 1_000_000 + tick * 1_000_000 // limits.tick_hz
            for frame in (*said, sync):
                line += 1
                yield LogEntry(line, stamp_us, "bench", frame)
            for request in scheduler.step(_heard(stretch, tick, index, said)):
                seq += 1
                if not stretch.lost_requests >> index % PATTERN_TICKS & 1:
                    board.fire(_as_sent(request, seq, tick))
            tick += 1


def _heard(stretch: Stretch, tick: int, index: int, said: list[Frame]) -> Heard:
    statuses = [CoilStatus.decode(frame.data) for frame in said if frame.can_id == CoilStatus.ID]
    lost = stretch.lost_statuses >> index % PATTERN_TICKS & 1
    return Heard(
        tick=tick,
        m_body_am2=stretch.m_body_am2,
        b_body_t=stretch.b_body_t,
        attitude=stretch.attitude,
        status=None if lost else statuses[-1],
        booted=any(frame.can_id == CoilBoot.ID for frame in said),
    )


def _as_sent(request: Fire, seq: int, tick: int) -> CoilFire:
    """The request as it comes off the bus, fields cut to what they hold."""
    coil, level, duration_ms = request
    return CoilFire.decode(CoilFire(level, coil, seq & 0xFF, tick & 0xFF, duration_ms).encode().data)
