"""``torquer hil --conformance``: one board, checked over its bus, and the verdict as text or JSON."""

import json
import time

import click

from fsw.bus.open_bus import open_bus, resolve
from sim.conformance.conformance import Verdict, conform
from sim.conformance.session import KINDS, Session
from sim.conformance.subject import Limits
from sim.scenario.coil_limits import coil_limits
from sim.scenario.schema import Scenario

_MARKS = {True: "ok    ", False: "FAILED"}


def conformance(
    scenario: Scenario, kind: str, bus: str, armed: bool, deadman_s: float, as_json: bool = False
) -> int:
    """Check the board of ``kind`` on ``bus`` against docs/icd.md, its limits being those of the scenario.

    Raises:
        BusError: the bus cannot be used.
        HarnessError: no board answers, or somebody else paces the bus.
    """
    tick_hz = scenario.time.tick_hz
    board = coil_limits(scenario.coils, tick_hz)
    limits = Limits(board.pulse_ms, board.backoff_ms, board.shared, deadman_s)
    spec = resolve(bus)
    link = open_bus(spec)
    if not as_json:
        click.echo(f"{kind} on {spec}, {tick_hz} Hz, {_said(limits)}")
    began = time.monotonic()
    try:
        verdicts = conform(Session(link, KINDS[kind], tick_hz), limits, armed, lambda v: _tell(v, as_json))
    finally:
        link.close()
    failed = [verdict for verdict in verdicts if verdict.failure]
    unarmed = [verdict for verdict in verdicts if not verdict.ran]
    if as_json:
        wall_s = time.monotonic() - began
        checks = [verdict._asdict() for verdict in verdicts]
        click.echo(json.dumps({"board": kind, "bus": spec, "seconds": wall_s, "checks": checks}, indent=2))
    else:
        skipped = f", {len(unarmed)} not run: they drive coils and need --arm" if unarmed else ""
        click.echo(f"{len(verdicts) - len(failed) - len(unarmed)} kept, {len(failed)} failed{skipped}")
    return int(bool(failed))


def _said(limits: Limits) -> str:
    kind = "shared" if limits.shared else "per coil"
    return (
        f"pulses up to {limits.pulse_ms / 1000.0:g} s, back-off {limits.backoff_ms / 1000.0:g} s ({kind}), "
        f"dead-man {limits.deadman_s:g} s"
    )


def _tell(verdict: Verdict, as_json: bool) -> None:
    if as_json:
        return
    mark = _MARKS[verdict.failure is None] if verdict.ran else "not run"
    click.echo(f"{mark:<8}{verdict.name:<20} {verdict.failure or verdict.what}")
