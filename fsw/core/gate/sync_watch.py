"""Which SYNC is believed: time comes over the bus, and the bus may lie.

A SYNC of a tick not far ahead is believed at once. One of the tick that was answered last is a duplicate, or
comes from a plant that did not receive the answer and repeats it. Any other is strange. One strange SYNC
changes nothing; a second one that names the same tick or the next one means that the plant has restarted:
in lockstep it repeats its SYNC until it is answered, in real time it goes on.

Others may come between the two. What is in doubt is forgotten when a settled count advances by a tick, so
that strange SYNCs between true ones never add up. A count that has skipped or restarted settles in
``LEAP_S``; until then the one that was abandoned for it may be believed again. Of two plants that both
advance tick by tick, nothing here can decide which is the false one.

Whether the time is in doubt is another matter: a bus that loses a SYNC now and then shows the right one.
"""

from dataclasses import dataclass
from enum import Enum, auto
from typing import Final, final

LEAP_S: Final = 60
"""A SYNC no further ahead is believed at once: those between were lost. A new count settles in as long."""

FEW_TICKS: Final = 5
"""Lost in a row they leave no doubt about the time: were the skip forged, field and Sun would hardly be
others, and the next two SYNCs of the plant would show it."""

MOST_DOUBTED: Final = 64
"""How many ticks are remembered as in doubt, the latest."""


class Belief(Enum):
    """How a SYNC is judged."""

    IGNORED = auto()
    UNANSWERED = auto()
    """Of the tick that was answered, repeatedly: the answer was not received."""
    NEXT = auto()
    """The next tick; where SYNCs were lost, one not far ahead."""
    RESTARTED = auto()
    """A tick of a plant that has restarted."""


@final
@dataclass(slots=True)
class SyncWatch:
    """SYNCs in doubt.

    ``doubted``: their ticks, the latest last; ``settled_tick``: the count is settled from here on;
    ``strange_tick``: the latest strange one that has not been reported yet, -1 if there is none;
    ``timed_tick``: the time is no longer in doubt from here on.
    """

    doubted: tuple[int, ...] = ()
    settled_tick: int = 0
    strange_tick: int = -1
    timed_tick: int = 0

    def settled(self, tick: int) -> bool:
        """Whether field and Sun are those of the time: no restart, and no long skip, lately."""
        return tick >= self.timed_tick


def judge_sync(watch: SyncWatch, current: int, tick: int, leap_ticks: int) -> Belief:
    """How a SYNC is judged.

    Args:
        watch: SYNCs in doubt, with this one afterwards.
        current: the tick that was answered last; -1: none yet, and any is believed.
        tick: the one that SYNC names.
        leap_ticks: ``LEAP_S``.
    """
    if current < 0:
        return Belief.NEXT
    if near(current, tick, leap_ticks):
        _go_on(watch, current, tick, leap_ticks)
        return Belief.NEXT
    repeated = tick in watch.doubted
    if tick == current:
        if repeated:
            _trust(watch, tick)
            return Belief.UNANSWERED
        _doubt(watch, tick)
        return Belief.IGNORED
    if repeated or tick - 1 in watch.doubted:
        _trust(watch, tick)
        _trust(watch, tick - 1)
        _doubt(watch, current)
        watch.settled_tick = watch.timed_tick = tick + leap_ticks
        watch.strange_tick = -1
        return Belief.RESTARTED
    _doubt(watch, tick)
    watch.strange_tick = tick
    return Belief.IGNORED


def near(current: int, tick: int, leap_ticks: int) -> bool:
    """Whether a tick is ahead of the current one, and not by more than ``leap_ticks``."""
    return current < tick <= current + leap_ticks


def _go_on(watch: SyncWatch, current: int, tick: int, leap_ticks: int) -> None:
    """A tick not far ahead is believed: a skip may come from a forged SYNC.

    A duplicate of the tick before, which an answer that was lost would have repeated, is then nothing more.
    """
    _trust(watch, current)
    if tick > current + 1:
        watch.settled_tick = tick + leap_ticks
        if tick > current + 1 + FEW_TICKS:
            watch.timed_tick = watch.settled_tick
    elif watch.doubted and current >= watch.settled_tick:
        watch.doubted = ()


def _doubt(watch: SyncWatch, tick: int) -> None:
    _trust(watch, tick)
    watch.doubted = (*watch.doubted, tick)[-MOST_DOUBTED:]


def _trust(watch: SyncWatch, tick: int) -> None:
    if tick in watch.doubted:
        watch.doubted = tuple([other for other in watch.doubted if other != tick])
