"""What is claimed, and what became of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import inf
from typing import Any


class Verdict(StrEnum):
    """What a claim's figure says."""

    PASS = "PASS"
    FAIL = "FAIL"
    ABSENT = "absent"
    """There is nothing here to judge it by."""


@dataclass(frozen=True, slots=True)
class Claim:
    """One line of the table: a figure that lies between two limits.

    Attributes:
        id: short and unique; ``--only`` takes it or its first words.
        statement: what the figure is.
        source: who says so.
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

    def judge(self, ours: float, where: str = "") -> "Outcome":
        """The outcome of a figure; one that is not a number fails."""
        passed = self.low <= ours <= self.high
        return Outcome(self, Verdict.PASS if passed else Verdict.FAIL, ours, where)

    @property
    def limits(self) -> str:
        """The limits for a person."""
        if self.low == -inf:
            return "0" if self.high == 0.0 else f"<= {self.high:.6g}"
        if self.high == inf:
            return f">= {self.low:.6g}"
        return f"{self.low:.6g} to {self.high:.6g}"


@dataclass(frozen=True, slots=True)
class Outcome:
    """A claim with its figure and verdict; ``where`` names the worst case."""

    claim: Claim
    verdict: Verdict
    ours: float | None = None
    where: str = ""


Task = Callable[[], Any]
"""Computes something that can be sent between processes; can be sent itself."""


@dataclass(frozen=True, slots=True)
class Study:
    """Work that decides about some claims together.

    Attributes:
        id: the first word of its claims' ids.
        tasks: independent of each other and of the order in which they run.
        conclude: the outcomes, from the tasks' results in order.
        flown: whether the tasks are flights, which take minutes.
    """

    id: str
    tasks: tuple[Task, ...]
    conclude: Callable[[Sequence[Any]], list[Outcome]]
    flown: bool = False
