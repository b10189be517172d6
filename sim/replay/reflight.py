"""The flight software again, fed with what a log says that it has heard."""

from collections import deque
from collections.abc import Callable, Iterator
from itertools import combinations_with_replacement, islice

from fsw.core.config import FlightConfig
from fsw.core.state import FlightState
from fsw.node import FlightNode
from fsw.wire.frame import Frame
from fsw.wire.messages import Sync

OnTick = Callable[[FlightState], None]

MOST_ORDERS = 1000
"""Orders that are tried for one answer."""

MOST_KEPT = 1024
"""Frames that are kept for another order; where there are more, the logged one is what counts."""


class Reflight:
    """Says what fsw says to the frames of a log.

    The log has the plant's own frames when they were sent and those of others when they came, and on the bus
    they may have met: a stranger's frame that stands behind a SYNC may have come to fsw before it. The answer
    tells. Where the logged order does not explain it, strangers' frames are moved ahead until an order does.

    Args:
        config: what the flight software flew with.
        on_tick: called with the state after every tick, once more where another order explains it.
    """

    def __init__(self, config: FlightConfig, on_tick: OnTick = lambda state: None) -> None:
        self._node = FlightNode(config)
        self._on_tick = on_tick
        self.boot = self._node.start()
        """FSW_BOOT."""
        self.expected: deque[tuple[int, Frame]] = deque([(0, self.boot)])
        """What fsw says next, with the tick of it."""
        self.ticks = 0
        """Ticks flown."""
        self._before: FlightNode | None = None  # as it was before what is being answered
        self._ticks_before = 0
        self._heard: list[Frame] = []  # what is being answered
        self._said: list[Frame] = []  # what the log has of the answer

    @property
    def last_tick(self) -> int:
        """The tick that was answered last, -1 if there was none."""
        return self._node.state.tick

    def reboot(self) -> None:
        """FSW_BOOT that was asked for once more: nothing is left of what was before."""
        self._node.start()

    def hear(self, frame: Frame) -> None:
        """A frame that is not fsw's."""
        if not self.expected and (self._said or self._before is None):
            self._before, self._ticks_before = self._node.copy(), self.ticks
            self._heard, self._said = [], []
        self._heard.append(frame)
        if len(self._heard) > MOST_KEPT:  # as of an fsw that is late for long
            self._before, self._heard = None, []
        self._receive(frame)

    def explains(self, frame: Frame) -> bool:
        """Whether the next that fsw says is this frame of the log, in the logged order or in another."""
        self._said.append(frame)
        if self.expected and self.expected[0][1] == frame:
            self.expected.popleft()
            return True
        return self._before is not None and self._reordered(self._before)

    def _receive(self, frame: Frame) -> None:
        before = self._node.state.tick
        answer = self._node.receive(frame)
        self.expected.extend((self._node.state.tick, said) for said in answer)
        if self._node.state.tick != before:
            self.ticks += 1
            self._on_tick(self._node.state)

    def _reordered(self, before: FlightNode) -> bool:
        """Go on in another order, if one explains all that was said; else everything stays as it was."""
        kept = self._node, self.expected, self.ticks
        for order in islice(orders(self._heard), MOST_ORDERS):
            self._node, self.expected, self.ticks = before.copy(), deque(), self._ticks_before
            for frame in order:
                self._receive(frame)
            explained = [said for _, said in self.expected][: len(self._said)]
            if explained == self._said:
                for _ in explained:
                    self.expected.popleft()
                return True
        self._node, self.expected, self.ticks = kept
        return False


def orders(heard: list[Frame]) -> Iterator[list[Frame]]:
    """Orders in which frames may have come: the plant has sent those up to a SYNC, and heard the others.

    First those in which the others, or the first of them, came together, just before that SYNC or sooner;
    then all in which both parts keep their own order. Which SYNC is the plant's is not known.
    """
    ends = [index + 1 for index, frame in enumerate(heard) if frame.can_id == Sync.ID]
    parts = [(heard[:end], heard[end:]) for end in ends if end < len(heard)]
    for sent, others in parts:
        for place in range(len(sent) - 1, -1, -1):
            for count in range(1, len(others) + 1):
                yield [*sent[:place], *others[:count], *sent[place:], *others[count:]]
    for sent, others in parts:
        for places in combinations_with_replacement(range(len(sent), -1, -1), len(others)):
            yield _merged(sent, others, places[::-1])


def _merged(sent: list[Frame], others: list[Frame], places: tuple[int, ...]) -> list[Frame]:
    """Each of the others in its place among what was sent."""
    order: list[Frame] = []
    begun = 0
    for other, place in zip(others, places, strict=True):
        order += [*sent[begun:place], other]
        begun = place
    return order + sent[begun:]
