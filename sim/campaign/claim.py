"""Claims, their verdicts, and the studies that decide them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import inf
from typing import Any

MOST_ROOM = 10.0
"""By what factor a figure may be better than a limit that is chosen here."""


class Threshold(StrEnum):
    """Where the limits of a claim come from."""

    PAPER = "paper"
    """As the source prints them, or as its statistics give them."""
    REFERENCE = "reference file"
    """As the header of the reference file says."""
    PROTOTYPE = "own prototype"
    """What an earlier computation of this project's own has found."""
    REQUIRED = "own requirement"
    """Asked here of the project before the figure was computed."""
    OWN = "own, set afterwards"
    """Set here once the figure was known, close to it, so that a change shows."""
    FITTED = "fitted"
    """The paper's figure, to which a number of the scenario was fitted: that it is met shows nothing."""


class ClaimVerdict(StrEnum):
    """The verdict on a claim."""

    PASS = "PASS"
    FAIL = "FAIL"
    FITTED = "fitted"
    """Within its limits, but fitted to them."""
    ABSENT = "absent"
    """The data to judge it by are missing."""
    TOO_FEW = "too few to judge"
    """Fewer flights than the claim is made for: their median or mean is no verdict on that of all."""


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
        threshold: where the limits come from.
        wide: why limits chosen here are far from the figure; empty where they are close.
    """

    id: str
    statement: str
    source: str
    unit: str
    low: float = -inf
    high: float = inf
    threshold: Threshold = Threshold.OWN
    wide: str = ""

    def judge(self, ours: float, where: str = "", spread: "Spread | None" = None) -> "ClaimOutcome":
        """The outcome of a figure; one that is not a number fails."""
        met = ClaimVerdict.FITTED if self.threshold is Threshold.FITTED else ClaimVerdict.PASS
        return ClaimOutcome(self, met if self.meets(ours) else ClaimVerdict.FAIL, ours, where, spread)

    def meets(self, ours: float) -> bool:
        """Whether a figure is within the limits."""
        return self.low <= ours <= self.high

    def is_loose(self, ours: float) -> bool:
        """Whether a figure meets a limit of this project's own by far, without a reason given."""
        own = self.threshold in (Threshold.OWN, Threshold.PROTOTYPE)
        return own and self.meets(ours) and not self.wide and self.room(ours) > MOST_ROOM

    def room(self, ours: float) -> float:
        """By what factor a figure could be worse, on the side with the most room; infinite from zero."""
        limits = [limit for limit in (self.low, self.high) if abs(limit) != inf and limit != ours]
        return max((_factor(limit, ours) for limit in limits), default=1.0)

    @property
    def limits(self) -> str:
        """The limits as text."""
        if self.low == -inf:
            return "0" if self.high == 0.0 else f"<= {self.high:.6g}"
        if self.high == inf:
            return f">= {self.low:.6g}"
        return f"{self.low:.6g} to {self.high:.6g}"


def _factor(limit: float, ours: float) -> float:
    """The larger of two numbers over the smaller one, by their sizes; infinite across zero."""
    small, large = sorted((abs(limit), abs(ours)))
    return large / small if small > 0.0 and limit * ours > 0.0 else inf


@dataclass(frozen=True, slots=True)
class Spread:
    """What all flights behind the one figure of a claim give: how many meet its limits, and the range."""

    flights: int
    meet: int
    least: float
    median: float
    most: float


@dataclass(frozen=True, slots=True)
class ClaimOutcome:
    """A claim with its figure and verdict; ``where`` names the worst case."""

    claim: Claim
    verdict: ClaimVerdict
    ours: float | None = None
    where: str = ""
    spread: Spread | None = None


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
        here: whether they run in this process: a function without a module can be given to no other.
    """

    id: str
    tasks: tuple[Task, ...]
    conclude: Callable[[Sequence[Any]], list[ClaimOutcome]]
    has_flights: bool = False
    here: bool = False
