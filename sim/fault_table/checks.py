"""What is expected of a flight with a fault, one function a check; the table says which row expects which."""

from fractions import Fraction

from fsw.core.events import Event
from fsw.wire.messages import Mode
from sim.audit.auditor import audit
from sim.audit.limits import limits_in
from sim.fault_rig import currents
from sim.fault_rig.currents import CurrentLimits
from sim.fault_rig.record import Record
from sim.fault_table.naming import (
    SECOND_SENDER,
    blamed_rightly,
    board_names,
    can_name,
    isolated,
    no_other_named,
    silence_named,
    stuck,
    tripped,
)
from sim.fault_table.row import Bounds, Check, Outcome, Row, Verdict
from sim.scenario.coil_limits import coil_limits
from sim.scenario.schema import Scenario, orbit_period_s

GOOD_DEG = 2.0
GOOD_FOR_S = 600.0
FAR_DEG, LAST_S = 15.0, 300.0
"""Three times the standard deviation up to which fsw calls an estimate valid."""
OF_THE_PLANT = (Event.STRANGE_SYNC, Event.PLANT_RESTARTED, Event.FALSE_END)
MOST_DEAF = 3
"""Ticks: a SYNC that is strange, and one that confirms it."""
MOST_FRAMES = 64
"""In one answer; a step says a dozen things at most."""


def bounds_of(scenario: Scenario) -> Bounds:
    """What the flights of a scenario are judged by: its own limits, from the table of its coils."""
    board = coil_limits(scenario.coils, scenario.time.tick_hz)
    first_ma, second_ma, third_ma = scenario.coils.levels_ma
    return Bounds(
        limits_in(scenario.model_dump(mode="json"), scenario.name),
        CurrentLimits(
            board.tick_hz,
            (1e-3 * first_ma, 1e-3 * second_ma, 1e-3 * third_ma),
            Fraction(board.pulse_ms, 1000),
            Fraction(board.backoff_ms, 1000),
            board.shared,
        ),
        orbit_period_s(scenario),
        scenario.coils.backoff_s,
    )


def limits(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """Invariant I by both audits: of what the board has said, and of what the plant has driven."""
    report = audit(record.entries, bounds.audit)
    found = [str(violation) for violation in report.violations]
    if "stuck" not in row.expect:  # a switch that does not open is beyond every guard
        found += currents.violations(record.coil_drives, bounds.currents)
    return not found and report.statuses > 0, found[0] if found else ""


def limits_by_time(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """Invariant I over true time, where ticks do not keep to it."""
    found = currents.lasting(record.pulses_by_time, bounds.currents)
    return not found and bool(record.pulses_by_time), found[0] if found else "nothing was driven"


def no_exception(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """Nothing comes out of a step but its answer."""
    return record.crash is None, record.crash or ""


def finite(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """All numbers that fsw acts on are numbers."""
    tick = record.not_finite
    return tick is None, "" if tick is None else f"NaN in the flight state at tick {tick}"


def answered(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """Every SYNC that moved time forward was answered, with a bounded number of frames, to the end."""
    if record.ended is not None:
        return False, f"fsw took the run for over in tick {record.ended}"
    if record.unanswered:
        return False, f"no TICK_DONE at tick {record.unanswered[0]}"
    most = record.worst_answer
    stopped = row.kind == "stopped"  # then it answers many ticks at once
    return stopped or most <= MOST_FRAMES, f"{most} frames in one answer"


def no_extra_pulse(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """Each pulse began in a tick in which fsw asked for it."""
    asked = set(record.asked)
    for pulse in currents.pulses(record.coil_drives, record.tick_hz):
        tick = int(pulse.start_s * record.tick_hz)
        if tick not in asked:
            return False, f"a pulse began in tick {tick}, which nobody asked for"
    return True, ""


def boots_locked(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """Nothing is asked for until a full back-off after a boot of fsw, or what it takes for the plant's."""
    full = bounds.backoff_s * record.tick_hz
    for boot in record.boots + record.restarts:
        for tick in record.asked:
            if boot <= tick < boot + full:
                return False, f"asked in tick {tick} after a start in tick {boot}"
    return True, ""


def goes_on(row: Row, record: Record, bounds: Bounds) -> tuple[bool | None, str]:
    """At the end control goes on (a pulse in the last two cycles), or fsw is in SAFE.

    A fault that stays can only be answered so once it can be named.
    """
    cycle = (bounds.backoff_s + 10.0) * record.tick_hz
    fired = any(tick > record.ticks - 2.0 * cycle for tick in record.asked)
    safe = record.modes[-1] is Mode.SAFE
    if fired or safe:
        return True, ""
    return None if row.stays and not can_name(row.unit) else False, "neither pulses nor SAFE at the end"


def no_request(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """Nothing is asked for from when the unit is named until the fault has gone, and something later."""
    end = record.end if record.end is not None else record.ticks
    named = min((tick for tick, unit in isolated(record) if unit == row.unit), default=record.onset or 0)
    early = [tick for tick in record.asked if named <= tick < end]
    if early:
        return False, f"asked in tick {early[0]} though {row.unit} is there"
    later = [tick for tick in record.asked if tick >= end]
    return bool(later), f"asks again {(later[0] - end) / record.tick_hz:.0f} s after" if later else "for ever"


def nobody_invented(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """A second sender is named only where somebody sends in the place of fsw."""
    if row.kind in ("second_sender", "random_frames", "done_forged"):
        return True, ""
    named = [tick for tick, unit in isolated(record) if unit == SECOND_SENDER]
    return not named, f"a second sender named in tick {named[0]}" if named else ""


def dropped(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """What was broken was counted."""
    return record.rejected > 0, "" if record.rejected else "nothing was counted as rejected"


def recovers(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """Within an orbit after the fault the true error stays below 2 deg for 600 s."""
    after_s = recovered_s(record)
    if after_s is None:
        return False, "the estimate does not recover"
    return after_s <= bounds.orbit_s, f"estimate recovers after {after_s:.0f} s"


def recovered_s(record: Record) -> float | None:
    """Seconds after the fault until the error stays below 2 deg for 600 s; None: never."""
    if record.end is None:
        return None
    good = 0
    for tick in range(record.end, record.ticks):
        error_deg = record.error_deg[tick]
        good = good + 1 if error_deg is not None and error_deg < GOOD_DEG else 0
        if good >= GOOD_FOR_S * record.tick_hz:
            return (tick + 1 - good - record.end) / record.tick_hz
    return None


def hears(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """From the first tick with the fault on, no more than a few ticks in a row are not answered."""
    deaf = most = 0
    for done in record.done[record.onset :]:
        deaf = 0 if done else deaf + 1
        most = max(most, deaf)
    return most <= MOST_DEAF, f"at most {most} ticks in a row not answered"


def undisturbed(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """The plant is not taken for one that has started anew, and the filter does not begin again."""
    onset = record.onset or 0
    again = [one.tick for one in record.events if one.number == Event.FILTER_RESTARTED and one.tick >= onset]
    found = record.restarts + again
    return not found, f"begins anew in tick {found[0]}" if found else ""


def told(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """An event tells of what was forged under the plant's identifiers."""
    onset = record.onset or 0
    ticks = [one.tick for one in record.events if one.number in OF_THE_PLANT and one.tick >= onset]
    return bool(ticks), f"told after {(ticks[0] - onset) / record.tick_hz:.0f} s" if ticks else "not told"


def quiet(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """No sensor, coil or monitor is blamed where nothing is wrong."""
    units = isolated(record) + tripped(record)
    return not units, f"{units[0][1]} blamed in tick {units[0][0]}" if units else ""


def bounded(row: Row, record: Record, bounds: Bounds) -> tuple[bool | None, str]:
    """At the end what fsw calls valid is not far off, though the sensor is still faulty."""
    last = record.error_deg[-round(LAST_S * record.tick_hz) :]
    worst_deg = max((error for error in last if error is not None), default=0.0)
    if worst_deg <= FAR_DEG:
        return True, ""
    said = f"an estimate called valid is {worst_deg:.0f} deg off"
    return (False if can_name(row.unit) else None), said


ALWAYS: dict[str, Check] = {
    "limits": limits,
    "no exception": no_exception,
    "no NaN": finite,
    "answered": answered,
    "nobody invented": nobody_invented,
}
CHECKS: dict[str, Check] = {
    **ALWAYS,
    "limits by time": limits_by_time,
    "no extra pulse": no_extra_pulse,
    "boots locked": boots_locked,
    "hears": hears,
    "undisturbed": undisturbed,
    "told": told,
    "no request": no_request,
    "goes on": goes_on,
    "dropped": dropped,
    "recovers": recovers,
    "quiet": quiet,
    "bounded": bounded,
    "board names": board_names,
    "silence named": silence_named,
    "named": blamed_rightly,
    "no other named": no_other_named,
    "stuck": stuck,
}


def judge(row: Row, record: Record, bounds: Bounds) -> tuple[Outcome, ...]:
    """All checks of a row on one flight."""
    outcomes = []
    for name in (*ALWAYS, *row.expect):
        holds, said = CHECKS[name](row, record, bounds)
        verdict = Verdict.OPEN if holds is None else Verdict.PASS if holds else Verdict.FAIL
        outcomes.append(Outcome(name, verdict, said))
    return tuple(outcomes)
