"""Events in words: what happened, when, and what it means."""

from collections.abc import Callable, Mapping
from enum import IntEnum
from typing import NamedTuple

from fsw.core.events import Event
from fsw.core.fdir.faults import CoilFault, Sensor, SensorFault
from fsw.core.monitors import Monitor
from fsw.wire.messages import CoilRefusedReason, Mode, Severity
from hil_stub.coils.events import CoilEventCode
from hil_stub.wheel.wheel_driver import WheelEventCode
from sim.audit.findings import seconds_text
from sim.drawing.page_parts import Table
from sim.scenario.schema import Scenario, orbit_period_s
from sim.value_types import Json

# --- Which unit the flight software has isolated, according to its events

UNITS: Mapping[int, Mapping[int, str]] = {
    Event.SENSOR_ISOLATED: {
        Sensor.MAGNETOMETER: "magnetometer",
        Sensor.SUN_SENSOR: "sun sensor",
        **{sensor: f"cell {sensor - Sensor.SUN_SENSOR}" for sensor in Sensor if sensor > Sensor.SUN_SENSOR},
    },
    Event.COIL_FAULT: {1: "coil 0", 2: "coil 1", 3: "coil 2"},
}
"""Units by event, and by the hundreds of its argument. Coils are numbered as on the bus."""


ISOLATED_BY: Mapping[int, int] = {
    Event.SENSOR_READMITTED: Event.SENSOR_ISOLATED,
    Event.COIL_READMITTED: Event.COIL_FAULT,
}
"""The event that a readmission reverses; its argument is the same."""


def isolated_unit(event: int, argument: int) -> str | None:
    """The unit that an event of the flight software isolates; None if it isolates none."""
    if event not in UNITS:
        return None
    return UNITS[event].get(argument // 100, f"unit {argument}")


def readmitted_unit(event: int, argument: int) -> str | None:
    """The unit that an event of the flight software readmits; None if it readmits none."""
    return isolated_unit(ISOLATED_BY[event], argument) if event in ISOLATED_BY else None


# --- The events

Words = tuple[Callable[[int], str], str]
"""What happened, by the argument; what it means."""


class EventInWords(NamedTuple):
    """An event as a person reads it; the meaning is empty where it is unknown."""

    t_s: float
    node: str
    severity: str
    what: str
    meaning: str


_MODES = {
    Mode.SAFE: "Coils are off. Control begins again when what tripped it is gone.",
    Mode.DETUMBLE: "The coils damp the rate; the attitude is not controlled.",
    Mode.ACQUIRE: "The attitude is estimated and turned towards nominal.",
    Mode.POINT: "The error is small: the attitude is held.",
}
_MONITORS: dict[int, str] = {
    Monitor.ATTITUDE_FINITE: "attitude or rate is no number",
    Monitor.QUATERNION_UNIT: "the quaternion has no unit norm",
    Monitor.RATE_BOUNDED: "the rate is larger than a satellite can have",
    Monitor.OWED_FINITE: "the owed impulse is no number",
    Monitor.FIELD_FRESH: "the magnetometer is silent",
    Monitor.COIL_STATUS_FRESH: "the coil board is silent",
    Monitor.COIL_AS_COMMANDED: "a coil is driven that was not requested",
    Monitor.ORBIT_KNOWN: "the orbit has no position",
    Monitor.NO_SECOND_SENDER: "another node sends as the flight software",
    Monitor.TIME_AGREES: "the time on the bus is not that of the onboard table",
}
_SENSOR_FAULTS: dict[int, str] = {
    SensorFault.SATURATED: "saturated",
    SensorFault.STRENGTH: "wrong strength",
    SensorFault.FROZEN: "frozen",
    SensorFault.REFUSED: "refused by the filter",
    SensorFault.SILENT: "silent",
    SensorFault.UNLIT: "no Sun in sunlight",
}
_COIL_FAULTS: dict[int, str] = {
    CoilFault.OPEN: "open",
    CoilFault.WEAK: "weak",
    CoilFault.REVERSED: "reversed",
    CoilFault.STUCK: "stuck",
}
_FSW: dict[int, Words] = {
    Event.FILTER_STARTED: (
        lambda count: "filter started" if not count else f"filter started, {count} restarts before",
        "From here on attitude and rate are estimated.",
    ),
    Event.FILTER_RESTARTED: (
        lambda count: f"filter restarted, restart {count}",
        "The estimate contradicted the sensors and was given up; it converges anew.",
    ),
    Event.FILTER_EASED: (
        lambda count: f"filter eased, number {count}",
        "The satellite changes by more than its table says: the estimate goes on, less certain, "
        "and is not valid until both sensors have proved it again.",
    ),
    Event.MONITOR_TRIPPED: (
        lambda number: f"monitor tripped: {_named(_MONITORS, number)}",
        "A check failed: the flight software goes to SAFE, coils off; too fast a turn is left to DETUMBLE.",
    ),
    Event.REQUEST_REFUSED: (
        lambda reason: f"pulse refused by the coil board: {_name(CoilRefusedReason, reason)}",
        "The interlock of the board held; this pulse was not fired.",
    ),
    Event.TIME_MISMATCH: (
        lambda seconds: f"SYNC is {seconds} s off the expected time",
        "The clock on the bus jumped.",
    ),
    Event.SENSOR_ISOLATED: (
        lambda argument: _unit(Event.SENSOR_ISOLATED, argument, _SENSOR_FAULTS),
        "Its samples are not used any more.",
    ),
    Event.SENSOR_READMITTED: (
        lambda argument: _unit(Event.SENSOR_ISOLATED, argument, _SENSOR_FAULTS, "used again after"),
        "It has been sound for long enough.",
    ),
    Event.SENSORS_DISAGREE: (
        lambda _: "magnetometer and Sun sensor disagree",
        "Without an estimate it is not decided which is wrong.",
    ),
    Event.COIL_FAULT: (
        lambda argument: _unit(Event.COIL_FAULT, argument, _COIL_FAULTS),
        "Control does without this coil.",
    ),
    Event.COIL_READMITTED: (
        lambda argument: _unit(Event.COIL_FAULT, argument, _COIL_FAULTS, "used again after"),
        "Its pulses act as they should.",
    ),
    Event.SECOND_SENDER: (
        lambda can_id: f"another node sends under 0x{can_id:03X}",
        "While it does, no pulse is requested.",
    ),
    Event.STRANGE_SYNC: (lambda tick: f"SYNC of tick {tick} is out of turn", "It was passed over."),
    Event.PLANT_RESTARTED: (
        lambda tick: f"the count of ticks began again after tick {tick}",
        "The plant was started again.",
    ),
    Event.FALSE_END: (
        lambda ticks: f"PLANT_END after {ticks} ticks is false",
        "The flight goes on: someone else sent it.",
    ),
}
_COIL: dict[int, Words] = {
    CoilEventCode.SELF_TEST_FAILED: (
        lambda ma: f"self-test failed, {ma} mA",
        "Current flows while all coils are off, or cannot be measured.",
    ),
    CoilEventCode.DEAD_MAN: (lambda _: "no SYNC: coils switched off", "A full lockout follows."),
    CoilEventCode.CURRENT_WHILE_OFF: (
        lambda ma: f"current while off, {ma} mA",
        "The interlock cannot stop it; every request is refused.",
    ),
    CoilEventCode.NO_CURRENT: (lambda ma: f"no current, {ma} mA", "A coil is on, but nothing flows."),
    CoilEventCode.CURRENT_REVERSED: (
        lambda ma: f"current reversed, {ma} mA",
        "A coil is on with the wrong sign.",
    ),
    CoilEventCode.CURRENT_WRONG: (
        lambda ma: f"current wrong, {ma} mA",
        "It differs from the nominal one by more than 20 %.",
    ),
}
_WORDS = {"FSW": _FSW, "COIL": _COIL}
"""By node, then by the number of the event."""
_NAMES: Mapping[str, type[IntEnum]] = {"FSW": Event, "COIL": CoilEventCode, "WHEEL": WheelEventCode}
"""The names of the events of a node."""


def event_names(node: str, event: int, severity: int) -> dict[str, str | None]:
    """The names of an event of a node and of its severity; None for a number that has none."""
    kind = _NAMES.get(node)
    return {
        "name": kind(event).name if kind is not None and event in set(kind) else None,
        "severity_name": Severity(severity).name if severity in set(Severity) else None,
    }


def in_words(event: Json) -> EventInWords:
    """An event of summary.json; an unknown one is named by its number."""
    number, argument = event["event"], event["argument"]
    if event["node"] == "FSW" and number == Event.MODE_CHANGED and argument in _MODES:
        what, meaning = f"mode {Mode(argument).name}", _MODES[Mode(argument)]
    else:
        unknown: Words = (lambda value: f"event {number} ({value})", "")
        describe, meaning = _WORDS.get(event["node"], {}).get(number, unknown)
        what = describe(argument)
    severity = _name(Severity, event["severity"]) if event["severity"] in set(Severity) else ""
    return EventInWords(event["t_s"], event["node"], severity, what, meaning)


def event_table(summary: Json, scenario: Scenario) -> Table:
    """What the nodes reported, in order; the caption says where the summary holds the first ones alone."""
    orbit_s = orbit_period_s(scenario)
    events = [in_words(one) for one in summary.get("events", [])]
    rows = [
        (seconds_text(one.t_s), f"{one.t_s / orbit_s:.2f}", one.node, one.severity, one.what, one.meaning)
        for one in events
    ]
    head = ("t [s]", "orbit", "node", "severity", "what happened", "what it means")
    return Table(head, rows, events_left_out(summary))


def events_left_out(summary: Json) -> str:
    """A clause on the events that the summary counts and does not hold; empty where it holds all."""
    held = len(summary.get("events", []))
    count = summary.get("event_count", held)
    return f"The first {held} of {count} events" if count > held else ""


def _unit(event: Event, argument: int, faults: Mapping[int, str], now: str = "isolated") -> str:
    unit, fault = divmod(argument, 100)
    return f"{_named(UNITS[event], unit)} {now}: {_named(faults, fault)}"


def _named(names: Mapping[int, str], number: int) -> str:
    return names.get(number, f"number {number}")


def _name(kind: type[IntEnum], number: int) -> str:
    """The name of a number in words, or the number where it has none."""
    return kind(number).name.replace("_", " ").lower() if number in set(kind) else f"number {number}"
