"""The check that no attitude is called valid that is wrong for long."""

from fsw.core.events import Event
from sim.fault_rig.record import FaultFlightRecord
from sim.fault_table.row import Bounds, FaultRow, Unseen

WRONG_DEG, ALONE_DEG, WRONG_S = 5.0, 15.0, 120.0
"""A valid attitude may be this wrong for this long while a new fault is being found."""
_WRONG_IN_SHADOW = (Unseen.IN_SHADOW, Unseen.ALONE, Unseen.AT_FIRST)
"""Rows in which the only sensor of the shadow may be the wrong one."""
FIRST_S = 600.0
"""Length of the first minutes, in which both sensors may agree on what is wrong [s]."""


def never_wrong_for_long(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """No attitude in the answers is valid and more than 5 deg wrong for over 120 s on end.

    Where nothing on board can show it, because both sensors agree on what is wrong, the row says so. Where
    the only sensor is the wrong one, as in the shadow, an estimate is settling, or the fault is within a
    declared bound, the limit is 15 deg, three times the largest sigma of a valid attitude. Only ticks that
    are answered count: one that is not ends nothing.
    """
    longest = wrong = 0
    worst_deg = 0.0
    settling = _settling(record, bounds) if row.unseen is Unseen.SETTLING else ()
    first = round(FIRST_S * record.tick_hz) if row.unseen is Unseen.AT_FIRST else 0
    onset = (record.onset or 0) if row.unseen is Unseen.ALONE else len(record.error_deg)
    for tick in range(first, len(record.error_deg)):
        if not record.done[tick]:
            continue  # it says nothing in this tick, neither that the attitude is valid nor that it is not
        error_deg = record.error_deg[tick]
        alone = tick >= onset or (row.unseen in _WRONG_IN_SHADOW and not record.lit[tick])
        loose = alone or row.unseen is Unseen.WITHIN_BOUND or any(tick in ticks for ticks in settling)
        limit_deg = ALONE_DEG if loose else WRONG_DEG
        wrong = wrong + 1 if error_deg is not None and error_deg > limit_deg else 0
        longest = max(longest, wrong)
        worst_deg = max(worst_deg, error_deg or 0.0) if wrong else worst_deg
    longest_s = longest / record.tick_hz
    finding = f"valid while up to {worst_deg:.0f} deg wrong, for {longest_s:.0f} s on end" if longest else ""
    return row.unseen is Unseen.ALWAYS or longest_s <= WRONG_S, finding


def _settling(record: FaultFlightRecord, bounds: Bounds) -> list[range]:
    """The orbit after each start of the filter, ticks."""
    orbit = round(bounds.orbit_s * record.tick_hz)
    started = [event.tick for event in record.events if event.number == Event.FILTER_STARTED]
    return [range(tick, tick + orbit) for tick in started]
