"""The coil interlock: enforces length of a pulse, back-off, one coil and three levels, by integers alone.

Invariant, whatever is requested and however often the board restarts: no pulse lasts longer than
``pulse_ms``, no pulse starts earlier than ``backoff_ms`` after the end of the one before it (of any coil,
or of the same coil), no more than one coil is on, and every level is one of -3..3.

Time is counted in units of 1 / (1000 tick_hz) s: a tick is 1000 units and a millisecond is ``tick_hz`` units,
so that every duration is exact at every tick rate. All timers run down to zero; none is ever set by anything
but ``boot``, ``silence`` and ``accept``.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

from fsw.wire.messages import CoilFire, CoilRefusedReason

UNITS_PER_TICK: Final = 1000
COILS: Final = 3
MAX_LEVEL: Final = 3


@dataclass(frozen=True, slots=True)
class CoilLimits:
    """What a coil driver board enforces.

    Args:
        tick_hz: ticks a second.
        pulse_ms: longest pulse [ms].
        backoff_ms: shortest time from the end of a pulse to the next start [ms].
        shared: the back-off holds for all coils (True) or for each coil by itself.
        table_crc: CRC-32 of the table these values come from, reported in ``COIL_BOOT``.

    Raises:
        ValueError: a value is not an integer of its range.
    """

    tick_hz: int
    pulse_ms: int = 3000
    backoff_ms: int = 100_000
    shared: bool = True
    table_crc: int = 0

    def __post_init__(self) -> None:
        for name, low, high in (
            ("tick_hz", 1, 1000),
            ("pulse_ms", 1, 65_535),
            ("backoff_ms", 0, 10_000_000),
            ("table_crc", 0, 0xFFFF_FFFF),
        ):
            value = getattr(self, name)
            if type(value) is not int or not low <= value <= high:
                raise ValueError(f"{name} must be an integer in [{low}, {high}], not {value!r}")

    def units(self, milliseconds: int) -> int:
        """Milliseconds as units of time."""
        return milliseconds * self.tick_hz

    def milliseconds(self, units: int, resolution_ms: int = 1) -> int:
        """Units of time as milliseconds, rounded up to the resolution: 0 only when nothing is left."""
        return -(-units // (self.tick_hz * resolution_ms)) * resolution_ms


Lockouts = tuple[int, int, int]


@final
@dataclass(slots=True)
class Interlock:
    """State at a tick, changed in place. Times are in units.

    Args:
        coil: coil that is on, or was on last.
        level: its level in the tick that has just ended or in the one that begins; otherwise 0.
        remaining: rest of its pulse; a coil is on exactly while this is not 0.
        lockout: for each coil, time until it may be fired again.
        seq: sequence number of the last accepted request; None after boot.
    """

    coil: int
    level: int
    remaining: int
    lockout: Lockouts
    seq: int | None


def boot(limits: CoilLimits) -> Interlock:
    """All coils off and locked out in full: a restart costs a whole back-off, as no timer survives it."""
    full = limits.units(limits.backoff_ms)
    return Interlock(coil=0, level=0, remaining=0, lockout=(full, full, full), seq=None)


def silence(state: Interlock, limits: CoilLimits) -> None:
    """The dead-man: no SYNC for too long, so all is off and locked out in full, as after boot.

    The sequence number stays: a request that was carried out before is still a repeated one.
    """
    full = limits.units(limits.backoff_ms)
    state.coil = state.level = state.remaining = 0
    state.lockout = (full, full, full)


def elapse(state: Interlock, ticks: int) -> None:
    """Advance by ticks. A level stays visible for the last tick in which it was driven."""
    if ticks < 0:
        raise ValueError("time does not run backwards")
    units = ticks * UNITS_PER_TICK
    if state.remaining <= units - UNITS_PER_TICK:
        state.level = 0
    state.remaining = max(0, state.remaining - units)
    a, b, c = state.lockout
    state.lockout = (max(0, a - units), max(0, b - units), max(0, c - units))


_Rule = Callable[[Interlock, CoilFire, int, CoilLimits], bool]

_REFUSED_IF: Final[tuple[tuple[CoilRefusedReason, _Rule], ...]] = (
    (CoilRefusedReason.WRONG_TICK, lambda state, request, tick, limits: request.tick != tick & 0xFF),
    (CoilRefusedReason.REPEATED_SEQ, lambda state, request, tick, limits: request.seq == state.seq),
    (CoilRefusedReason.BAD_COIL, lambda state, request, tick, limits: not 0 <= request.coil < COILS),
    (
        CoilRefusedReason.BAD_LEVEL,
        lambda state, request, tick, limits: not 1 <= abs(request.level) <= MAX_LEVEL,
    ),
    (
        CoilRefusedReason.BAD_DURATION,
        lambda state, request, tick, limits: not 1 <= request.duration_ms <= limits.pulse_ms,
    ),
    (CoilRefusedReason.COIL_ON, lambda state, request, tick, limits: state.remaining > 0),
    (CoilRefusedReason.LOCKOUT, lambda state, request, tick, limits: state.lockout[request.coil] > 0),
)
"""The rules in the order in which they are applied; the first that applies is the reason."""

REFUSAL_ORDER: Final = tuple(reason for reason, _ in _REFUSED_IF)
"""The reasons in that order, for the specification of the board."""


def judge(state: Interlock, request: CoilFire, tick: int, limits: CoilLimits) -> CoilRefusedReason | None:
    """Why a request at ``tick`` is refused; None: it may be accepted."""
    for reason, applies in _REFUSED_IF:
        if applies(state, request, tick, limits):
            return reason
    return None


def accept(state: Interlock, request: CoilFire, limits: CoilLimits) -> None:
    """Drive the coil from this tick on for the requested duration, and lock out for that and the back-off."""
    state.coil, state.level, state.seq = request.coil, request.level, request.seq
    state.remaining = limits.units(request.duration_ms)
    until_next = state.remaining + limits.units(limits.backoff_ms)
    a, b, c = state.lockout
    state.lockout = (
        until_next if limits.shared or request.coil == 0 else a,
        until_next if limits.shared or request.coil == 1 else b,
        until_next if limits.shared or request.coil == 2 else c,
    )
