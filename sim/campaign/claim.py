"""Claims, their verdicts, and the studies that decide them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import inf
from typing import Any


class ClaimVerdict(StrEnum):
    """The verdict on a claim."""

    PASS = "PASS"
    FAIL = "FAIL"
    ABSENT = "absent"
    """The data to judge it by are missing."""


@dataclass(frozen=True, slots=True)
class Claim:
    """One line of the table: a figure that lies between two limits.

    Attributes:
        id: short and unique; ``--only`` takes it or its first words.
        statement: what the figure is.
        source: where the claim is from.
        unit: of figure and limits.
        low: least that passes.
        high: most that passes.
    """

    id: str
    statement: str
    source: str
    unit: str
    low: float = -inf
    high: float = inf

    def judge(self, ours: float, where: str = "") -> "ClaimOutcome":
        """The outcome of a figure; one that is not a number fails."""
        passed = self.low <= ours <= self.high
        return ClaimOutcome(self, ClaimVerdict.PASS if passed else ClaimVerdict.FAIL, ours, where)

    @property
    def limits(self) -> str:
        """The limits as text."""
        if self.low == -inf and self.high == inf:
            return "no limit"
        if self.low == -inf:
            return "0" if self.high == 0.0 else f"<= {self.high:.6g}"
        if self.high == inf:
            return f">= {self.low:.6g}"
        return f"{self.low:.6g} to {self.high:.6g}"


@dataclass(frozen=True, slots=True)
class ClaimOutcome:
    """A claim with its figure and verdict; ``where`` names the worst case."""

    claim: Claim
    verdict: ClaimVerdict
    ours: float | None = None
    where: str = ""


Task = Callable[[], Any]
"""A picklable function with a picklable result."""


@dataclass(frozen=True, slots=True)
class Study:
    """Tasks that decide some claims together.

    Attributes:
        id: the first word of its claims' ids.
        tasks: independent of each other and of the order in which they run.
        conclude: the outcomes, from the tasks' results in order.
        has_flights: whether the tasks are flights, which take minutes.
    """

    id: str
    tasks: tuple[Task, ...]
    conclude: Callable[[Sequence[Any]], list[ClaimOutcome]]
    has_flights: bool = False
