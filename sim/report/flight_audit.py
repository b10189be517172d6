"""The audit of a flight, without what the faults of its scenario send or break."""

from collections.abc import Iterable
from dataclasses import replace

from fsw.wire.messages import Sync, intact
from sim.audit.auditor import AuditLimits, AuditReport, ViolationKind, audit
from sim.faults.section import break_frames, forge_sync
from sim.record.candump import LogEntry
from sim.scenario.schema import Scenario


def audit_flight(
    entries: Iterable[LogEntry], limits: AuditLimits, scenario: Scenario, expect_end: bool = False
) -> AuditReport:
    """The audit of a flight without what faults of its scenario send or break: no word of the board.

    Args:
        entries: the log, in simulated time.
        limits: what to judge by.
        scenario: of the flight.
        expect_end: as for ``audit``.
    """
    report = audit(_without_forged_sync(entries, scenario), limits, expect_end)
    if not break_frames(scenario.fault):
        return report
    others = tuple(violation for violation in report.violations if violation.kind is not ViolationKind.FRAME)
    return replace(report, violations=others)


def _without_forged_sync(entries: Iterable[LogEntry], scenario: Scenario) -> Iterable[LogEntry]:
    """The entries; where a fault forges SYNC, without each that is not of the tick of its timestamp."""
    if not forge_sync(scenario.fault):
        return entries
    epoch_s, hz = scenario.epoch_unix_s, scenario.time.tick_hz

    def is_own(entry: LogEntry) -> bool:
        if entry.frame.can_id != Sync.ID or not intact(entry.frame):
            return True
        sync = Sync.decode(entry.frame.data)
        at_us = epoch_s * 1_000_000 + sync.tick * 1_000_000 // hz
        return (entry.timestamp_us, sync.unix_time_s) == (at_us, epoch_s + sync.tick // hz)

    return filter(is_own, entries)
