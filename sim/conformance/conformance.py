"""Whether a board does what docs/icd.md says: a table of checks, the same for a stub and for real hardware.

The checks are run in order, in real time, and talk to the board over the bus alone. Those that ask for a
pulse are run only when the bench is armed.
"""

from collections.abc import Callable
from typing import NamedTuple

from fsw.wire.messages import CoilStatus
from sim.conformance import checks, clock_checks
from sim.conformance.session import BrokenError, Session
from sim.conformance.subject import Limits, Subject
from sim.errors import HarnessError


class Check(NamedTuple):
    """One check; ``power``: it asks for pulses; ``coil``: it is of the coil driver alone."""

    run: Callable[[Subject], None]
    power: bool = False
    coil: bool = True


CHECKS = (
    Check(checks.boot, coil=False),
    Check(checks.noise, coil=False),
    Check(checks.boot_lockout, power=True),
    Check(checks.refusals, power=True),
    Check(checks.back_off, power=True),
    Check(checks.dead_man_in_a_pulse, power=True),
    Check(checks.restart_in_a_pulse, power=True),
    Check(checks.dead_man),
    Check(clock_checks.lost_count, coil=False),
    Check(clock_checks.repeated_tick),
    Check(clock_checks.own_clock),
    Check(clock_checks.held_tick, power=True),
    Check(checks.all_along, coil=False),
)


class Verdict(NamedTuple):
    """Of one check: ``failure`` None: kept; ``ran`` False: it needs power and the bench is not armed."""

    name: str
    what: str
    ran: bool
    failure: str | None = None


def conform(
    session: Session, limits: Limits, armed: bool, tell: Callable[[Verdict], None] = lambda verdict: None
) -> list[Verdict]:
    """Run every check that fits the board, each in its turn.

    Raises:
        HarnessError: the board says nothing at all, or somebody else paces the bus.
    """
    subject = Subject(session, limits)
    verdicts = []
    for check in CHECKS:
        if check.coil and session.kind.sample is not CoilStatus:
            continue
        what = " ".join((check.run.__doc__ or "").split())
        verdict = Verdict(check.run.__name__, what, ran=armed or not check.power)
        if verdict.ran:
            verdict = verdict._replace(failure=_failure(check, subject))
        if not any(heard.messages for heard in session.record):
            raise HarnessError(f"no {session.kind.node} board answers on this bus")
        tell(verdict)
        verdicts.append(verdict)
    return verdicts


def _failure(check: Check, subject: Subject) -> str | None:
    try:
        check.run(subject)
    except BrokenError as broken:
        return str(broken)
    return None
