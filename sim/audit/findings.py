"""The result of an audit of the actuator limits, as values."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from itertools import pairwise

COILS = (0, 1, 2)


class ViolationKind(StrEnum):
    """The rule that a violation breaks."""

    PULSE = "pulse"
    ANNOUNCED = "announced"
    GAP = "gap"
    BOOT = "boot"
    LEVEL = "level"
    COIL = "coil"
    TWO_COILS = "two_coils"
    FRAME = "frame"
    TIMESTAMP = "timestamp"
    SYNC = "sync"
    DRIVER = "driver"


@dataclass(frozen=True, slots=True)
class AuditLimits:
    """The limits that the board must keep.

    Attributes:
        pulse_us: longest pulse [us].
        backoff_us: least time from the end of a pulse to the start of the next [us].
        max_level: largest magnitude of a level.
        shared: the back-off is from a pulse of any coil; otherwise from one of the same coil.
        tick_hz: rate that the scenario states; the log's own SYNC overrules it.
        on_fraction: part of a tick for which a continuous driver drives, which has no limits on pulses; None:
            the driver is pulsed.
    """

    pulse_us: int = 3_000_000
    backoff_us: int = 100_000_000
    max_level: int = 3
    shared: bool = True
    tick_hz: int | None = None
    on_fraction: float | None = None

    @property
    def is_continuous(self) -> bool:
        """Whether the driver drives fractions of its full scale, without limits on pulses."""
        return self.on_fraction is not None

    def most_duty(self, time_s: float) -> float:
        """The largest fraction of a time that pulses under one back-off can take; a short time fits more.

        Of a continuous driver it is that of a tick.
        """
        if self.on_fraction is not None:
            return self.on_fraction
        pulse_s, cycle_s = self.pulse_us / 1e6, (self.pulse_us + self.backoff_us) / 1e6
        if time_s <= 0.0 or cycle_s <= 0.0:
            return 1.0
        cycles = time_s // cycle_s
        return (cycles * pulse_s + min(time_s - cycles * cycle_s, pulse_s)) / time_s


@dataclass(frozen=True, slots=True)
class DrivenPulse:
    """One coil driven without a break over [start_s, end_s)."""

    coil: int
    level: int
    start_s: Fraction
    end_s: Fraction

    @property
    def length_s(self) -> Fraction:
        """How long the coil was driven."""
        return self.end_s - self.start_s


@dataclass(frozen=True, slots=True)
class DipoleCount:
    """What a continuous driver has driven.

    Attributes:
        statuses: number of COIL_DIPOLE_STATUS, one a tick.
        driven: number of those in which each coil was driven.
        any_driven: number of those in which any was.
    """

    statuses: int
    driven: tuple[int, int, int]
    any_driven: int

    def fraction(self, driven: int) -> float:
        """A number of statuses as a part of all."""
        return driven / self.statuses if self.statuses else 0.0


@dataclass(frozen=True, slots=True)
class Violation:
    """One rule broken: which, when and where.

    Attributes:
        kind: the rule.
        time_s: seconds from tick 0, or from the first entry of a log without SYNC. For a pulse its start.
        tick: the tick of that time, if the log has ticks.
        coil: the coil, if it is known.
        line: line of the log that shows it.
        sentence: what is wrong, without time and coil.
    """

    kind: ViolationKind
    time_s: Fraction
    tick: int | None
    coil: int | None
    line: int
    sentence: str

    def __str__(self) -> str:
        tick = "" if self.tick is None else f" (tick {self.tick})"
        coil = "" if self.coil is None else f" coil {self.coil}"
        return f"t={seconds_text(self.time_s)} s{tick}{coil}: {self.sentence} [line {self.line}]"


@dataclass(frozen=True, slots=True)
class AuditReport:
    """The result for one log.

    Attributes:
        limits: the limits that were applied.
        pulses: all pulses, by start.
        violations: all violations, by time.
        notes: remarks for the reader, a sentence each.
        statuses: number of COIL_STATUS judged.
        span_s: time from the first to the last of them.
        truncated_at: number of the line that is cut, if the log ends inside one.
        complete: the log ends with a whole line, and with an end mark where one must be.
        genuine: the index of the log, if it has one, does not contradict it.
        mismatches: what run.json contradicts, if the log has one beside it, a sentence each.
        dipoles: what a continuous driver has driven; None of a pulsed one.
        unreported_s: all stretches without COIL_STATUS that are as long as the longest pulse and a tick.
        doubt: why a pulse may have gone unreported, or broken a limit by the recorder's clock, a clause.
        not_real_time: why the recorder's timestamps do not show real time, a clause.
    """

    limits: AuditLimits
    pulses: Sequence[DrivenPulse]
    violations: tuple[Violation, ...]
    notes: tuple[str, ...]
    statuses: int
    span_s: Fraction
    truncated_at: int | None
    complete: bool
    genuine: bool = True
    mismatches: tuple[str, ...] = ()
    dipoles: DipoleCount | None = None
    unreported_s: Fraction = Fraction(0)
    doubt: str = ""
    not_real_time: str = ""

    @property
    def missing(self) -> str:
        """The message without which nothing can be judged, where the log has none; otherwise empty."""
        if self.limits.is_continuous and not (self.dipoles and self.dipoles.statuses):
            return "COIL_DIPOLE_STATUS"
        return "" if self.statuses else "COIL_STATUS"

    @property
    def ok(self) -> bool:
        """Something was judged, and no limit was broken."""
        return not self.missing and not self.violations

    @property
    def exit_code(self) -> int:
        """0 if the limits were kept over a complete, unaltered log that belongs to its run, otherwise 1.

        1 too where a pulse may have gone unreported; 3 where nothing is wrong but real time is not judged.
        """
        kept = self.ok and self.complete and self.genuine and not self.mismatches and not self.doubt
        return (3 if self.not_real_time else 0) if kept else 1

    @property
    def pulses_per_coil(self) -> list[int]:
        """Number of pulses of each coil."""
        return [sum(1 for _ in self._of(coil)) for coil in COILS]

    @property
    def duty_per_coil(self) -> list[float]:
        """Fraction of the time for which each coil was driven."""
        if self.dipoles is not None:
            return [self._duty_of_ticks(self.dipoles, driven) for driven in self.dipoles.driven]
        return [self._duty(self._of(coil)) for coil in COILS]

    @property
    def duty_total(self) -> float:
        """Sum of the duties of all coils, of which a pulsed driver drives one at a time.

        Of a continuous driver: fraction of the time for which any coil was driven.
        """
        if self.dipoles is not None:
            return self._duty_of_ticks(self.dipoles, self.dipoles.any_driven)
        return self._duty(self.pulses)

    @property
    def max_pulse_s(self) -> float | None:
        """The longest pulse; None if there was none."""
        return max((float(pulse.length_s) for pulse in self.pulses), default=None)

    @property
    def min_gap_any_s(self) -> float | None:
        """Least time from a pulse to the next, of any coil; None with fewer than two pulses."""
        return _min_gap(self.pulses)

    @property
    def min_gap_limited_s(self) -> float | None:
        """Least of the gaps that the back-off limits: from any pulse, or from one of the same coil."""
        if self.limits.shared:
            return self.min_gap_any_s
        return min((gap for gap in self.min_gap_per_coil_s if gap is not None), default=None)

    @property
    def min_gap_per_coil_s(self) -> list[float | None]:
        """Least time from a pulse to the next of the same coil, for each coil."""
        return [_min_gap(self._of(coil)) for coil in COILS]

    def _of(self, coil: int) -> Iterator[DrivenPulse]:
        return (pulse for pulse in self.pulses if pulse.coil == coil)

    def _duty_of_ticks(self, dipoles: DipoleCount, driven: int) -> float:
        return (self.limits.on_fraction or 0.0) * dipoles.fraction(driven)

    def _duty(self, pulses: Iterable[DrivenPulse]) -> float:
        driven_s = sum((pulse.length_s for pulse in pulses), Fraction(0))
        return float(driven_s / self.span_s) if self.span_s > 0 else 0.0


def seconds_text(time_s: Fraction | float) -> str:
    """Seconds with at least three decimals, and as many more, up to six, as they need."""
    text = f"{float(time_s):.6f}"
    return text[:-3] + text[-3:].rstrip("0")


def _min_gap(pulses: Iterable[DrivenPulse]) -> float | None:
    """Least gap of pulses in order of start; those that overlap have none: 0."""
    gaps = (float(max(later.start_s - sooner.end_s, Fraction(0))) for sooner, later in pairwise(pulses))
    return min(gaps, default=None)
