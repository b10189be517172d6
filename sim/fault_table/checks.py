"""The checks on flights with faults, a function each; the rows of the table say which of them apply."""

from fractions import Fraction

from fsw.core.events import Event
from fsw.wire.messages import Mode
from sim.audit.auditor import audit
from sim.audit.limits import limits_in
from sim.fault_rig import currents
from sim.fault_rig.currents import CurrentLimits
from sim.fault_rig.record import FaultFlightRecord
from sim.fault_table.isolation import (
    SECOND_SENDER,
    board_identifies_unit,
    can_isolate,
    enters_safe,
    isolates_faulty_unit,
    isolates_no_healthy_unit,
    isolates_or_disputes_faulty_unit,
    isolations,
    monitor_trips,
    monitor_trips_for_silent_board,
    uses_unit_again,
)
from sim.fault_table.row import Bounds, Check, CheckOutcome, CheckVerdict, FaultRow
from sim.fault_table.wrong_estimates import never_wrong_for_long
from sim.faults.kinds import KINDS
from sim.scenario.assemble import coil_limits
from sim.scenario.schema import Scenario, orbit_period_s

GOOD_DEG = 2.0
GOOD_FOR_S = 600.0
CYCLES = 4.0
FAR_DEG, LAST_S = 15.0, 300.0
"""Three times the standard deviation up to which fsw marks an estimate as valid."""
FORGERY_EVENTS = (Event.STRANGE_SYNC, Event.PLANT_RESTARTED, Event.FALSE_END)
MOST_UNANSWERED = 3
"""Ticks in a row: a SYNC out of sequence, and one that confirms it."""
MOST_FRAMES = 64
"""Of one answer; a step sends a dozen frames at most."""


def bounds_of(scenario: Scenario) -> Bounds:
    """The bounds for flights of a scenario, from the table of its coils."""
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


def keeps_limits(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """Invariant I by both audits: of COIL_STATUS, and of the currents that the plant drove."""
    report = audit(record.entries, bounds.audit)
    found = [str(violation) for violation in report.violations]
    if "stuck" not in row.expect:  # no guard can open a switch that is stuck
        found += currents.violations(record.coil_drives, bounds.currents)
    return not found and report.statuses > 0, found[0] if found else ""


def keeps_limits_over_time(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """Invariant I over true time, where ticks deviate from it."""
    found = currents.lasting(record.pulses_by_time, bounds.currents)
    return not found and bool(record.pulses_by_time), found[0] if found else "nothing was driven"


def no_exception(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """No step raises an exception."""
    return record.crash is None, record.crash or ""


def state_is_finite(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """All numbers that fsw uses are finite."""
    tick = record.not_finite
    return tick is None, "" if tick is None else f"NaN in the flight state at tick {tick}"


def begins_with_a_pulse(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """A pulse came where one was awaited, to count from."""
    after_s = record.unfired_s
    return after_s is None, "" if after_s is None else f"no pulse in {after_s:.0f} s"


def answers_every_sync(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """Every SYNC that moved time forward was answered, with a bounded number of frames, to the end."""
    if record.ended is not None:
        return False, f"fsw ended the run in tick {record.ended}"
    if record.unanswered:
        return False, f"no TICK_DONE at tick {record.unanswered[0]}"
    most = record.worst_answer
    stopped = row.kind == "stopped"  # then it answers many ticks at once
    return stopped or most <= MOST_FRAMES, f"{most} frames in one answer"


def no_extra_pulse(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """Each pulse began in a tick in which fsw requested it."""
    request_ticks = set(record.request_ticks)
    for pulse in currents.pulses(record.coil_drives, record.tick_hz):
        tick = int(pulse.start_s * record.tick_hz)
        if tick not in request_ticks:
            return False, f"a pulse began in tick {tick} without a request"
    return True, ""


def waits_after_boot(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """No pulse is requested within a back-off after a boot of fsw or a restart of the plant."""
    full = bounds.backoff_s * record.tick_hz
    boots = [(tick, 0) for tick in record.boots]
    for boot, before in [*boots, *zip(record.restarts, record.requests_before, strict=True)]:
        for tick in record.request_ticks[before:]:
            if boot <= tick < boot + full:
                return False, f"request in tick {tick} after a start in tick {boot}"
    return True, ""


def control_continues(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool | None, str]:
    """At the end control continues (a pulse in the last cycles), or fsw is in SAFE.

    Without a fault up to three cycles pass without one, if the coil that could help lies along the field.
    With a permanent fault this can only be expected if fsw can isolate the unit.
    """
    cycle = (bounds.backoff_s + 10.0) * record.tick_hz
    fired = any(tick > record.ticks - CYCLES * cycle for tick in record.request_ticks)
    safe = record.modes[-1] is Mode.SAFE
    if fired or safe:
        return True, ""
    return None if row.stays and not can_isolate(row.unit) else False, "neither pulses nor SAFE at the end"


def stops_requests(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """No pulse is requested from the isolation of the unit to the end of the fault, and one is afterwards."""
    end = record.end if record.end is not None else record.ticks
    isolation_tick = min(
        (tick for tick, unit in isolations(record) if unit == row.unit), default=record.onset or 0
    )
    early = [tick for tick in record.request_ticks if isolation_tick <= tick < end]
    if early:
        return False, f"request in tick {early[0]} in spite of {row.unit}"
    later = [tick for tick in record.request_ticks if tick >= end]
    if not later:
        return False, "no request afterwards"
    return True, f"requests again {(later[0] - end) / record.tick_hz:.0f} s after"


def invents_no_second_sender(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """A second sender is reported only where another node sends in place of fsw."""
    if row.kind in ("second_sender", "random_frames", "done_forged"):
        return True, ""
    ticks = [tick for tick, unit in isolations(record) if unit == SECOND_SENDER]
    return not ticks, f"second sender reported in tick {ticks[0]}" if ticks else ""


def counts_rejected_frames(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """Corrupt frames were counted."""
    return record.rejected > 0, "" if record.rejected else "no frame was counted as rejected"


def recovers(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """Within an orbit after the fault the true error stays below 2 deg for 600 s."""
    after_s = recovery_s(record)
    if after_s is None:
        return False, "the estimate does not recover"
    return after_s <= bounds.orbit_s, f"estimate recovers after {after_s:.0f} s"


def recovery_s(record: FaultFlightRecord) -> float | None:
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


def keeps_answering(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """From the start of the fault, no more than a few ticks in a row are not answered."""
    unanswered = most = 0
    for done in record.done[record.onset :]:
        unanswered = 0 if done else unanswered + 1
        most = max(most, unanswered)
    return most <= MOST_UNANSWERED, f"at most {most} ticks in a row not answered"


def estimate_continues(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """No restart of the plant is concluded, and the filter is not restarted."""
    onset = record.onset or 0
    again = [one.tick for one in record.events if one.number == Event.FILTER_RESTARTED and one.tick >= onset]
    found = record.restarts + again
    return not found, f"restart in tick {found[0]}" if found else ""


def reports_forgery(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """An event reports the forgery under the plant's identifiers."""
    onset = record.onset or 0
    ticks = [one.tick for one in record.events if one.number in FORGERY_EVENTS and one.tick >= onset]
    if not ticks:
        return False, "not reported"
    return True, f"reported after {(ticks[0] - onset) / record.tick_hz:.0f} s"


def isolates_nothing(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """Without a fault no unit is isolated and no monitor trips."""
    units = isolations(record) + monitor_trips(record)
    return not units, f"{units[0][1]} isolated in tick {units[0][0]}" if units else ""


def valid_estimate_is_close(
    row: FaultRow, record: FaultFlightRecord, bounds: Bounds
) -> tuple[bool | None, str]:
    """At the end an estimate that fsw marks as valid is close to the truth despite the faulty sensor."""
    last = record.error_deg[-round(LAST_S * record.tick_hz) :]
    worst_deg = max((error for error in last if error is not None), default=0.0)
    if worst_deg <= FAR_DEG:
        return True, ""
    finding = f"an estimate marked as valid is {worst_deg:.0f} deg off"
    return (False if can_isolate(row.unit) else None), finding


ALWAYS: dict[str, Check] = {
    "limits": keeps_limits,
    "no exception": no_exception,
    "no NaN": state_is_finite,
    "answered": answers_every_sync,
    "fires": begins_with_a_pulse,
    "nobody invented": invents_no_second_sender,
    "no healthy named": isolates_no_healthy_unit,
    "honest": never_wrong_for_long,
}
_FROM_INSIDE = ("no exception", "no NaN", "answered", "honest")
"""What nothing measures where the flight software is a process of its own."""
CHECKS: dict[str, Check] = {
    **ALWAYS,
    "limits by time": keeps_limits_over_time,
    "no extra pulse": no_extra_pulse,
    "boots locked": waits_after_boot,
    "hears": keeps_answering,
    "undisturbed": estimate_continues,
    "told": reports_forgery,
    "no request": stops_requests,
    "goes on": control_continues,
    "dropped": counts_rejected_frames,
    "recovers": recovers,
    "quiet": isolates_nothing,
    "bounded": valid_estimate_is_close,
    "board names": board_identifies_unit,
    "silence named": monitor_trips_for_silent_board,
    "named": isolates_faulty_unit,
    "named or doubted": isolates_or_disputes_faulty_unit,
    "used again": uses_unit_again,
    "stuck": enters_safe,
}


def checks_of(row: FaultRow) -> tuple[str, ...]:
    """The names of the checks of a row: those of every row that can be measured there, and its own."""
    unmeasured = _FROM_INSIDE if KINDS[row.kind].by_signal else ()
    return (*(name for name in ALWAYS if name not in unmeasured), *row.expect)


def judge(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[CheckOutcome, ...]:
    """Apply all checks of a row to a flight."""
    outcomes = []
    for name in checks_of(row):
        holds, finding = CHECKS[name](row, record, bounds)
        verdict = CheckVerdict.OPEN if holds is None else CheckVerdict.PASS if holds else CheckVerdict.FAIL
        outcomes.append(CheckOutcome(name, verdict, finding))
    return tuple(outcomes)
