"""Two interlocks: one by the ticks of the bus, one by the board's own clock where it has one.

Ticks come over the bus, which cannot be trusted: a SYNC that comes too often would shorten a back-off, one
that stays away would lengthen a pulse. So a pulse is over when the first of the two says so, a back-off when
the last does, and a request is accepted only if both accept it.

The two need not agree, and neither waits for the other: time passes while no tick comes, and ticks may come
in no time. ``pass_time`` comes before every other call; otherwise the clock would stand still until the next
tick, and the time passed by then would be deducted from the back-off.

A board enters a tick as soon as fsw has answered the one before, to report it before its SYNC comes. Timers
by ticks refer to the reported instant; a pulse that ends at that instant stays on until the SYNC, or until
the clock ends it.
"""

from dataclasses import replace
from typing import Final

from fsw.wire.messages import CoilFire, CoilRefusedReason
from hil_stub.coils.interlock import (
    UNITS_PER_TICK,
    CoilLimits,
    Interlock,
    accept,
    boot,
    elapse,
    judge,
    silence,
)

CLOCK_HZ: Final = 1000
"""The board's own clock counts milliseconds."""
_FREE: Final = (0, 0, 0)


class Guard:
    """What may be driven, and for how much longer. Boots off with a full lockout.

    Args:
        limits: what is enforced.
    """

    def __init__(self, limits: CoilLimits) -> None:
        self._limits = limits
        self._clock_limits = replace(limits, tick_hz=CLOCK_HZ)
        self._by_ticks: Interlock = boot(limits)
        self._by_clock: Interlock | None = None
        self._clock_ms = 0  # its last reading, as soon as there is an interlock by it
        self._driven = False  # whether a coil was on at some instant since the last tick
        self._tick_under_way = False  # the last tick was entered, and its SYNC is still to come
        self._silent = False  # no SYNC has come since the dead-man woke
        self.level = 0
        """Driven in the tick that has ended, or just accepted."""

    def pass_time(self, clock_ms: int | None) -> None:
        """The board's own clock reads ``clock_ms`` (None: it has none). One that runs back is ignored."""
        if clock_ms is None:
            return
        if self._by_clock is None:
            self._by_clock, self._clock_ms = boot(self._clock_limits), clock_ms
        if clock_ms > self._clock_ms:
            elapse(self._by_clock, clock_ms - self._clock_ms)
            self._clock_ms = clock_ms

    def elapse(self, ticks: int) -> None:
        """Advance by ticks; the SYNC of the last is still to come."""
        self._tick_under_way = self.on
        elapse(self._by_ticks, ticks)
        self.level = self._by_ticks.level if self._driven else 0
        self._driven = self.on

    def sync(self) -> None:
        """The SYNC of this tick: the one before is over."""
        self._tick_under_way = self._silent = False

    def silence(self) -> None:
        """No SYNC for too long: off and locked out in full, and until the next SYNC in any case."""
        silence(self._by_ticks, self._limits)
        if self._by_clock is not None:
            silence(self._by_clock, self._clock_limits)
        self.level, self._driven, self._tick_under_way, self._silent = 0, False, False, True

    def ask(self, request: CoilFire, tick: int) -> CoilRefusedReason | None:
        """Judge a request at ``tick``: why it is refused (None: accepted). A refused one changes nothing."""
        by_ticks, by_clock = self._by_ticks, self._by_clock
        reason = judge(by_ticks, request, tick, self._limits)
        if reason is None and by_clock is not None:
            reason = judge(by_clock, request, tick, self._clock_limits)
        if reason is None and self._silent:
            reason = CoilRefusedReason.LOCKOUT
        if reason is None:
            accept(by_ticks, request, self._limits)
            if by_clock is not None:
                accept(by_clock, request, self._clock_limits)
            self.level, self._driven = by_ticks.level, True
        return reason

    @property
    def coil(self) -> int:
        """The coil that is on, or was on last."""
        return self._by_ticks.coil

    @property
    def seq(self) -> int | None:
        """Sequence number of the last accepted request; None after boot."""
        return self._by_ticks.seq

    @property
    def remaining_units(self) -> int:
        """Rest of the pulse, in units of the interlock, a thousandth of a tick."""
        by_ticks, by_clock = self._by_ticks, self._by_clock
        if by_clock is None:
            return by_ticks.remaining
        return min(by_ticks.remaining, by_clock.remaining * self._limits.tick_hz // CLOCK_HZ)

    @property
    def on(self) -> bool:
        """Whether a coil is on at the instant of this tick."""
        return self.remaining_units > 0

    @property
    def drives(self) -> bool:
        """Whether a coil is on now."""
        if self._by_clock is None:
            return self.on
        by_ticks = self._by_ticks.remaining > 0 or self._tick_under_way
        return by_ticks and self._by_clock.remaining > 0

    @property
    def ends_ms(self) -> int | None:
        """When what is on now goes off at the latest, by the board's own clock; None: it has none."""
        if self._by_clock is None:
            return None
        return self._clock_ms + self._by_clock.remaining // UNITS_PER_TICK

    @property
    def fraction(self) -> float:
        """Fraction of the tick that begins for which the pulse still lasts."""
        return min(self.remaining_units, UNITS_PER_TICK) / UNITS_PER_TICK

    def remaining_ms(self) -> int:
        """Rest of the pulse, rounded up."""
        return self._limits.milliseconds(self.remaining_units)

    def lockout_ms(self, coil: int) -> int:
        """Time until the coil may be fired again, rounded up to 10 ms."""
        by_ticks = self._limits.milliseconds(self._by_ticks.lockout[coil], 10)
        if self._by_clock is None:
            return by_ticks
        return max(by_ticks, self._clock_limits.milliseconds(self._by_clock.lockout[coil], 10))

    @property
    def locked_out(self) -> bool:
        """Whether the back-off of any coil runs, or the dead-man holds all."""
        by_clock = self._by_clock
        runs = self._by_ticks.lockout != _FREE or (by_clock is not None and by_clock.lockout != _FREE)
        return self._silent or runs
