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

from enum import Enum, auto
from typing import NamedTuple

LEAP_S = 60
"""A SYNC no further ahead is believed at once: those between were lost. A new count settles in as long."""

FEW_TICKS = 5
"""Lost in a row they leave no doubt about the time: were the skip forged, field and Sun would hardly be
others, and the next two SYNCs of the plant would show it."""

MOST_DOUBTED = 64
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


class SyncWatch(NamedTuple):
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


def judge(watch: SyncWatch, current: int, tick: int, leap_ticks: int) -> tuple[Belief, SyncWatch]:
    """How a SYNC is judged, and the watch after it.

    Args:
        watch: SYNCs in doubt before it.
        current: the tick that was answered last; -1: none yet, and any is believed.
        tick: the one that SYNC names.
        leap_ticks: ``LEAP_S``.
    """
    if current < 0:
        return Belief.NEXT, watch
    if near(current, tick, leap_ticks):
        return Belief.NEXT, _gone_on(watch, current, tick, leap_ticks)
    if tick == current:
        if tick in watch.doubted:
            return Belief.UNANSWERED, watch._replace(doubted=_without(watch.doubted, tick))
        return Belief.IGNORED, watch._replace(doubted=_with(watch.doubted, tick))
    if tick in watch.doubted or tick - 1 in watch.doubted:
        doubted = _with(_without(watch.doubted, tick, tick - 1), current)
        settled_tick = tick + leap_ticks
        return Belief.RESTARTED, SyncWatch(doubted, settled_tick, timed_tick=settled_tick)
    return Belief.IGNORED, watch._replace(doubted=_with(watch.doubted, tick), strange_tick=tick)


def near(current: int, tick: int, leap_ticks: int) -> bool:
    """Whether a tick is ahead of the current one, and not by more than ``leap_ticks``."""
    return current < tick <= current + leap_ticks


def _gone_on(watch: SyncWatch, current: int, tick: int, leap_ticks: int) -> SyncWatch:
    """The watch after a tick not far ahead: a skip may come from a forged SYNC.

    A duplicate of the tick before, which an answer that was lost would have repeated, is then nothing more.
    """
    if current in watch.doubted:
        watch = watch._replace(doubted=_without(watch.doubted, current))
    if tick > current + 1:
        settled_tick = tick + leap_ticks
        timed_tick = watch.timed_tick if tick <= current + 1 + FEW_TICKS else settled_tick
        return watch._replace(settled_tick=settled_tick, timed_tick=timed_tick)
    return watch._replace(doubted=()) if watch.doubted and current >= watch.settled_tick else watch


def _with(doubted: tuple[int, ...], tick: int) -> tuple[int, ...]:
    return (*_without(doubted, tick), tick)[-MOST_DOUBTED:]


def _without(doubted: tuple[int, ...], *ticks: int) -> tuple[int, ...]:
    return tuple(other for other in doubted if other not in ticks)
