"""When something has settled: what a flight shows of it, over all its ticks or block by block.

It has settled at the tick from which it holds without a gap to the end of the flight, if that is for
``HELD_S`` at least. What began to hold later has not been seen to stay. An error that comes back with the
orbit has to be seen for one: populations and comparisons ask for that.
"""

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from sim.value_types import Flags

HELD_S = 600.0
"""Time for which it must have held, to the end of the flight."""


def held_ticks(tick_hz: float, held_s: float = HELD_S) -> int:
    """This time in ticks, at least so long."""
    return ceil(held_s * tick_hz)


@dataclass(slots=True)
class Settling:
    """Of what holds or not at each tick of a flight, whose blocks come in order.

    Attributes:
        held_ticks: for so many ticks it must have held.
        since: the tick from which it has held so far; that after the last one where it does not hold.
        taken: ticks so far.
    """

    held_ticks: int
    since: int = 0
    taken: int = 0

    def take(self, holds: Flags) -> bool:
        """The next block; whether there is a tick in it where it does not hold."""
        broken = np.flatnonzero(~holds)
        if len(broken):
            self.since = self.taken + int(broken[-1]) + 1
        self.taken += len(holds)
        return len(broken) > 0

    @property
    def tick(self) -> int | None:
        """The tick at which it has settled, judged at the end of what was taken; None: it has not."""
        return self.since if self.taken - self.since >= self.held_ticks else None


def settled_tick(holds: Flags, tick_hz: float, held_s: float = HELD_S) -> int | None:
    """The tick at which it has settled, of a whole flight; None: it has not."""
    settling = Settling(held_ticks(tick_hz, held_s))
    settling.take(holds)
    return settling.tick


# --- Spans of ticks over which something holds


def spans(holds: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """The first tick of each span and the one past its last, in order."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], holds.astype(np.int8), [0]))))
    return [(int(first), int(past)) for first, past in zip(edges[::2], edges[1::2], strict=True)]
