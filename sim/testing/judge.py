"""The auditor as a function over a scheduler or a law."""

from fsw.core.laws.interface import ControlConfig, Law
from fsw.io.config import flight_config
from sim.harness.audit.auditor import audit
from sim.harness.audit.findings import AuditLimits, AuditReport
from sim.harness.scenario import flight_table, load
from sim.testing.bench import Flight, Limits, MakeScheduler, fly
from sim.testing.shipped import scheduler_under


def audit_scheduler(make: MakeScheduler, flight: Flight) -> AuditReport:
    """Fly a scheduler over a board that refuses nothing, and judge what was driven.

    Args:
        make: makes the scheduler, at its every boot.
        flight: what happens, as ``flights()`` draws it.

    Returns:
        The report: ``ok``, ``violations`` with tick and coil, ``pulses``.
    """
    return audit(fly(make, flight), _audit_limits(flight.limits))


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
