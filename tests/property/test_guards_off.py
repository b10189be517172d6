"""Each guard earns its place: switched off, a fault that it is there for is seen. The other guards stay on.

Guards of boards by themselves are switched off in ``tests/sim/conformance/test_conformance.py``, scheduler
and interlock thing by thing in ``tests/property/proof``; without the decode gate ``tests/fuzz`` fails.
"""

from dataclasses import replace
from typing import NamedTuple

import pytest

from fsw.core.actuation.pulses import PulseState
from fsw.core.gate.sync_watch import Belief
from fsw.core.monitors import first_violation
from sim.fault_table.case import fly
from sim.fault_table.row import CheckVerdict
from sim.fault_table.rows.table import ROWS


class Off(NamedTuple):
    """How a guard is switched off, the row that shows it, and the check of the row that fails then."""

    row: str
    fails: str
    patch: tuple[str, object]
    phase: int = 0
    watch_s: float = 330.0


def ready_at_once(tick, config):
    return PulseState(ready_tick=(tick, tick, tick), busy_until=tick)


def believing(watch, current, tick, leap_ticks):
    """Every tick ahead is believed at once, and none behind ever."""
    return Belief.NEXT if tick > current else Belief.IGNORED


HALFWAY = 5
"""The phase that is in the middle of a back-off: the board's own word is not enough then."""


def without_freshness(watched):
    """The first violation where a field that is never received does not count."""
    return first_violation(watched.replace(field_age_ticks=0))


GUARDS = {
    "scheduler: back-off after boot": Off(
        "fsw-killed", "boots locked", ("fsw.core.actuation.pulses.boot", ready_at_once), phase=HALFWAY
    ),
    "interlock": Off("second-sender", "limits", ("hil_stub.coils.interlock._REFUSED_IF", ())),
    "clock of the board": Off(
        "ticks-rushed",
        "limits by time",
        ("hil_stub.coils.guard.Guard.pass_time", lambda self, clock_ms: None),
    ),
    "ticks that leap": Off(
        "sync-forged-going-on", "undisturbed", ("fsw.core.step.judge_sync", believing), watch_s=100.0
    ),
    "freshness": Off(
        "mag-board-dead", "silence named", ("fsw.core.supervisor.first_violation", without_freshness)
    ),
    "monitors": Off(
        "coil-stuck-on-1", "stuck", ("fsw.core.supervisor.first_violation", lambda watched: None)
    ),
    "second sender": Off("second-sender", "no request", ("fsw.core.step.watch_senders", lambda *seen: None)),
    "sensor health": Off(
        "mag-bias",
        "named or doubted",
        ("fsw.core.fdir.sensors.health.judge_sensors", lambda *seen: None),
        watch_s=100.0,
    ),
    "coil health: current": Off(
        "coil-stuck-on-1",
        "stuck",
        ("fsw.core.fdir.coils.currents.judge_current", lambda *seen: None),
    ),
    "coil health: rate": Off(
        "coil-reversed-1",
        "named",
        (
            "fsw.core.fdir.coils.torques.judge_effect",
            lambda *seen: None,
        ),
        watch_s=2000.0,
    ),
    "read-back of the board": Off(
        "coil-open-1", "board names", ("hil_stub.coils.read_back.ReadBack.judge", lambda *seen: None)
    ),
}


@pytest.mark.long
@pytest.mark.interpreted
@pytest.mark.parametrize("off", GUARDS.values(), ids=GUARDS)
def test_without_the_guard_the_fault_is_seen(off, monkeypatch):
    row = next(row for row in ROWS if row.name == off.row)
    monkeypatch.setattr(*off.patch)
    outcomes = fly(replace(row, watch_s=off.watch_s), off.phase, seed=1).outcomes
    assert off.fails in {outcome.check for outcome in outcomes if outcome.verdict is CheckVerdict.FAIL}
