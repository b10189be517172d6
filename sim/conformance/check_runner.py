"""The table of checks of a board against docs/icd.md, the same for a stub and for real hardware, and its run.

The checks are run in order, in real time, and talk to the board over the bus alone. Those that ask for a
pulse are run only when the flight software is armed.
"""

from collections.abc import Callable
from typing import NamedTuple

from fsw.wire.messages import CoilStatus
from sim.conformance import checks, clock_checks
from sim.conformance.board_link import BoardLink, NonconformanceError
from sim.conformance.board_under_test import BoardLimits, BoardUnderTest
from sim.errors import HarnessError


class Check(NamedTuple):
    """One check; ``power``: it asks for pulses; ``coil``: it is of the coil driver alone."""

    run: Callable[[BoardUnderTest], None]
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
    Check(checks.heartbeats, coil=False),
    Check(checks.all_along, coil=False),
)


class CheckResult(NamedTuple):
    """The result of a check. ``failure`` None: kept; ``ran`` False: it needs power and nothing is armed."""

    name: str
    what: str
    ran: bool
    failure: str | None = None


def run_checks(
    link: BoardLink,
    limits: BoardLimits,
    armed: bool,
    report: Callable[[CheckResult], None] = lambda result: None,
) -> list[CheckResult]:
    """Run every check that fits the board, each in its turn.

    Raises:
        HarnessError: no board answers, or another node sends SYNC.
    """
    board = BoardUnderTest(link, limits)
    results = []
    for check in CHECKS:
        if check.coil and link.kind.sample is not CoilStatus:
            continue
        what = " ".join((check.run.__doc__ or "").split())
        result = CheckResult(check.run.__name__, what, ran=armed or not check.power)
        if result.ran:
            result = result._replace(failure=_failure(check, board))
        if not any(reply.messages for reply in link.replies):
            raise HarnessError(f"no {link.kind.node} board answers on this bus")
        report(result)
        results.append(result)
    return results


def _failure(check: Check, board: BoardUnderTest) -> str | None:
    try:
        check.run(board)
    except NonconformanceError as error:
        return str(error)
    return None
