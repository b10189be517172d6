"""The audit of a scheduler or a law in simulated flight."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction

from fsw.core.laws.interface import ControlConfig, Law
from fsw.table.config import flight_config
from sim.audit.auditor import audit
from sim.audit.findings import AuditLimits, AuditReport, Violation, ViolationKind
from sim.record.candump import LogEntry
from sim.scenario.schema import flight_table, load
from sim.testing.scheduler_flight import Fire, Flight, Limits, MakeScheduler, TickRecord, fly_ticks, frames_of
from sim.testing.shipped import scheduler_under

ENCODABLE_COILS = range(4)
ENCODABLE_LEVELS = range(-8, 8)
ENCODABLE_MS = range(65_536)
"""The values that COIL_FIRE can carry. Other requests leave no trace in a log of the board."""


TICKS_AFTER_UNSAFE = 10
"""A flight in which a limit is broken goes on for so many ticks, and for the longest pulse."""


def audit_scheduler(make: MakeScheduler, flight: Flight) -> AuditReport:
    """Fly a scheduler over a board that refuses nothing, and judge what was driven.

    A request that no board could drive is a violation too: of a level or a duration of zero, of a coil, level
    or duration that COIL_FIRE cannot carry, and a second one for the same coil in one tick.

    Args:
        make: makes the scheduler, at every boot.
        flight: the course of the flight, as ``flights()`` draws it.

    Returns:
        The report: ``ok``, ``violations`` with tick and coil, ``pulses``.
    """
    improper: list[Violation] = []
    ticks = _check_requests(fly_ticks(make, flight), flight.limits, improper)
    with _tracing_off():
        report = audit(_log(_without_quiet_ticks(ticks), flight.limits.tick_hz), _audit_limits(flight.limits))
    violations = sorted([*report.violations, *improper], key=lambda one: (one.time_s, one.line))
    # ticks were left out: the time without a report is none of the board's
    return replace(report, violations=tuple(violations), notes=(), unreported_s=Fraction(0), doubt="")


def audit_law(law: Law, flight: Flight, control: ControlConfig | None = None) -> AuditReport:
    """The same for a control law before the shipped scheduler.

    Args:
        law: called in every tick with the attitude and the field of the flight, without an orbit.
        flight: the course of the flight; its demands are not used.
        control: parameters of the law; default: those of the scenario ``microsat``.

    Raises:
        UnsoundLawError: the law asks for something that is not a number.
    """
    parameters = control or flight_config(flight_table(load("microsat"))).control
    return audit_scheduler(scheduler_under(law, parameters), flight)


def _audit_limits(limits: Limits) -> AuditLimits:
    return AuditLimits(
        pulse_us=1000 * limits.pulse_ms,
        backoff_us=1000 * limits.backoff_ms,
        shared=limits.shared,
        tick_hz=limits.tick_hz,
    )


@contextmanager
def _tracing_off() -> Iterator[None]:
    """Suspend the line tracing of Hypothesis before Python 3.12: it makes shrinking ten times as slow."""
    tracer = sys.gettrace()
    if getattr(tracer, "__module__", None) != "hypothesis.internal.scrutineer":
        yield
        return
    sys.settrace(None)
    try:
        yield
    finally:
        sys.settrace(tracer)


def _check_requests(
    ticks: Iterator[TickRecord], limits: Limits, improper: list[Violation]
) -> Iterator[TickRecord]:
    """The same ticks, to soon after the first unsafe one; improper requests are added to ``improper``."""
    left = TICKS_AFTER_UNSAFE + limits.pulse_ms * limits.tick_hz // 1000
    for record in ticks:
        left -= record.unsafe
        if left == 0:
            return
        requested: list[int] = []
        for request in record.requests:
            for kind, sentence in _faults(request, requested):
                time_s = Fraction(record.tick, limits.tick_hz)
                improper.append(Violation(kind, time_s, record.tick, request.coil, record.line, sentence))
            requested.append(request.coil)
        yield record


def _without_quiet_ticks(ticks: Iterator[TickRecord]) -> Iterator[TickRecord]:
    """The ticks without those in which, and around which, nothing is driven: they break no limit."""
    last_quiet, quiet_before = None, False
    for record in ticks:
        quiet = not record.booted and not record.statuses[-1].level
        if quiet and quiet_before:
            last_quiet = record
        else:
            if last_quiet is not None:
                yield last_quiet
            last_quiet = None
            yield record
        quiet_before = quiet
    if last_quiet is not None:
        yield last_quiet


def _log(ticks: Iterator[TickRecord], tick_hz: int) -> Iterator[LogEntry]:
    """The entries of a log; without timestamps, so that only the ticks are judged."""
    for record in ticks:
        for line, frame in enumerate(frames_of(record, tick_hz), start=record.line):
            yield LogEntry(line, 0, "bench", frame)


def _faults(request: Fire, requested: list[int]) -> Iterator[tuple[ViolationKind, str]]:
    coil, level, duration_ms = request
    if coil not in ENCODABLE_COILS:
        yield ViolationKind.COIL, "request for a coil that COIL_FIRE cannot carry"
    elif coil in requested:
        yield ViolationKind.GAP, "second request for the same coil in one tick"
    if level == 0 or level not in ENCODABLE_LEVELS:
        yield ViolationKind.LEVEL, f"request of level {level}"
    if round(duration_ms) == 0 or round(duration_ms) not in ENCODABLE_MS:
        yield ViolationKind.PULSE, f"request of {duration_ms} ms"
