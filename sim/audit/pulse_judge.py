"""Pulses as the board's statuses show them, judged against the limits by one clock."""

from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import overload

from fsw.wire.messages import CoilStatus
from sim.audit.findings import COILS, AuditLimits, DrivenPulse, Violation, ViolationKind, seconds_text
from sim.audit.log_clock import LogClock

# --- The pulses of a log, twenty bytes each: a month has tens of thousands


class PulseTable(Sequence[DrivenPulse]):
    """Pulses in the order in which they were added.

    Args:
        unit_s: the unit in which edges are counted.
    """

    def __init__(self, unit_s: Fraction) -> None:
        self._unit_s = unit_s
        self._coils, self._levels = array("b"), array("b")
        self._starts, self._ends = array("q"), array("q")

    def add(self, coil: int, level: int, start: int, end: int) -> None:
        """One more, from ``start`` to ``end`` in units."""
        self._coils.append(coil)
        self._levels.append(level)
        self._starts.append(start)
        self._ends.append(end)

    def by_start(self) -> "PulseTable":
        """The same in order of start."""
        ordered = PulseTable(self._unit_s)
        for place in sorted(range(len(self)), key=self._starts.__getitem__):
            ordered.add(self._coils[place], self._levels[place], self._starts[place], self._ends[place])
        return ordered

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and tuple(self) == tuple(other)

    __hash__ = None  # type: ignore[assignment]  # it grows

    def __len__(self) -> int:
        return len(self._starts)

    def __iter__(self) -> Iterator[DrivenPulse]:
        return map(self._pulse, range(len(self)))

    @overload
    def __getitem__(self, index: int) -> DrivenPulse: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[DrivenPulse, ...]: ...
    def __getitem__(self, index: int | slice) -> DrivenPulse | tuple[DrivenPulse, ...]:
        if isinstance(index, slice):
            return tuple(map(self._pulse, range(*index.indices(len(self)))))
        return self._pulse(index)

    def _pulse(self, place: int) -> DrivenPulse:
        start_s, end_s = self._starts[place] * self._unit_s, self._ends[place] * self._unit_s
        return DrivenPulse(self._coils[place], self._levels[place], start_s, end_s)


# --- The judge


@dataclass(slots=True)
class _Drive:
    """A coil that is being driven. Instants as ``LogClock`` counts them."""

    coil: int
    seq: int
    level: int
    start: int
    end: int  # driven until then at least
    tick: int | None
    line: int
    announced: int  # the end that the last status announces
    latest: int  # the latest end announced so far
    reported_levels: set[int] = field(default_factory=set)
    reported_boot: bool = False


class PulseJudge:
    """Assembles pulses from statuses, in order of time, and reports each that breaks a limit."""

    def __init__(self, clock: LogClock, limits: AuditLimits) -> None:
        self.pulses = PulseTable(clock.seconds(1))
        self.violations: list[Violation] = []
        self._clock = clock
        self._limits = limits
        self._longest = limits.pulse_us * clock.units
        self._backoff = limits.backoff_us * clock.units
        self._millisecond = 1000 * clock.units
        self._drives: dict[int, _Drive] = {}
        self._ended: dict[int, int] = {}
        self._booted: int | None = None
        self._booted_sooner: int | None = None
        self.doubt = ""
        """Why a pulse may have come too soon after a boot, for the first that may, a clause."""

    def boot(self, instant: int, sooner: int | None) -> None:
        """The board has started, and its lockout begins: no later than ``instant``.

        ``sooner``: and no sooner than that; None where the log does not show it.
        """
        self._booted, self._booted_sooner = instant, sooner

    def observe(self, now: int, tick: int | None, line: int, statuses: list[CoilStatus]) -> None:
        """All statuses of one tick: what was driven in the interval that ends ``now``.

        A tick without any is not judged: a coil driven before and after it counts as driven in it.
        """
        driven = [status for status in statuses if status.level]
        if not statuses or not (driven or self._drives):
            return
        before = now - self._clock.period
        shown = {(status.coil, status.seq) for status in driven}
        stopped = [drive for drive in self._drives.values() if (drive.coil, drive.seq) not in shown]
        for drive in stopped:
            self._stop(drive, before)
        for status in driven:
            under_way = self._drives.get(status.coil)
            if under_way is not None and under_way.seq == status.seq:
                drive = under_way
                self._go_on(drive, status, now)
            else:
                if under_way is not None:
                    self._stop(under_way, before)
                start_tick = None if tick is None else tick - 1
                announced = self._announced(before, now, status)
                drive = _Drive(
                    status.coil, status.seq, status.level, before, now, start_tick, line, announced, announced
                )
                self._start(drive, stopped)
            self._judge_on_since_boot(drive, status, now, tick, line)
            if abs(status.level) > self._limits.max_level and status.level not in drive.reported_levels:
                drive.reported_levels.add(status.level)
                highest = self._limits.max_level
                sentence = f"level {status.level} is outside -{highest}..{highest}"
                self._add(ViolationKind.LEVEL, now, tick, status.coil, line, sentence)

    def finish(self) -> None:
        """The log ends: a coil still driven counts as driven until its last status."""
        for drive in list(self._drives.values()):
            self._stop(drive, drive.end)

    def _start(self, drive: _Drive, stopped: list[_Drive]) -> None:
        self._judge_overlap(drive, stopped)
        self._judge_gap(drive)
        self._judge_boot(drive)
        if drive.coil not in COILS:
            self._add_at_start(ViolationKind.COIL, drive, "there is no such coil")
        self._drives[drive.coil] = drive

    def _go_on(self, drive: _Drive, status: CoilStatus, now: int) -> None:
        punctual = (now - drive.end) % self._clock.period == 0
        last = punctual and status.remaining_ms == 0 and drive.end < drive.announced
        drive.end = min(drive.announced, now) if last else max(drive.end, now)
        drive.announced = self._announced(drive.start, drive.end, status)
        drive.latest = max(drive.latest, drive.announced)

    def _announced(self, start: int, end: int, status: CoilStatus) -> int:
        """The end by ``remaining_ms``; that is in whole milliseconds, so elapsed time is too."""
        return start + ((end - start) // self._millisecond + status.remaining_ms) * self._millisecond

    def _stop(self, drive: _Drive, until: int) -> None:
        """Close a pulse that is over at ``until``, or at its announced end if that is sooner."""
        del self._drives[drive.coil]
        end = max(drive.end, min(drive.announced, until))
        self._ended[drive.coil] = end
        seconds = self._clock.seconds
        self.pulses.add(drive.coil, drive.level, drive.start, end)
        limit = f"{seconds_text(seconds(self._longest))} s"
        if end - drive.start > self._longest:
            length = seconds_text(seconds(end - drive.start))
            self._add_at_start(ViolationKind.PULSE, drive, f"pulse of {length} s exceeds {limit}")
        elif drive.latest - drive.start > self._longest:
            length = seconds_text(seconds(drive.latest - drive.start))
            self._add_at_start(
                ViolationKind.ANNOUNCED, drive, f"pulse announces {length} s, which exceeds {limit}"
            )

    def _judge_overlap(self, drive: _Drive, stopped: list[_Drive]) -> None:
        others = {other.coil for other in self._drives.values()}
        others |= {other.coil for other in stopped if other.announced > drive.start}
        for coil in sorted(others - {drive.coil}):
            self._add_at_start(ViolationKind.TWO_COILS, drive, f"two coils at once: coil {coil} is on too")

    def _judge_gap(self, drive: _Drive) -> None:
        coils = self._ended if self._limits.shared else self._ended.keys() & {drive.coil}
        if not coils:
            return
        other = max(coils, key=self._ended.__getitem__)
        gap = max(drive.start - self._ended[other], 0)
        if gap < self._backoff:
            whose = "its own pulse" if other == drive.coil else f"the pulse of coil {other}"
            self._add_backoff(ViolationKind.GAP, drive, gap, f"the end of {whose}")

    def _judge_boot(self, drive: _Drive) -> None:
        if self._booted is None or not 0 <= drive.start - self._booted < self._backoff:
            return
        drive.reported_boot = True
        sooner = self._booted_sooner
        if sooner is not None and drive.start - sooner < self._backoff:
            self._add_backoff(ViolationKind.BOOT, drive, drive.start - self._booted, "the boot of the board")
        elif not self.doubt:
            start, least = (
                seconds_text(self._clock.seconds(one)) for one in (drive.start, drive.start - self._booted)
            )
            self.doubt = (
                f"the pulse at t={start} s may have started {least} s after the boot of the board: "
                "the log lacks ticks before its boot"
            )

    def _judge_on_since_boot(
        self, drive: _Drive, status: CoilStatus, now: int, tick: int | None, line: int
    ) -> None:
        """A coil that was on when the board booted is off from then on."""
        booted = self._booted
        if booted is None or drive.reported_boot or drive.start >= booted:
            return
        if now > booted or (now == booted and status.remaining_ms):
            drive.reported_boot = True
            sentence = "on after the boot of the board, though it began before it"
            self._add(ViolationKind.BOOT, now, tick, drive.coil, line, sentence)

    def _add_backoff(self, kind: ViolationKind, drive: _Drive, gap: int, event: str) -> None:
        seconds = self._clock.seconds
        least = seconds_text(seconds(self._backoff))
        sentence = f"pulse starts {seconds_text(seconds(gap))} s after {event}, sooner than {least} s"
        self._add_at_start(kind, drive, sentence)

    def _add_at_start(self, kind: ViolationKind, drive: _Drive, sentence: str) -> None:
        self._add(kind, drive.start, drive.tick, drive.coil, drive.line, sentence)

    def _add(
        self, kind: ViolationKind, instant: int, tick: int | None, coil: int | None, line: int, sentence: str
    ) -> None:
        self.violations.append(Violation(kind, self._clock.seconds(instant), tick, coil, line, sentence))
