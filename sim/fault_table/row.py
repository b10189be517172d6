"""One row of the fault table, and what becomes of it, as values."""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from math import inf

from sim.audit.findings import AuditLimits
from sim.fault_rig.currents import CurrentLimits
from sim.fault_rig.record import Record


class Verdict(StrEnum):
    """What a check says."""

    PASS = "PASS"
    FAIL = "FAIL"
    OPEN = "not yet"
    """The flight software has nothing yet that could do what is expected."""


class When(StrEnum):
    """What the phases of a row are counted from."""

    PULSE = "pulse"
    """The tick in which a pulse begins; phases go through the pulse and the back-off after it."""
    SUNLIT = "sunlit"
    """Well after the start, in sunlight."""
    BOOT = "boot"
    """The first tick; each phase begins with another attitude."""
    ECLIPSE = "eclipse"
    """The last minutes of sunlight before an eclipse, and the first of it."""


@dataclass(frozen=True, slots=True)
class Row:
    """A fault with what is expected of it.

    Attributes:
        name: short and unique; ``--row`` takes it or its first words.
        group: the line of the fault table that it belongs to.
        kind: of fault, as in ``kinds.KINDS``.
        parameters: of that kind, where they are not its defaults.
        lasts_s: how long it is there; infinite: it stays.
        when: what phases are counted from.
        expect: names of the checks beside those that every row must pass.
        unit: the sensor or coil that must be named, for the check ``named``.
        settings: of the scenario.
        slow: it flies a real process, which takes seconds.
        watch_s: flown after the fault, at least; ``recovers`` flies on until it is decided.
    """

    name: str
    group: str
    kind: str
    parameters: dict[str, float] = field(default_factory=dict)
    lasts_s: float = 120.0
    when: When = When.PULSE
    expect: tuple[str, ...] = ()
    unit: str = ""
    settings: tuple[str, ...] = ()
    watch_s: float = 330.0
    slow: bool = False

    @property
    def stays(self) -> bool:
        """Whether the fault is there for ever."""
        return self.lasts_s == inf


@dataclass(frozen=True, slots=True)
class Outcome:
    """One check of one case."""

    check: str
    verdict: Verdict
    said: str = ""


@dataclass(frozen=True, slots=True)
class CaseResult:
    """One phase and seed of a row.

    Attributes:
        row: its name.
        phase: number of the phase.
        seed: the seed.
        outcomes: the checks.
        measured: figures by name; of a row the largest counts.
        wall_s: what it took.
    """

    row: str
    phase: int
    seed: int
    outcomes: tuple[Outcome, ...]
    measured: dict[str, float]
    wall_s: float = 0.0

    @property
    def failed(self) -> bool:
        """Whether an expectation is violated."""
        return any(outcome.verdict is Verdict.FAIL for outcome in self.outcomes)


@dataclass(frozen=True, slots=True)
class RowResult:
    """All cases of a row; ``kept``: an earlier run has flown them."""

    row: Row
    cases: tuple[CaseResult, ...]
    kept: bool = False

    @property
    def verdict(self) -> Verdict:
        """The worst of all checks."""
        verdicts = {outcome.verdict for case in self.cases for outcome in case.outcomes}
        for worst in (Verdict.FAIL, Verdict.OPEN):
            if worst in verdicts:
                return worst
        return Verdict.PASS

    @property
    def measured(self) -> dict[str, float]:
        """The largest figure of each name over all cases."""
        names = list(dict.fromkeys(name for case in self.cases for name in case.measured))
        return {
            name: max(case.measured[name] for case in self.cases if name in case.measured) for name in names
        }

    def first(self, verdict: Verdict) -> tuple[CaseResult, Outcome] | None:
        """The first case and check with that verdict."""
        for case in self.cases:
            for outcome in case.outcomes:
                if outcome.verdict is verdict:
                    return case, outcome
        return None


@dataclass(frozen=True, slots=True)
class Bounds:
    """What a flight is judged by."""

    audit: AuditLimits
    currents: CurrentLimits
    orbit_s: float
    backoff_s: float


Check = Callable[[Row, Record, Bounds], tuple[bool | None, str]]
"""Whether it holds (None: not yet to be expected) and what was found."""
