"""A scheduler in simulated flight: its inputs, its requests, and a board that drives every request.

The board has no interlock, so that each mistake of the scheduler shows. It drops only requests that are lost
on the bus. The lockout that it reports is true: how long it would refuse each coil if it had an interlock. So
a scheduler that starts anew in the middle of a pulse can learn of it, as in flight. COIL_STATUS and requests
may be lost; COIL_BOOT always arrives.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import Flag
from itertools import chain, repeat
from typing import NamedTuple, Protocol

from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilBoot, CoilFire, CoilStatus, Sync
from sim.record.candump import LogEntry
from sim.value_types import Vec3

EPOCH_S = 1_427_513_417
PATTERN_TICKS = 8
UNITS_PER_TICK = 1000
MOST_LEVEL = 3
MOST_LOCKOUT_MS = 163_830
MOST_REMAINING_MS = 4095
"""The largest lockout and rest of a pulse that COIL_STATUS can carry."""


@dataclass(frozen=True, slots=True)
class Limits:
    """The limits: the longest pulse, and the back-off after a pulse of any coil (shared) or of the same."""

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
    """The inputs of a scheduler in a tick.

    Attributes:
        tick: number of the tick; rises by one.
        m_body_am2: the mean dipole that the law asks for, body axes, A m^2.
        b_body_t: the field, body axes, T.
        attitude: for a law of your own.
        status: the board's COIL_STATUS of this tick; None where it was lost.
        booted: the board has just started, all coils locked out.
    """

    tick: int
    m_body_am2: Vec3
    b_body_t: Vec3
    attitude: Attitude
    status: CoilStatus | None
    booted: bool


class Scheduler(Protocol):
    """Decides in every tick what to fire. A request is driven from its tick on."""

    def step(self, heard: Heard, /) -> Sequence[Fire]:
        """The requests of this tick; at most one, if the limits are to be kept."""


MakeScheduler = Callable[[Limits], Scheduler]
"""Called whenever the scheduler boots."""


class Reboot(Flag):
    """What is started anew."""

    NOBODY = 0
    SCHEDULER = 1
    BOARD = 2


class Stretch(NamedTuple):
    """A number of ticks with one demand. In tick n a message is lost if bit n modulo 8 is set."""

    ticks: int
    m_body_am2: Vec3
    b_body_t: Vec3
    attitude: Attitude = UNKNOWN
    reboot: Reboot = Reboot.NOBODY
    lost_statuses: int = 0
    lost_requests: int = 0


class Flight(NamedTuple):
    """The course of a flight: limits, first tick, and stretches; reboots happen at the start of a stretch.

    All stretches are repeated ``laps`` times.
    """

    limits: Limits
    first_tick: int
    stretches: tuple[Stretch, ...]
    laps: int = 1


class TickRecord(NamedTuple):
    """The record of a tick.

    Attributes:
        tick: its number.
        line: that of its first frame in the log.
        booted: the board has just started.
        statuses: COIL_STATUS of every coil that was driven, or of one that was not.
        requests: all requests of the tick, lost or not.
        unsafe: since it booted, the board has driven something that an interlock would have refused.
    """

    tick: int
    line: int
    booted: bool
    statuses: tuple[CoilStatus, ...]
    requests: Sequence[Fire]
    unsafe: bool


class _DrivenCoil(NamedTuple):
    """A coil that is driven: its level, and until when in units of 1 / (1000 tick_hz) s."""

    level: int
    end: int


class _Board:
    """Drives each coil as last requested. Instants are units of 1 / (1000 tick_hz) s from tick 0."""

    def __init__(self, limits: Limits, tick: int) -> None:
        self._limits = limits
        self._now = tick * UNITS_PER_TICK
        self._on: dict[int, _DrivenCoil] = {}
        self._backoff = limits.backoff_ms * limits.tick_hz
        self._ready = [self._now + self._backoff] * 3
        self._statuses = 0
        self._seq = 0
        self.unsafe = False

    def begin_tick(self, tick: int) -> tuple[CoilStatus, ...]:
        """A COIL_STATUS of each coil that was driven in the tick that ends now, or of one that was not."""
        self._now = now = tick * UNITS_PER_TICK
        if self._on:
            statuses = tuple(self._status(coil, on.level, on.end) for coil, on in self._on.items())
            self._on = {coil: on for coil, on in self._on.items() if on.end > now}
        else:
            statuses = (self._status(tick % 3, 0, now),)
        self._statuses = (self._statuses + 1) & 0xF
        return statuses

    def fire(self, request: CoilFire) -> None:
        """Drive it, whatever else is driven; ``unsafe`` is set if an interlock would have refused it."""
        duration = request.duration_ms * self._limits.tick_hz
        self.unsafe = self.unsafe or not self._allows(request)
        if duration == 0 or request.level == 0:
            return
        end = self._now + duration
        self._on[request.coil] = _DrivenCoil(request.level, end)
        self._seq = request.seq
        for coil in range(3):
            if self._limits.shared or coil == request.coil:
                self._ready[coil] = max(self._ready[coil], end + self._backoff)

    def _allows(self, request: CoilFire) -> bool:
        coil, level = request.coil, request.level
        sound = coil < len(self._ready) and level != 0 and abs(level) <= MOST_LEVEL
        timely = sound and not self._on and self._ready[coil] <= self._now
        return timely and 0 < request.duration_ms <= self._limits.pulse_ms

    def _status(self, coil: int, level: int, end: int) -> CoilStatus:
        """The COIL_STATUS, its values bounded as on the bus."""
        hz, now = self._limits.tick_hz, self._now
        lockout = max(0, self._ready[coil] - now) if coil < len(self._ready) else 0
        return CoilStatus(
            level=level,
            coil=coil,
            remaining_ms=min(max(0, -((now - end) // hz)), MOST_REMAINING_MS),
            current_ma=0,
            lockout_ms=min(-(-lockout // (10 * hz)) * 10, MOST_LOCKOUT_MS),
            seq=self._seq,
            counter=self._statuses,
        )


def fly(make: MakeScheduler, flight: Flight) -> Iterator[LogEntry]:
    """Fly a scheduler: the log of the board, as it would be in bus.log."""
    hz = flight.limits.tick_hz
    for record in fly_ticks(make, flight):
        stamp_us = EPOCH_S * 1_000_000 + record.tick * 1_000_000 // hz
        for line, frame in enumerate(frames_of(record, hz), start=record.line):
            yield LogEntry(line, stamp_us, "bench", frame)


def frames_of(record: TickRecord, tick_hz: int) -> Iterator[Frame]:
    """The frames of a tick: those of the board, and SYNC."""
    if record.booted:
        yield CoilBoot(reason=0, version=1, table_crc=0).encode()
    for status in record.statuses:
        yield status.encode()
    yield Sync(record.tick, EPOCH_S + record.tick // tick_hz).encode()


def fly_ticks(make: MakeScheduler, flight: Flight) -> Iterator[TickRecord]:
    """Fly a scheduler, tick by tick."""
    limits, tick, line, seq = flight.limits, flight.first_tick, 1, 0
    board, scheduler, boots = _Board(limits, tick), make(limits), True
    for stretch in chain.from_iterable(repeat(flight.stretches, flight.laps)):
        ticks, m_body_am2, b_body_t, attitude, reboot, lost_statuses, lost_requests = stretch
        if Reboot.BOARD in reboot:
            board, boots = _Board(limits, tick), True
        if Reboot.SCHEDULER in reboot:
            scheduler = make(limits)
        for index in range(ticks):
            statuses = board.begin_tick(tick)
            bit = index % PATTERN_TICKS
            status = None if lost_statuses >> bit & 1 else statuses[-1]
            requests = scheduler.step(Heard(tick, m_body_am2, b_body_t, attitude, status, boots))
            yield TickRecord(tick, line, boots, statuses, requests, board.unsafe)
            for request in requests:
                seq += 1
                if not lost_requests >> bit & 1:
                    board.fire(_as_sent(request, seq, tick))
            tick, line, boots = tick + 1, line + boots + len(statuses) + 1, False


def _as_sent(request: Fire, seq: int, tick: int) -> CoilFire:
    """The request as received, its values cut to the width of their fields."""
    coil, level, duration_ms = request
    return CoilFire.decode(CoilFire(level, coil, seq & 0xFF, tick & 0xFF, duration_ms).encode().data)
