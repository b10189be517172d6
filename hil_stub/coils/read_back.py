"""Current read-back: the measured supply current against the nominal one of the driven level."""

from dataclasses import dataclass
from math import copysign
from typing import Final

from fsw.wire.coil_current import OFF_PART
from hil_stub.coils.events import CoilEventCode

_NONE: Final = 0.1
"""A current of a driven coil below this fraction of the nominal one counts as none."""


@dataclass(frozen=True, slots=True)
class ReadBack:
    """Nominal currents and their tolerance.

    Args:
        nominal_a: at levels 1, 2, 3 [A].
        settle_ms: time that a current takes to follow a change [ms]; until then it is not judged.
        tolerance: largest deviation, as a fraction of the nominal current.

    Raises:
        ValueError: the currents do not rise from above zero, or another value is out of range.
    """

    nominal_a: tuple[float, float, float]
    settle_ms: int = 100
    tolerance: float = 0.2

    def __post_init__(self) -> None:
        low, middle, high = self.nominal_a
        if not 0.0 < low < middle < high:
            raise ValueError(f"nominal_a must be three rising currents above 0, not {self.nominal_a}")
        if self.settle_ms < 0 or not 0.0 < self.tolerance < 1.0:
            raise ValueError("settle_ms must not be negative, and tolerance lie between 0 and 1")

    def judge(self, level: int, current_a: float) -> CoilEventCode | None:
        """What is wrong with a settled current at a level (0: all coils are off); None if it is right.

        A read-back that is not a number is wrong at every level.
        """
        if level == 0:
            in_order = abs(current_a) <= OFF_PART * self.nominal_a[0]
            return None if in_order else CoilEventCode.CURRENT_WHILE_OFF
        part = current_a / copysign(self.nominal_a[abs(level) - 1], level)
        if abs(part - 1.0) <= self.tolerance:
            return None
        if part < -_NONE:
            return CoilEventCode.CURRENT_REVERSED
        return CoilEventCode.NO_CURRENT if part <= _NONE else CoilEventCode.CURRENT_WRONG
