"""Rate groups: work at a fraction of the tick rate, on ticks where ``tick % divisor == offset``."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RateGroup:
    """A divisor and an offset in ticks.

    Raises:
        ValueError: the group would never run, or the divisor is not positive.
    """

    divisor: int
    offset: int = 0

    def __post_init__(self) -> None:
        if self.divisor < 1:
            raise ValueError(f"a rate group needs a divisor of at least 1, not {self.divisor}")
        if not 0 <= self.offset < self.divisor:
            raise ValueError(f"a rate group of divisor {self.divisor} never runs at offset {self.offset}")

    def due(self, tick: int) -> bool:
        """Whether the group runs in this tick."""
        return tick % self.divisor == self.offset

    def in_turn(self, tick: int, length: int) -> int:
        """Which of ``length`` items the group takes in this tick, if it takes one at a time."""
        return tick // self.divisor % length


@dataclass(frozen=True, slots=True)
class RateTable:
    """When the slow reports are due."""

    attitude: RateGroup
    quality: RateGroup
    parameter: RateGroup
    heartbeat: RateGroup
