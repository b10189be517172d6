"""Which unit the flight software isolates, by its events; units have the names that rows use."""

from collections.abc import Callable

from fsw.core.events import Event as Number
from fsw.core.monitors import Monitor
from fsw.wire.messages import Mode
from hil_stub.coils.events import CoilEventCode
from sim.fault_rig.record import FaultFlightRecord, ReportedEvent
from sim.fault_table.row import Bounds, FaultRow
from sim.flight.isolations import UNITS, isolated_unit

LEAST_PULSES = 5
"""Pulses of a coil that suffice to isolate it if it is faulty."""
UnitOf = Callable[[ReportedEvent], str]
SECOND_SENDER = "second sender"

_UNIT_OF_MONITOR = {
    Monitor.FIELD_FRESH: "magnetometer",
    Monitor.COIL_STATUS_FRESH: "coil board",
    Monitor.COIL_AS_COMMANDED: "coil board",
    Monitor.NO_SECOND_SENDER: SECOND_SENDER,
}


def _unit_of_trip(event: ReportedEvent) -> str:
    monitor = Monitor(event.argument)
    return _UNIT_OF_MONITOR.get(monitor, monitor.name)


MONITORS: dict[int, UnitOf] = {Number.MONITOR_TRIPPED: _unit_of_trip}
"""Units by the event of a monitor: a board is silent, or acts without a request."""


def can_isolate(unit: str) -> bool:
    """Whether the flight software has an event that isolates this unit."""
    return unit == SECOND_SENDER or any(unit in units.values() for units in UNITS.values())


def isolations(record: FaultFlightRecord) -> list[tuple[int, str]]:
    """(tick, unit) of each isolation of a unit."""
    units = [(event.tick, _isolated_by(event)) for event in record.events]
    return [(tick, unit) for tick, unit in units if unit is not None]


def _isolated_by(event: ReportedEvent) -> str | None:
    if event.number == Number.SECOND_SENDER:
        return SECOND_SENDER
    return isolated_unit(event.number, event.argument)


def monitor_trips(record: FaultFlightRecord) -> list[tuple[int, str]]:
    """(tick, unit) of each trip of a monitor."""
    return [
        (event.tick, MONITORS[event.number](event)) for event in record.events if event.number in MONITORS
    ]


_WITHOUT_A_COIL = {
    CoilEventCode.DEAD_MAN: "plant",
    CoilEventCode.CURRENT_WHILE_OFF: "coil driver",
    CoilEventCode.CURRENT_WRONG: "coil driver",  # of the driven coil, or of another beside it
    CoilEventCode.SELF_TEST_FAILED: "coil driver",
}


def board_identifications(record: FaultFlightRecord) -> list[tuple[int, str]]:
    """(tick, unit) of each unit that the coil driver board has identified by its read-back."""
    return [
        (event.tick, _WITHOUT_A_COIL.get(CoilEventCode(event.number), f"coil {event.coil}"))
        for event in record.board_events
    ]


def isolates_faulty_unit(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool | None, str]:
    """The faulty unit is isolated, and no other."""
    if not can_isolate(row.unit):
        return None, f"fsw cannot isolate {row.unit} yet"
    onset = record.onset or 0
    units = [(tick, unit) for tick, unit in isolations(record) if tick >= onset]
    wrong = [(tick, unit) for tick, unit in units if unit != row.unit]
    right = [tick for tick, unit in units if unit == row.unit]
    if wrong:
        return False, f"{wrong[0][1]} isolated in place of {row.unit} in tick {wrong[0][0]}"
    if not right:
        return _not_isolated(row, record, onset)
    return True, f"isolated after {(right[0] - onset) / record.tick_hz:.0f} s"


def isolates_no_other_unit(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """No unit other than the disturbed one is isolated; the disturbed one may be."""
    others = [(tick, unit) for tick, unit in isolations(record) if unit != row.unit]
    return not others, f"{others[0][1]} isolated in tick {others[0][0]}" if others else ""


def _not_isolated(row: FaultRow, record: FaultFlightRecord, onset: int) -> tuple[bool | None, str]:
    """A coil shows its fault only while it is on: a few pulses are needed as evidence."""
    if not row.unit.startswith("coil ") or "stuck" in row.expect:
        return False, f"{row.unit} is not isolated"
    requests = zip(record.request_ticks, record.request_coils, strict=True)
    count = sum(tick >= onset and f"coil {coil}" == row.unit for tick, coil in requests)
    return None if count < LEAST_PULSES else False, f"{row.unit} is not isolated in {count} pulses of its own"


def board_identifies_unit(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """The coil driver board identifies the coil by its read-back; itself for a current without a command."""
    unit = "coil driver" if "stuck" in row.expect else row.unit
    onset = record.onset or 0
    units = [(tick, found) for tick, found in board_identifications(record) if tick >= onset]
    if not units:
        return False, f"the board does not identify {unit}"
    tick, first = units[0]
    return first == unit, f"board identifies {first} after {(tick - onset) / record.tick_hz:.0f} s"


def monitor_trips_for_silent_board(
    row: FaultRow, record: FaultFlightRecord, bounds: Bounds
) -> tuple[bool, str]:
    """The monitor of the silent board trips, and no other."""
    onset = record.onset or 0
    units = [unit for tick, unit in monitor_trips(record) if tick >= onset]
    return set(units) == {row.unit}, f"tripped for {', '.join(units) or 'nothing'}"


def enters_safe(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool | None, str]:
    """SAFE is entered if a driver is stuck on."""
    if not can_isolate(row.unit):
        return None, "fsw cannot detect a driver that is stuck on yet"
    onset = record.onset or 0
    safe = [tick for tick in range(onset, record.ticks) if record.modes[tick] is Mode.SAFE]
    return bool(safe), f"SAFE after {(safe[0] - onset) / record.tick_hz:.0f} s" if safe else "no SAFE"
