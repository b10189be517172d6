"""``torquer hil --conformance``: one board, checked over its bus."""

import time

from fsw.bus.open_bus import open_bus, resolve
from sim.conformance.board_link import BOARD_KINDS, BoardLink
from sim.conformance.board_under_test import BoardLimits
from sim.conformance.check_runner import CheckResult, run_checks
from sim.console import answer, say
from sim.errors import HarnessError
from sim.scenario.coil_limits import coil_limits
from sim.scenario.schema import Scenario

LEAST_DEADMAN_TICKS = 2
"""A tick is held for part of the dead-man, and may be late."""

_MARKS = {True: "ok    ", False: "FAILED"}


def conformance(scenario: Scenario, kind: str, bus: str, armed: bool, deadman_s: float) -> int:
    """Check the board of ``kind`` on ``bus`` against docs/icd.md, its limits being those of the scenario.

    Raises:
        BusError: the bus cannot be used.
        HarnessError: no board answers, another node sends SYNC, the scenario's coil board is another one, or
            its dead-man is too short.
    """
    if kind == "coil" and scenario.coils.driver == "continuous":
        raise HarnessError(
            f"{scenario.name}: coils.driver: the board is a continuous driver; the checks are of a pulsed one"
        )
    tick_hz = scenario.time.tick_hz
    if kind == "coil" and deadman_s * tick_hz < LEAST_DEADMAN_TICKS:
        raise HarnessError(
            f"--deadman-s {deadman_s:g}: at {tick_hz} Hz the checks need at least "
            f"{LEAST_DEADMAN_TICKS / tick_hz:g} s, as a SYNC that is late would wake a shorter one"
        )
    board = coil_limits(scenario.coils, tick_hz)
    limits = BoardLimits(board.pulse_ms, board.backoff_ms, board.shared, deadman_s)
    spec = resolve(bus)
    can_bus = open_bus(spec)
    say(f"{kind} on {spec}, {tick_hz} Hz, {_limits_text(limits)}")
    began = time.monotonic()
    try:
        results = run_checks(BoardLink(can_bus, BOARD_KINDS[kind], tick_hz), limits, armed, _say)
    finally:
        can_bus.close()
    failed = [result for result in results if result.failure]
    unarmed = [result for result in results if not result.ran]
    skipped = f", {len(unarmed)} not run: they drive coils and need --arm" if unarmed else ""
    say(f"{len(results) - len(failed) - len(unarmed)} kept, {len(failed)} failed{skipped}")
    checks = [result._asdict() for result in results]
    answer({"board": kind, "bus": spec, "seconds": time.monotonic() - began, "checks": checks})
    return int(bool(failed))


def _limits_text(limits: BoardLimits) -> str:
    scope = "shared" if limits.shared else "per coil"
    return (
        f"pulses up to {limits.pulse_ms / 1000.0:g} s, back-off {limits.backoff_ms / 1000.0:g} s ({scope}), "
        f"dead-man {limits.deadman_s:g} s"
    )


def _say(result: CheckResult) -> None:
    mark = _MARKS[result.failure is None] if result.ran else "not run"
    say(f"{mark:<8}{result.name:<20} {result.failure or result.what}", failed=bool(result.failure))
