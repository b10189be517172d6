"""Which unit the flight software blames, as its events tell: units by the names that rows give them."""

from collections.abc import Callable

from fsw.core.events import Event as Number
from fsw.core.fdir.sensor_watch import Sensor
from fsw.core.monitors import Monitor
from fsw.wire.messages import Mode
from hil_stub.coils.events import CoilEventCode
from sim.fault_rig.record import Event, Record
from sim.fault_table.row import Bounds, Row

A_FEW = 5
"""Pulses of a coil by which it is named if it is faulty."""
Blame = Callable[[Event], str]
SECOND_SENDER = "second sender"
_IDENTIFIERS = 0x800

_SILENT = {
    Monitor.FIELD_FRESH: "magnetometer",
    Monitor.COIL_STATUS_FRESH: "coil board",
    Monitor.COIL_AS_COMMANDED: "coil board",
    Monitor.NO_SECOND_SENDER: SECOND_SENDER,
}


def _tripped(event: Event) -> str:
    monitor = Monitor(event.argument)
    return _SILENT.get(monitor, monitor.name)


MONITORS: dict[int, Blame] = {Number.MONITOR_TRIPPED: _tripped}
"""What monitors say: that a board is silent or does what it was not asked."""

_SENSORS = {Sensor.MAGNETOMETER: "magnetometer", Sensor.SUN_SENSOR: "sun sensor"}
_COILS = {number: f"coil {number - 1}" for number in (1, 2, 3)}

_ISOLATING: dict[str, dict[int, str]] = {
    "SENSOR_ISOLATED": {int(sensor): unit for sensor, unit in _SENSORS.items()},
    "COIL_FAULT": _COILS,
    "SECOND_SENDER": dict.fromkeys(range(1 + _IDENTIFIERS // 100), SECOND_SENDER),
}
"""Units by the hundreds of the argument, by event: one that fsw does not know yet names nobody."""

ISOLATED: dict[int, dict[int, str]] = {
    int(Number[name]): units for name, units in _ISOLATING.items() if name in Number.__members__
}
"""The same by the number of the event."""


def can_name(unit: str) -> bool:
    """Whether the flight software has an event by which it could name this unit as faulty."""
    return any(unit in units.values() for units in ISOLATED.values())


def isolated(record: Record) -> list[tuple[int, str]]:
    """(tick, unit) for each time that a unit was named as faulty."""
    return [
        (event.tick, ISOLATED[event.number].get(event.argument // 100, f"unit {event.argument}"))
        for event in record.events
        if event.number in ISOLATED
    ]


def tripped(record: Record) -> list[tuple[int, str]]:
    """(tick, unit) for each time that a monitor tripped."""
    return [
        (event.tick, MONITORS[event.number](event)) for event in record.events if event.number in MONITORS
    ]


_WITHOUT_A_COIL = {
    CoilEventCode.DEAD_MAN: "plant",
    CoilEventCode.CURRENT_WHILE_OFF: "coil driver",
    CoilEventCode.CURRENT_WRONG: "coil driver",  # the coil that is driven, or another beside it
    CoilEventCode.SELF_TEST_FAILED: "coil driver",
}


def named_by_board(record: Record) -> list[tuple[int, str]]:
    """(tick, unit) for each time that the coil driver board has named a unit by its read-back."""
    return [
        (event.tick, _WITHOUT_A_COIL.get(CoilEventCode(event.number), f"coil {event.coil}"))
        for event in record.board_events
    ]


def blamed_rightly(row: Row, record: Record, bounds: Bounds) -> tuple[bool | None, str]:
    """The unit that is faulty is named, and no other."""
    if not can_name(row.unit):
        return None, f"fsw cannot name {row.unit} yet"
    onset = record.onset or 0
    units = [(tick, unit) for tick, unit in isolated(record) if tick >= onset]
    wrong = [(tick, unit) for tick, unit in units if unit != row.unit]
    right = [tick for tick, unit in units if unit == row.unit]
    if wrong:
        return False, f"{wrong[0][1]} named in place of {row.unit} in tick {wrong[0][0]}"
    if not right:
        return _not_named(row, record, onset)
    return True, f"named after {(right[0] - onset) / record.tick_hz:.0f} s"


def no_other_named(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """If any unit is named it is the one that is disturbed, which need not be."""
    others = [(tick, unit) for tick, unit in isolated(record) if unit != row.unit]
    return not others, f"{others[0][1]} named in tick {others[0][0]}" if others else ""


def _not_named(row: Row, record: Record, onset: int) -> tuple[bool | None, str]:
    """A coil shows what is wrong with it only while it is on: less than a few pulses are no evidence."""
    if not row.unit.startswith("coil ") or "stuck" in row.expect:
        return False, f"{row.unit} is not named"
    requests = zip(record.asked, record.asked_coils, strict=True)
    count = sum(tick >= onset and f"coil {coil}" == row.unit for tick, coil in requests)
    return None if count < A_FEW else False, f"{row.unit} is not named in {count} pulses of its own"


def board_names(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """The coil driver board names the coil by its read-back; of a current that nobody drives, itself."""
    unit = "coil driver" if "stuck" in row.expect else row.unit
    onset = record.onset or 0
    units = [(tick, named) for tick, named in named_by_board(record) if tick >= onset]
    if not units:
        return False, f"the board does not name {unit}"
    tick, first = units[0]
    return first == unit, f"board names {first} after {(tick - onset) / record.tick_hz:.0f} s"


def silence_named(row: Row, record: Record, bounds: Bounds) -> tuple[bool, str]:
    """The monitor of the board that is silent trips, and no other."""
    onset = record.onset or 0
    units = [unit for tick, unit in tripped(record) if tick >= onset]
    return set(units) == {row.unit}, f"tripped for {', '.join(units) or 'nothing'}"


def stuck(row: Row, record: Record, bounds: Bounds) -> tuple[bool | None, str]:
    """A driver that is stuck on is answered with SAFE."""
    if not can_name(row.unit):
        return None, "fsw cannot tell a driver that is stuck on yet"
    onset = record.onset or 0
    safe = [tick for tick in range(onset, record.ticks) if record.modes[tick] is Mode.SAFE]
    return bool(safe), f"SAFE after {(safe[0] - onset) / record.tick_hz:.0f} s" if safe else "no SAFE"
