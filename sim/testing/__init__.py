"""Test a pulse scheduler or a control law of your own against the limits that the shipped one keeps.

A scheduler is any object with ``step(heard) -> requests``; the function that makes one from ``Limits`` is
called at each of its boots, so that nothing outlives a reboot. It flies over a board that drives every
request, and the auditor of ``torquer check`` judges what was driven. Ten lines::

    from hypothesis import given, settings
    from sim.testing import Fire, audit_scheduler, flights

    class MyScheduler:
        def __init__(self, limits): ...
        def step(self, heard): return [Fire(coil=0, level=3, duration_ms=3000)] if ... else []

    @settings(deadline=None)
    @given(flights())
    def test_it_keeps_the_limits(flight):
        report = audit_scheduler(MyScheduler, flight)
        assert report.ok, report.violations

``flights()`` gives demands, fields, tick rates, lost messages and reboots of scheduler and board, in flights
of few pulses and of many; a failing flight is shrunk to a short one. docs/testing.md lists what is found and
what is not. ``audit_law`` flies a law in the form of ``fsw.core.laws.interface.Law`` through the shipped
scheduler. The strategies need hypothesis: ``pip install torquer[testing]``.
"""

from sim.audit.findings import AuditReport, Violation
from sim.testing.scheduler_audit import audit_law, audit_scheduler
from sim.testing.scheduler_flight import (
    Fire,
    Flight,
    Heard,
    Limits,
    MakeScheduler,
    Reboot,
    Scheduler,
    Stretch,
    fly,
)
from sim.testing.shipped import ShippedScheduler, UnsoundLawError, scheduler_under
from sim.testing.strategies import (
    attitudes,
    dipoles,
    fields,
    flights,
    limits,
    stretches,
    tick_rates,
    timings_ms,
    unsound_dipoles,
)

__all__ = [
    "AuditReport",
    "Fire",
    "Flight",
    "Heard",
    "Limits",
    "MakeScheduler",
    "Reboot",
    "Scheduler",
    "ShippedScheduler",
    "Stretch",
    "UnsoundLawError",
    "Violation",
    "attitudes",
    "audit_law",
    "audit_scheduler",
    "dipoles",
    "fields",
    "flights",
    "fly",
    "limits",
    "scheduler_under",
    "stretches",
    "tick_rates",
    "timings_ms",
    "unsound_dipoles",
]
