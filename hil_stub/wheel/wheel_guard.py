"""What the motor of a wheel may be asked for: rules in their order, pure functions of what is known.

Invariant, whatever is requested: the motor torque is never above ``max_torque_nm``, never speeds up a wheel
that turns at ``max_speed_radps`` or faster, and lasts one tick. Without a torque the wheel coasts.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import Final, final

from fsw.wire.messages import WheelStatusResult
from fsw.wire.value import Value

LARGEST_NM: Final = 0.5
LARGEST_RADPS: Final = 2048.0
"""Ranges of the signals ``torque`` and ``speed``."""


@dataclass(frozen=True, slots=True)
class WheelLimits:
    """What a wheel board enforces.

    Args:
        tick_hz: ticks a second.
        max_torque_nm: largest motor torque.
        max_speed_radps: speed, relative to the body, from which the wheel is not sped up.

    Raises:
        ValueError: a value is out of range.
    """

    tick_hz: int
    max_torque_nm: float
    max_speed_radps: float

    def __post_init__(self) -> None:
        if type(self.tick_hz) is not int or not 1 <= self.tick_hz <= 1000:
            raise ValueError(f"tick_hz must be an integer in [1, 1000], not {self.tick_hz!r}")
        if not 0.0 < self.max_torque_nm < LARGEST_NM:
            raise ValueError(f"max_torque_nm must be above 0 and below {LARGEST_NM:g}")
        if not 0.0 < self.max_speed_radps < LARGEST_RADPS:
            raise ValueError(f"max_speed_radps must be above 0 and below {LARGEST_RADPS:g}")

    @property
    def hold_ms(self) -> int:
        """How long a torque lasts by the board's own clock: a tick, rounded up."""
        return -(-1000 // self.tick_hz)


@final
class Asked(Value):
    """A request, and what the board knows when it comes.

    ``tick`` and ``answered``: low 8 bits of the tick that the request names, and the tick that can be
    answered, None for none; ``taken``: a request has been taken in this tick; ``speed_radps`` is None where
    it cannot be measured.
    """

    FIELDS = ("torque_nm", "tick", "answered", "taken", "speed_radps")
    __slots__ = FIELDS

    def __init__(
        self, torque_nm: float, tick: int, answered: int | None, taken: bool, speed_radps: float | None
    ) -> None:
        self.torque_nm = torque_nm
        self.tick = tick
        self.answered = answered
        self.taken = taken
        self.speed_radps = speed_radps


def _stale(asked: Asked, limits: WheelLimits) -> bool:
    return asked.answered is None or asked.tick != asked.answered & 0xFF


def _speeds_up(asked: Asked, limits: WheelLimits) -> bool:
    speed_radps = asked.speed_radps or 0.0
    return abs(speed_radps) >= limits.max_speed_radps and asked.torque_nm * speed_radps > 0.0


_REFUSED_IF: Final[tuple[tuple[WheelStatusResult, Callable[[Asked, WheelLimits], bool]], ...]] = (
    (WheelStatusResult.WRONG_TICK, _stale),
    (WheelStatusResult.SECOND_TORQUE, lambda asked, limits: asked.taken),
    (WheelStatusResult.BAD_TORQUE, lambda asked, limits: not abs(asked.torque_nm) <= limits.max_torque_nm),
    (WheelStatusResult.NO_SPEED, lambda asked, limits: asked.speed_radps is None),
    (WheelStatusResult.TOO_FAST, _speeds_up),
)
"""The rules in the order in which they are applied; the first that applies is the result."""

REFUSAL_ORDER: Final = tuple(result for result, _ in _REFUSED_IF)
"""The results in that order, for the specification of the board."""


def judge(asked: Asked, limits: WheelLimits) -> WheelStatusResult:
    """What becomes of a request: ``DRIVEN``, or why it is refused."""
    for result, applies in _REFUSED_IF:
        if applies(asked, limits):
            return result
    return WheelStatusResult.DRIVEN


def measured(speed_radps: float) -> float | None:
    """The speed, or None if it is not a number that the status can hold."""
    return speed_radps if isfinite(speed_radps) and abs(speed_radps) < LARGEST_RADPS else None
