"""Which unit the flight software blames, as its events tell: units by the names that rows give them."""

from collections.abc import Callable

from fsw.core.events import Event as Number
from fsw.core.fdir.sensor_watch import Sensor
from fsw.core.monitors import Monitor
from hil_stub.coils.events import CoilEventCode
from sim.harness.faults.record import Event, Record

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
