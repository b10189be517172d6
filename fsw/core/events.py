"""Events that fsw reports: numbers, severities, arguments."""

from enum import IntEnum
from typing import NamedTuple

from fsw.wire.messages import Severity


class Event(IntEnum):
    """Numbers of fsw's events, with the meaning of the argument."""

    MODE_CHANGED = 1  # the new mode
    FILTER_STARTED = 2  # restarts so far
    FILTER_RESTARTED = 3  # restarts so far
    MONITOR_TRIPPED = 4  # number of the monitor
    REQUEST_REFUSED = 5  # reason
    TIME_MISMATCH = 6  # SYNC's time less the expected, s
    SENSOR_ISOLATED = 7  # 100 times the number of the sensor, plus that of its fault
    SENSOR_READMITTED = 8  # as in its isolation
    SENSORS_DISAGREE = 9  # 0: without an estimate neither of them can be isolated
    COIL_FAULT = 10  # 100 times the number of the coil (1 to 3), plus that of its fault
    SECOND_SENDER = 11  # the identifier of fsw under which another sends
    STRANGE_SYNC = 12  # its tick; if there were several, that of the last
    PLANT_RESTARTED = 13  # the last tick of the old count
    FALSE_END = 14  # the ticks in PLANT_END
    COIL_READMITTED = 15  # as in its isolation


SEVERITY: dict[Event, Severity] = {
    Event.MODE_CHANGED: Severity.INFO,
    Event.FILTER_STARTED: Severity.INFO,
    Event.FILTER_RESTARTED: Severity.WARNING,
    Event.MONITOR_TRIPPED: Severity.ERROR,
    Event.REQUEST_REFUSED: Severity.WARNING,
    Event.TIME_MISMATCH: Severity.WARNING,
    Event.SENSOR_ISOLATED: Severity.ERROR,
    Event.SENSOR_READMITTED: Severity.INFO,
    Event.SENSORS_DISAGREE: Severity.WARNING,
    Event.COIL_FAULT: Severity.ERROR,
    Event.SECOND_SENDER: Severity.ERROR,
    Event.STRANGE_SYNC: Severity.WARNING,
    Event.PLANT_RESTARTED: Severity.WARNING,
    Event.FALSE_END: Severity.WARNING,
    Event.COIL_READMITTED: Severity.INFO,
}


class Happening(NamedTuple):
    """An event to report, with its argument."""

    event: Event
    argument: int
