"""The auditor as a function over a scheduler or a law."""

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
from sim.testing.bench import Fire, Flight, FlownTick, Limits, MakeScheduler, fly_ticks, on_the_bus
from sim.testing.shipped import scheduler_under

CARRIED_COILS = range(4)
CARRIED_LEVELS = range(-8, 8)
CARRIED_MS = range(65_536)
"""What the fields of COIL_FIRE hold. What they cut, or what drives nothing, no log of a board can show."""


AFTER_HARM_TICKS = 10
"""A flight in which a limit has been broken goes on for so long, and for the longest pulse."""


def audit_scheduler(make: MakeScheduler, flight: Flight) -> AuditReport:
    """Fly a scheduler over a board that refuses nothing, and judge what was driven.

    Blamed is also a request that no board could drive: of a level or a duration of zero, of a coil, level or
    duration that COIL_FIRE cannot carry, and a second one for the same coil in one tick.

    Args:
        make: makes the scheduler, at its every boot.
        flight: what happens, as ``flights()`` draws it.

    Returns:
        The report: ``ok``, ``violations`` with tick and coil, ``pulses``.
    """
    blamed: list[Violation] = []
    watched = _watch(fly_ticks(make, flight), flight.limits, blamed)
    with _unexplained():
        report = audit(_log(_telling(watched), flight.limits.tick_hz), _audit_limits(flight.limits))
    violations = sorted([*report.violations, *blamed], key=lambda one: (one.time_s, one.line))
    return replace(report, violations=tuple(violations), notes=())


def audit_law(law: Law, flight: Flight, control: ControlConfig | None = None) -> AuditReport:
    """The same for a control law before the shipped scheduler.

    Args:
        law: what is called in every tick, with the attitude and the field of the flight; it knows no orbit.
        flight: what happens; its demands are not used.
        control: what the law is tuned by; default: as in the scenario ``microsat``.

    Raises:
        UnsoundLawError: the law asks for something that is not a number.
    """
    tuned = control or flight_config(flight_table(load("microsat"))).control
    return audit_scheduler(scheduler_under(law, tuned), flight)


def _audit_limits(limits: Limits) -> AuditLimits:
    return AuditLimits(
        pulse_us=1000 * limits.pulse_ms,
        backoff_us=1000 * limits.backoff_ms,
        shared=limits.shared,
        tick_hz=limits.tick_hz,
    )


@contextmanager
def _unexplained() -> Iterator[None]:
    """Before Python 3.12 Hypothesis follows line by line what it shrinks, which takes ten times as long."""
    tracer = sys.gettrace()
    if getattr(tracer, "__module__", None) != "hypothesis.internal.scrutineer":
        yield
        return
    sys.settrace(None)
    try:
        yield
    finally:
        sys.settrace(tracer)


def _watch(ticks: Iterator[FlownTick], limits: Limits, blamed: list[Violation]) -> Iterator[FlownTick]:
    """The same ticks, to soon after the first harm; what is wrong with requests is added to ``blamed``."""
    left = AFTER_HARM_TICKS + limits.pulse_ms * limits.tick_hz // 1000
    for flown in ticks:
        left -= flown.harmed
        if left == 0:
            return
        asked: list[int] = []
        for request in flown.requests:
            for kind, sentence in _faults(request, asked):
                time_s = Fraction(flown.tick, limits.tick_hz)
                blamed.append(Violation(kind, time_s, flown.tick, request.coil, flown.line, sentence))
            asked.append(request.coil)
        yield flown


def _telling(ticks: Iterator[FlownTick]) -> Iterator[FlownTick]:
    """Without those in which nothing is driven, nor in the ticks around: they break no limit."""
    held, quiet_before = None, False
    for flown in ticks:
        quiet = not flown.booted and not flown.said[-1].level
        if quiet and quiet_before:
            held = flown
        else:
            if held is not None:
                yield held
            held = None
            yield flown
        quiet_before = quiet
    if held is not None:
        yield held


def _log(ticks: Iterator[FlownTick], tick_hz: int) -> Iterator[LogEntry]:
    """The entries of a log; without timestamps, which would tell the time of the ticks once more."""
    for flown in ticks:
        for line, frame in enumerate(on_the_bus(flown, tick_hz), start=flown.line):
            yield LogEntry(line, 0, "bench", frame)


def _faults(request: Fire, asked: list[int]) -> Iterator[tuple[ViolationKind, str]]:
    coil, level, duration_ms = request
    if coil not in CARRIED_COILS:
        yield ViolationKind.COIL, "request for a coil that COIL_FIRE cannot name"
    elif coil in asked:
        yield ViolationKind.GAP, "second request for the same coil in one tick"
    if level == 0 or level not in CARRIED_LEVELS:
        yield ViolationKind.LEVEL, f"request of level {level}"
    if round(duration_ms) == 0 or round(duration_ms) not in CARRIED_MS:
        yield ViolationKind.PULSE, f"request of {duration_ms} ms"
