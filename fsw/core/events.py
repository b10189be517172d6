"""Events that fsw reports: numbers, severities, arguments, and how often one is reported.

The rate is limited for each kind; suppressed events are counted. A kind is an event with its argument where
that is a code, and the event alone where it is a quantity: the reports of a jittering clock, or of numbered
restarts, are one kind.
"""

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Final, final

from fsw.wire.messages import Severity
from fsw.wire.value import Value


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
    FILTER_EASED = 16  # how often so far


SEVERITY: Final[dict[Event, Severity]] = {
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
    Event.FILTER_EASED: Severity.WARNING,
}


@final
class Happening(Value):
    """An event to report, with its argument."""

    FIELDS = ("event", "argument")
    __slots__ = FIELDS

    def __init__(self, event: Event, argument: int) -> None:
        self.event = event
        self.argument = argument


QUANTITIES: Final = frozenset(
    {
        Event.TIME_MISMATCH,
        Event.FILTER_STARTED,
        Event.FILTER_RESTARTED,
        Event.FILTER_EASED,
        Event.STRANGE_SYNC,
        Event.PLANT_RESTARTED,
        Event.FALSE_END,
    }
)
MOST_KINDS: Final = 32
"""Kinds remembered at once; events of further kinds are suppressed."""


@final
class LastReport(Value):
    """A kind of event, and the tick in which it was last reported."""

    FIELDS = ("event", "argument", "tick")
    __slots__ = FIELDS

    def __init__(self, event: int, argument: int, tick: int) -> None:
        self.event = event
        self.argument = argument
        self.tick = tick


@final
@dataclass(slots=True)
class Throttle:
    """The kinds reported recently, and the number of events suppressed since boot."""

    reported: list[LastReport] = field(default_factory=list)
    held_back: int = 0


def throttle_events(
    throttle: Throttle, happenings: list[Happening], tick: int, spacing_ticks: int
) -> list[Happening]:
    """The events that may be reported in this tick, in their order; notes them, and counts the others."""
    if not happenings:
        return happenings
    reported = [kind for kind in throttle.reported if tick - kind.tick < spacing_ticks]
    recent = {(kind.event, kind.argument) for kind in reported}
    passed = []
    for happening in happenings:
        argument = 0 if happening.event in QUANTITIES else int(happening.argument)
        event = int(happening.event)
        if (event, argument) in recent or len(reported) >= MOST_KINDS:
            continue
        recent.add((event, argument))
        reported.append(LastReport(event, argument, tick))
        passed.append(happening)
    throttle.reported = reported
    throttle.held_back += len(happenings) - len(passed)
    return passed
