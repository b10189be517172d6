"""Limits the rate of events of each kind; suppressed events are counted.

A kind is an event with its argument where that is a code, and the event alone where it is a quantity: the
reports of a jittering clock, or of numbered restarts, are one kind.
"""

from typing import NamedTuple

from fsw.core.events import Event, Happening

QUANTITIES = frozenset(
    {
        Event.TIME_MISMATCH,
        Event.FILTER_STARTED,
        Event.FILTER_RESTARTED,
        Event.STRANGE_SYNC,
        Event.PLANT_RESTARTED,
        Event.FALSE_END,
    }
)
MOST_KINDS = 32
"""Kinds remembered at once; events of further kinds are suppressed."""


class LastReport(NamedTuple):
    """A kind of event, and the tick in which it was last reported."""

    event: int
    argument: int
    tick: int


class Throttle(NamedTuple):
    """The kinds reported recently, and the number of events suppressed since boot."""

    reported: tuple[LastReport, ...] = ()
    held_back: int = 0

    def integers(self) -> tuple[int, ...]:
        """For the checksum of the state."""
        return (*(number for report in self.reported for number in report), self.held_back)


def throttle_events(
    state: Throttle, happenings: list[Happening], tick: int, spacing_ticks: int
) -> tuple[Throttle, list[Happening]]:
    """The events that may be reported in this tick.

    Returns:
        The state with the reported kinds and the count, and the happenings to report, in their order.
    """
    if not happenings:
        return state, happenings
    reported = [kind for kind in state.reported if tick - kind.tick < spacing_ticks]
    recent = {(kind.event, kind.argument) for kind in reported}
    passed = []
    for happening in happenings:
        argument = 0 if happening.event in QUANTITIES else happening.argument
        kind = (int(happening.event), argument)
        if kind in recent or len(reported) >= MOST_KINDS:
            continue
        recent.add(kind)
        reported.append(LastReport(*kind, tick))
        passed.append(happening)
    return Throttle(tuple(reported), state.held_back + len(happenings) - len(passed)), passed
