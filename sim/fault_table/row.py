"""Rows of the fault table and their results, as values."""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from math import inf

from sim.audit.findings import AuditLimits
from sim.fault_rig.currents import CurrentLimits
from sim.fault_rig.record import FaultFlightRecord

SCENARIO = "microsat"


class CheckVerdict(StrEnum):
    """The verdict of a check."""

    PASS = "PASS"
    FAIL = "FAIL"
    OPEN = "not yet"
    """No verdict: no function of the flight software could meet it, or there was too little evidence."""


class When(StrEnum):
    """The reference from which the phases of a row are counted."""

    PULSE = "pulse"
    """The tick in which a pulse begins; phases cover the pulse and the back-off after it."""
    SUNLIT = "sunlit"
    """Well after the start, in sunlight."""
    BOOT = "boot"
    """The first tick; each phase begins with another attitude."""
    ECLIPSE = "eclipse"
    """The last minutes of sunlight before an eclipse, and the first of it."""
    ORBIT = "orbit"
    """After a whole orbit; each phase begins at another point of the orbit."""


class Unseen(StrEnum):
    """When nothing on board can show that an attitude is wrong."""

    NEVER = ""
    IN_SHADOW = "in the shadow nothing shows it"
    """The sensor that is wrong is the only one there is."""
    AT_FIRST = "for its first minutes both sensors agree, in the shadow nothing shows it"
    """A late field sample looks like a magnetometer bias until the satellite has turned."""
    WITHIN_BOUND = "the light of the Earth may turn the Sun by as much"
    """An albedo of 60 %, as is declared, turns the Sun that a sensor sees by up to 14 deg."""
    SETTLING = "in the orbit after its start an estimate from Sun cells settles"
    """Errors of the cells and the light of the Earth are estimated while the cells see the Sun in turn."""
    ALONE = "with one sensor left little shows it"
    """Pulses of a coil, or a slow drift, turn the satellite about the only direction that is measured."""
    ALWAYS = "both sensors agree"


@dataclass(frozen=True, slots=True)
class RowFault:
    """One of the faults of a row: it begins ``after_s`` after the first one.

    ``shows``: False where nothing left on board may reveal it, so that its unit need not be named.
    """

    kind: str
    parameters: dict[str, float]
    lasts_s: float
    unit: str
    after_s: float = 0.0
    shows: bool = True


@dataclass(frozen=True, slots=True)
class FaultRow:
    """A fault, and the checks that flights with it must pass.

    Attributes:
        name: short and unique; ``--row`` takes it or its first words.
        group: heading under which the page lists it.
        kind: of fault, as in ``kinds.KINDS``.
        parameters: of that kind, where they differ from its defaults.
        lasts_s: duration of the fault; infinite: permanent.
        when: reference of the phases.
        expect: names of the checks in addition to those of every row.
        unit: the faulty unit, which may be isolated, and must be for the check ``named``.
        within_s: by when ``named`` must hold, from the onset of the unit's fault.
        then: further faults, each with a faulty unit of its own.
        unseen: when a wrong attitude may be called valid.
        settings: of the scenario.
        scenario: the one flown; every second case of the default one flies a satellite of the population.
        slow: it runs real processes, which takes seconds.
        watch_s: least duration of the flight after the fault; with ``recovers`` until that is decided.
    """

    name: str
    group: str
    kind: str
    parameters: dict[str, float] = field(default_factory=dict)
    lasts_s: float = 120.0
    when: When = When.PULSE
    expect: tuple[str, ...] = ()
    unit: str = ""
    within_s: float = inf
    then: tuple[RowFault, ...] = ()
    unseen: Unseen = Unseen.NEVER
    settings: tuple[str, ...] = ()
    scenario: str = SCENARIO
    watch_s: float = 330.0
    slow: bool = False

    @property
    def faults(self) -> tuple[RowFault, ...]:
        """All faults, in the order in which they begin."""
        return (RowFault(self.kind, self.parameters, self.lasts_s, self.unit), *self.then)

    @property
    def stays(self) -> bool:
        """Whether a fault is permanent."""
        return any(fault.lasts_s == inf for fault in self.faults)


@dataclass(frozen=True, slots=True)
class CheckOutcome:
    """The outcome of one check of one case; ``said``, a key of faults.json, is the finding."""

    check: str
    verdict: CheckVerdict
    said: str = ""


@dataclass(frozen=True, slots=True)
class CaseResult:
    """The result of one phase and seed of a row.

    Attributes:
        row: its name.
        phase: number of the phase.
        seed: the seed.
        outcomes: the checks.
        measured: figures by name; a row shows the largest.
        wall_s: wall time of the case.
    """

    row: str
    phase: int
    seed: int
    outcomes: tuple[CheckOutcome, ...]
    measured: dict[str, float]
    wall_s: float = 0.0

    @property
    def failed(self) -> bool:
        """Whether a check failed."""
        return any(outcome.verdict is CheckVerdict.FAIL for outcome in self.outcomes)


@dataclass(frozen=True, slots=True)
class RowResult:
    """All cases of a row."""

    row: FaultRow
    cases: tuple[CaseResult, ...]

    @property
    def verdict(self) -> CheckVerdict:
        """The worst of all checks."""
        verdicts = {outcome.verdict for case in self.cases for outcome in case.outcomes}
        for worst in (CheckVerdict.FAIL, CheckVerdict.OPEN):
            if worst in verdicts:
                return worst
        return CheckVerdict.PASS

    @property
    def measured(self) -> dict[str, float]:
        """The largest figure of each name over all cases."""
        names = list(dict.fromkeys(name for case in self.cases for name in case.measured))
        return {
            name: max(case.measured[name] for case in self.cases if name in case.measured) for name in names
        }

    def first(self, verdict: CheckVerdict) -> tuple[CaseResult, CheckOutcome] | None:
        """The first case and check with that verdict."""
        for case in self.cases:
            for outcome in case.outcomes:
                if outcome.verdict is verdict:
                    return case, outcome
        return None


@dataclass(frozen=True, slots=True)
class Bounds:
    """Bounds by which flights are judged."""

    audit: AuditLimits
    currents: CurrentLimits
    orbit_s: float
    backoff_s: float


Check = Callable[[FaultRow, FaultFlightRecord, Bounds], tuple[bool | None, str]]
"""Gives whether the check holds (None: not to be expected yet), and the finding."""
