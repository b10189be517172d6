"""Events no more often than once a time for each kind; what is held back is counted.

A kind is an event with its argument where that is a code, and the event alone where it is a quantity: a clock
that jitters, or restarts that number themselves, are one kind.
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
"""Kinds remembered at once; beyond, events are held back."""


class LastReport(NamedTuple):
    """A kind, and the tick in which it was last told."""

    event: int
    argument: int
    tick: int


class Throttle(NamedTuple):
    """The kinds told of late, and how many events were held back since boot."""

    reported: tuple[LastReport, ...] = ()
    held_back: int = 0

    def integers(self) -> tuple[int, ...]:
        """For the checksum of the state."""
        return (*(number for told in self.reported for number in told), self.held_back)


def throttle_events(
    state: Throttle, happenings: list[Happening], tick: int, spacing_ticks: int
) -> tuple[Throttle, list[Happening]]:
    """What may be told in this tick.

    Returns:
        The state with what was told and held back, and the happenings to tell, in their order.
    """
    if not happenings:
        return state, happenings
    told = [kind for kind in state.reported if tick - kind.tick < spacing_ticks]
    known = {(kind.event, kind.argument) for kind in told}
    passed = []
    for happening in happenings:
        argument = 0 if happening.event in QUANTITIES else happening.argument
        kind = (int(happening.event), argument)
        if kind in known or len(told) >= MOST_KINDS:
            continue
        known.add(kind)
        told.append(LastReport(*kind, tick))
        passed.append(happening)
    return Throttle(tuple(told), state.held_back + len(happenings) - len(passed)), passed
