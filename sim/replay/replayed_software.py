"""The flight software again, fed with the frames of a log."""

from collections import deque
from collections.abc import Callable, Iterator
from itertools import islice
from typing import NamedTuple

from fsw.core.config import FlightConfig
from fsw.core.state import FlightState
from fsw.node import FlightNode
from fsw.wire.frame import Frame
from fsw.wire.messages import Sync

OnTick = Callable[[FlightState], None]

MAX_ORDERS = 10_000
"""Orders of frames that are tried for one answer."""

MAX_REORDERED = 1024
"""Most frames that are stored for another order; beyond that, only the logged order counts."""

CHECKPOINT_FRAMES = 1000
"""Frames between copies of the node: a copy takes longer than a step."""


class ReplayedSoftware:
    """Answers the frames of a log as the flight software would.

    The log has the plant's own frames when they were sent and those of others when they arrived. On the bus
    they may have crossed: fsw may have received a stranger's frame before a SYNC that precedes it in the log.
    If the logged order does not explain the answer, strangers' frames are moved ahead until an order does.

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
        """The frames that fsw sends next, each with its tick."""
        self.ticks = 0
        """Ticks replayed."""
        self._checkpoint: FlightNode | None = None  # a copy of the node
        self._since: list[Frame] = []  # what it received after the copy and before the inputs
        self._ticks_before = 0  # ticks replayed before the inputs
        self._inputs: list[Frame] = []  # the frames that are being answered, as logged
        self._order: list[Frame] = []  # the same as the node received them
        self._answer: list[Frame] = []  # the logged frames of the answer

    @property
    def last_tick(self) -> int:
        """The tick that was answered last, -1 if there was none."""
        return self._node.state.tick

    def reboot(self) -> None:
        """Restart, as after a FSW_BOOT that the plant asked for again."""
        self._node.start()
        self._checkpoint = None

    def receive(self, frame: Frame) -> None:
        """Take a frame that fsw did not send."""
        if not self.expected and (self._answer or self._checkpoint is None):
            self._begin_answer()
        self._inputs.append(frame)
        self._order.append(frame)
        if len(self._inputs) > MAX_REORDERED:  # fsw was late for a long time
            self._checkpoint, self._inputs, self._order = None, [], []
        self._step(frame)

    def explains(self, frame: Frame) -> bool:
        """Whether fsw sends this logged frame next, in the logged order of inputs or in another."""
        self._answer.append(frame)
        if self.expected and self.expected[0][1] == frame:
            self.expected.popleft()
            return True
        return self._checkpoint is not None and self._reordered(self._node_before(self._checkpoint))

    def _begin_answer(self) -> None:
        """The next frame is the first that the next answer is to."""
        self._since += self._order
        if self._checkpoint is None or len(self._since) > CHECKPOINT_FRAMES:
            self._checkpoint, self._since = self._node.copy(), []
        self._ticks_before = self.ticks
        self._inputs, self._order, self._answer = [], [], []

    def _node_before(self, checkpoint: FlightNode) -> FlightNode:
        """The node before the inputs; it is the checkpoint from then on."""
        for frame in self._since:
            checkpoint.receive(frame)
        self._since = []
        return checkpoint

    def _step(self, frame: Frame) -> None:
        before = self._node.state.tick
        answer = self._node.receive(frame)
        self.expected.extend((self._node.state.tick, sent) for sent in answer)
        if self._node.state.tick != before:
            self.ticks += 1
            self._on_tick(self._node.state)

    def _reordered(self, before: FlightNode) -> bool:
        """Go on in another order, if one explains the answer so far; otherwise everything stays as it was."""
        logged_order = self._node, self.expected, self.ticks
        for order in islice(orders(self._inputs), MAX_ORDERS):
            self._node, self.expected, self.ticks = before.copy(), deque(), self._ticks_before
            for frame in order:
                self._step(frame)
            explained = [sent for _, sent in self.expected][: len(self._answer)]
            if explained == self._answer:
                for _ in explained:
                    self.expected.popleft()
                self._order = order
                return True
        self._node, self.expected, self.ticks = logged_order
        return False


def orders(inputs: list[Frame]) -> Iterator[list[Frame]]:
    """Orders in which frames may have arrived: the plant sent those up to a SYNC, and received the others.

    Both parts keep their own order. A frame of the plant that is no SYNC meets the others only in those of
    its own identifier and in their SYNCs: its place among the rest alters nothing on board. First come the
    orders in which the others, or the first of them, arrived together, then all. Which SYNC is the plant's is
    not known.
    """
    ends = [index + 1 for index, frame in enumerate(inputs) if frame.can_id == Sync.ID]
    parts = [(_runs(inputs[:end], inputs[end:]), inputs[end:]) for end in ends if end < len(inputs)]
    for runs, others in parts:
        for place in reversed(range(len(runs))):
            for count in range(1, len(others) + 1):
                yield _merged(runs, others, (0,) * place + (count,) * (len(runs) - place))
    for runs, others in parts:
        for counts in _rising([run.counts for run in runs], len(others)):
            yield _merged(runs, others, counts)


class _Run(NamedTuple):
    """Sent frames, of which the last alone meets others; of how many these it may have been preceded."""

    frames: list[Frame]
    counts: list[int]


def _runs(sent: list[Frame], others: list[Frame]) -> list[_Run]:
    """The sent frames, up to their SYNC, in runs."""
    runs = []
    begin = 0
    for end, frame in enumerate(sent, 1):
        met = {frame.can_id, Sync.ID}
        counts = [
            count for count, other in enumerate(others, 1) if frame.can_id == Sync.ID or other.can_id in met
        ]
        if counts:
            runs.append(_Run(sent[begin:end], [0, *counts]))
            begin = end
    return runs


def _rising(choices: list[list[int]], most: int) -> Iterator[tuple[int, ...]]:
    """All picks of one number from each list that never fall, and end at ``most`` or below it."""
    if not choices:
        yield ()
        return
    for last in choices[-1]:
        if last <= most:
            for before in _rising(choices[:-1], last):
                yield (*before, last)


def _merged(runs: list[_Run], others: list[Frame], counts: tuple[int, ...]) -> list[Frame]:
    """The frames in one order: each run after so many of the others."""
    order: list[Frame] = []
    begun = 0
    for run, count in zip(runs, counts, strict=True):
        order += [*others[begun:count], *run.frames]
        begun = count
    return order + others[begun:]
