"""Independent audit of the actuator limits, from the coil driver board's own report of what it drove.

Judged are the COIL_STATUS frames of a log: no pulse longer than allowed; no pulse sooner after another one,
or after a boot of the board, than the back-off, and none that goes on over a boot; no level out of range;
never two coils at once; no pulse announced that would break a limit; no COIL_STATUS with a wrong CRC or
length. The status of tick k reports the interval that ends at k, so a pulse begins one tick before the first
status that shows it. A pulsed driver reports no driven COIL_DIPOLE_STATUS, and a continuous one, which has no
limits on pulses, no level.

There are two clocks: the ticks of SYNC, and the timestamps. Each limit must hold by both of them. Timestamps
that are simulated time must agree with the ticks exactly, and those of a recorder's own clock are judged with
a tolerance (``sim.audit.recorder_judge``); other comparisons are exact.

Nothing here is shared with the onboard scheduler or the boards, on purpose.
"""

from collections.abc import Iterable, Iterator

from fsw.wire.messages import CoilDipoleStatus, CoilStatus, Sync, intact
from sim.audit.driver_judge import DriverJudge
from sim.audit.findings import AuditLimits, AuditReport, DrivenPulse, Violation, ViolationKind, seconds_text
from sim.audit.log_clock import MICRO, LogClock, clock_notes, read_clock
from sim.audit.pulse_judge import PulseJudge
from sim.audit.recorder_judge import RecorderJudge
from sim.audit.status_ticks import BoardStatus, StatusTicks
from sim.audit.unreported_time import UnreportedTime
from sim.audit.whole_entries import WholeEntries
from sim.record.candump import LogEntry

__all__ = ["AuditLimits", "AuditReport", "DrivenPulse", "Violation", "ViolationKind", "audit"]


def audit(
    entries: Iterable[LogEntry], limits: AuditLimits, expect_end: bool = False, ticks_alone: bool = False
) -> AuditReport:
    """Judge a log in one pass, without holding it in memory.

    Args:
        entries: the log, as ``read_log`` yields it.
        limits: what to judge by.
        expect_end: Torquer recorded the log, so that it is complete only if PLANT_END is its last frame.
        ticks_alone: ticks are not real time, and the timestamps of a recorder are not judged.

    Raises:
        LogError: the log has been altered; passed on from ``entries``.
    """
    log = WholeEntries(entries)
    clock, judged = read_clock(iter(log), limits.tick_hz)
    auditor = _Auditor(clock, limits, ticks_alone)
    for entry in judged:
        auditor.take(entry)
    return auditor.report(log, expect_end)


class _Auditor:
    """Sorts the log into ticks and passes them to the judge of each clock."""

    def __init__(self, clock: LogClock, limits: AuditLimits, ticks_alone: bool) -> None:
        self._clock = clock
        self._limits = limits
        self._by_ticks = PulseJudge(clock, limits) if clock.epoch_s is not None else None
        self._by_timestamps = PulseJudge(clock, limits) if clock.simulated or clock.epoch_s is None else None
        recorded = clock.epoch_s is not None and not clock.simulated
        judged = recorded and not ticks_alone and not limits.is_continuous
        self._by_recorder = RecorderJudge(clock, limits) if judged else None
        self._ticks_alone = recorded and ticks_alone
        self._violations: list[Violation] = []
        self._ticks = StatusTicks()
        self._unreported = UnreportedTime(clock, limits)
        self._driver = DriverJudge(limits.is_continuous)
        self._together: list[BoardStatus] = []
        self._booted = False
        self._booted_after: int | None = None
        self._tick: int | None = None
        self._began_at = 0
        self._timestamp_off: int | None = None
        self._unix_off: int | None = None
        self._first: int | None = None
        self._last = 0
        self._statuses = 0
        self._crowded_ticks = 0
        self._broken_boots = 0
        if clock.contradictory and clock.epoch_s is None:
            self._add(
                ViolationKind.SYNC, 0, None, 0, "no tick rate makes unix_time_s = epoch + tick // tick_hz"
            )

    def take(self, entry: LogEntry) -> None:
        """Process the next SYNC, COIL_STATUS, COIL_DIPOLE_STATUS or COIL_BOOT of the log."""
        can_id = entry.frame.can_id
        if can_id == CoilStatus.ID:
            self._take_status(entry)
        elif can_id == Sync.ID:
            if self._by_ticks is not None:
                self._take_sync(entry)
        elif can_id == CoilDipoleStatus.ID:
            self._take_dipole(entry)
        elif not intact(entry.frame):
            self._broken_boots += 1
        elif self._by_ticks is not None:
            self._booted, self._booted_after = True, self._tick
            if self._by_recorder is not None:
                self._by_recorder.boot(entry.timestamp_us)
        else:
            instant = self._clock.of_timestamp(entry.timestamp_us)
            self._boot(instant, instant)

    def _take_status(self, entry: LogEntry) -> None:
        self._statuses += 1
        frame = entry.frame
        status = CoilStatus.decode(frame.data) if intact(frame) else None
        board = BoardStatus(entry.line, entry.timestamp_us, status, self._booted)
        self._booted = False
        if status is not None:
            self._driver.take_level(entry.line, status)
        if self._by_ticks is not None:
            self._ticks.add(board)
        else:
            self._take_untimed(board)
            self._judge_driver(self._clock.of_timestamp(entry.timestamp_us), None)

    def _take_dipole(self, entry: LogEntry) -> None:
        instant = self._clock.of_timestamp(entry.timestamp_us) if self._by_ticks is None else None
        if not self._driver.take_dipole(entry) and self._limits.is_continuous:
            tick = None if self._tick is None else self._tick + 1
            when = (tick or 0) * MICRO if instant is None else instant
            self._add(
                ViolationKind.FRAME, when, tick, entry.line, "COIL_DIPOLE_STATUS with a wrong CRC or length"
            )
        if instant is not None:
            self._judge_driver(instant, None)

    def _judge_driver(self, instant: int, tick: int | None) -> None:
        for line, sentence in self._driver.found():
            self._add(ViolationKind.DRIVER, instant, tick, line, sentence)

    # --- logs with ticks

    def _take_sync(self, entry: LogEntry) -> None:
        line, timestamp_us, _, frame = entry
        if len(frame.data) != Sync.LENGTH:
            tick = None if self._tick is None else self._tick + 1
            self._add(ViolationKind.SYNC, (tick or 0) * MICRO, tick, line, f"SYNC of {len(frame.data)} bytes")
            return
        sync = Sync.decode(frame.data)
        tick, unix_time_s = sync.tick, sync.unix_time_s
        if tick == self._tick:  # sent again: no time has passed
            self._check_unix_time(line, tick, unix_time_s)
            return
        step = 1 if self._tick is None else tick - self._tick
        if self._tick is None:
            self._began_at = tick
            self._unreported.begin(tick * MICRO)
        if step < 1:
            sentence = f"SYNC goes back from tick {self._tick} to tick {tick}: two runs in one log?"
            self._add(ViolationKind.SYNC, tick * MICRO, tick, line, sentence)
            self._interrupt()
            self._unreported.begin(tick * MICRO)
            step = 1
        self._tick = tick
        if self._by_recorder is not None:
            self._by_recorder.sync(tick, timestamp_us)
        self._check_unix_time(line, tick, unix_time_s)
        self._check_timestamp("SYNC", line, timestamp_us, tick)
        closed = self._ticks.close(tick, step, timestamp_us)
        for of_tick, boards in closed:
            self._judge_tick(of_tick, boards)
        if self._booted:  # the board has said nothing since: its boot is of the tick whose SYNC follows
            self._booted = False
            self._boot_in(tick)
        if not closed or closed[-1][0] != tick:
            self._unreported.sync()
        self._judge_driver(tick * MICRO, tick)

    def _judge_tick(self, tick: int, boards: list[BoardStatus]) -> None:
        instant = tick * MICRO
        if any(board.booted for board in boards):
            self._boot_in(tick)
        statuses = self._trusted(boards, instant, tick)
        if self._by_recorder is not None:
            self._by_recorder.observe(tick, boards)
        for board in boards:
            self._check_timestamp("COIL_STATUS", board.line, board.timestamp_us, tick)
        for judge in self._judges():
            when = instant if judge is self._by_ticks else self._stamped(boards)
            judge.observe(when, tick, boards[0].line, statuses)

    def _check_timestamp(self, name: str, line: int, timestamp_us: int, tick: int) -> None:
        if not self._clock.simulated:
            return
        off = self._clock.of_timestamp(timestamp_us) - tick * MICRO
        if off != self._timestamp_off:
            self._timestamp_off = off
            if off:
                off_s = self._clock.seconds(off)
                sentence = (
                    f"timestamp of {name} is {seconds_text(abs(off_s))} s {'late' if off > 0 else 'early'}"
                )
                self._add(ViolationKind.TIMESTAMP, tick * MICRO, tick, line, sentence)

    def _check_unix_time(self, line: int, tick: int, unix_time_s: int) -> None:
        expected = (self._clock.epoch_s or 0) + tick // self._clock.units
        off = unix_time_s - expected
        if off != self._unix_off:
            self._unix_off = off
            if off:
                sentence = f"SYNC says unix_time_s {unix_time_s}, its tick says {expected}"
                self._add(ViolationKind.SYNC, tick * MICRO, tick, line, sentence)

    # --- logs without ticks

    def _take_untimed(self, board: BoardStatus) -> None:
        if self._together:
            spacing = (board.timestamp_us - self._together[0].timestamp_us) * self._clock.units
            if abs(spacing) * 2 > self._clock.period:
                self._judge_by_timestamps()
        self._together.append(board)

    def _judge_by_timestamps(self) -> None:
        boards, self._together = self._together, []
        if not boards or self._by_timestamps is None:
            return
        instant = self._stamped(boards)
        self._by_timestamps.observe(instant, None, boards[0].line, self._trusted(boards, instant, None))

    # --- both

    def _stamped(self, boards: list[BoardStatus]) -> int:
        """The instant of a tick's statuses by timestamp: the last with a coil driven, or the first."""
        times = [board.timestamp_us for board in boards if board.status is not None and board.status.level]
        return self._clock.of_timestamp(max(times, default=boards[0].timestamp_us))

    def _trusted(self, boards: list[BoardStatus], instant: int, tick: int | None) -> list[CoilStatus]:
        if self._first is None:
            self._first = instant
        self._last = instant
        if len(boards) > 1:
            self._crowded_ticks += 1
        for line, _, status, _ in boards:
            if status is None:
                self._add(ViolationKind.FRAME, instant, tick, line, "COIL_STATUS with a wrong CRC or length")
        statuses = [board.status for board in boards if board.status is not None]
        self._unreported.take(instant, statuses)
        return statuses

    def _boot_in(self, tick: int) -> None:
        """The board has booted in the interval of ``tick``, or sooner where ticks before are missing."""
        sooner: int | None = None  # nothing shows how long before the log it was
        if self._booted_after is not None:
            sooner = min(tick, self._booted_after + 1) * MICRO
        elif tick == 0:
            sooner = 0
        self._boot(tick * MICRO, sooner)

    def _boot(self, instant: int, sooner: int | None) -> None:
        self._unreported.boot(instant)
        for judge in self._judges():
            judge.boot(instant, sooner)

    def _interrupt(self) -> None:
        if self._tick is not None:
            self._unreported.finish(self._tick * MICRO)
        for judge in self._judges():
            judge.finish()
        if self._by_recorder is not None:
            self._by_recorder.interrupt()

    def _judges(self) -> list[PulseJudge]:
        return [judge for judge in (self._by_ticks, self._by_timestamps) if judge is not None]

    def _add(self, kind: ViolationKind, instant: int, tick: int | None, line: int, sentence: str) -> None:
        self._violations.append(Violation(kind, self._clock.seconds(instant), tick, None, line, sentence))

    def report(self, log: WholeEntries, expect_end: bool) -> AuditReport:
        """The result, after the last entry."""
        if self._by_ticks is None:
            self._judge_by_timestamps()
        elif self._ticks.waiting and self._tick is not None:
            for tick, boards in self._ticks.close(self._tick + 1, 1):
                self._judge_tick(tick, boards)
        self._interrupt()
        self._judge_driver(self._last, None)
        judge = self._by_ticks or self._by_timestamps
        pulses = () if judge is None else judge.pulses.by_start()
        seconds = self._clock.seconds
        return AuditReport(
            limits=self._limits,
            pulses=pulses,
            violations=self._all_violations(),
            notes=tuple(self._notes(log)),
            statuses=self._statuses,
            span_s=seconds(self._last - (self._first or 0)),
            truncated_at=log.truncated_at,
            complete=log.ended or (log.truncated_at is None and not expect_end),
            dipoles=self._driver.count,
            unreported_s=seconds(self._unreported.total),
            doubt=self._doubt(),
            not_real_time="" if self._by_recorder is None else self._by_recorder.unjudged(),
        )

    def _doubt(self) -> str:
        """Why a limit may have been broken, for the first way found, a clause."""
        if self._limits.is_continuous:
            return ""
        by_recorder = [] if self._by_recorder is None else [self._by_recorder.doubted()]
        doubts = [self._unreported.doubt, *(judge.doubt for judge in self._judges()), *by_recorder]
        return next(filter(None, doubts), "")

    def _all_violations(self) -> tuple[Violation, ...]:
        """The violations of both judges; one that both report counts once."""
        violations = list(self._violations)
        for judge in self._judges():
            already = {(one.kind, one.tick, one.coil) for one in violations}
            violations += [one for one in judge.violations if (one.kind, one.tick, one.coil) not in already]
        if self._by_recorder is not None:
            violations += self._by_recorder.found()
        return tuple(sorted(violations, key=lambda one: (one.time_s, one.line)))

    def _notes(self, log: WholeEntries) -> Iterator[str]:
        yield from log.notes()
        yield from self._driver.notes(self._statuses)
        if self._statuses == 0:
            return
        yield from clock_notes(self._clock, self._limits.tick_hz, self._ticks_alone)
        if self._began_at:
            yield f"the log begins at tick {self._began_at}: what came before it is not judged"
        if self._by_recorder is not None:
            yield from self._by_recorder.notes()
        if self._ticks.silent:
            yield f"{_count(self._ticks.silent, 'tick')} without COIL_STATUS"
        yield from self._unreported.notes()
        if self._crowded_ticks:
            yield f"{_count(self._crowded_ticks, 'tick')} with more than one COIL_STATUS"
        if self._broken_boots:
            yield f"{_count(self._broken_boots, 'COIL_BOOT')} with a wrong CRC or length: no boot"


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
