"""A board on a simulated bench: the same conversation as over a bus, in simulated time."""

from collections import deque
from itertools import cycle

import pytest
from simulated_bus import SimulatedBus

from hil_stub.bench import Bench
from sim.conformance.board_link import BOARD_KINDS, BoardLink


class SlowBus(SimulatedBus):
    """A bus on which what a board says takes 60 ms, as from a busy computer."""

    def __init__(self, bench):
        self.on_the_way = deque()
        super().__init__(bench)

    def send(self, frames):
        super().send(frames)
        self.on_the_way.extend((self.now_s + 0.06, frame) for frame in self.queue)
        self.queue.clear()

    def receive(self, timeout_s):
        if self.queue:
            return super().receive(timeout_s)
        until_s = self.now_s + timeout_s
        if self.on_the_way and self.on_the_way[0][0] <= until_s:
            arrives_s, frame = self.on_the_way.popleft()
            super().receive(max(0.0, arrives_s - self.now_s))
            return frame
        return super().receive(timeout_s)


class BusyBus(SlowBus):
    """As a slow one, on a computer that is busy for 0.45 s now and then while it waits for an answer."""

    def __init__(self, bench):
        self.busy_s = cycle([0.45] + 22 * [0.0])
        super().__init__(bench)

    def receive(self, timeout_s):
        frame = super().receive(timeout_s)
        if timeout_s > 0.0:
            self.now_s += next(self.busy_s)
        return frame


@pytest.fixture
def slow_bus():
    return SlowBus


@pytest.fixture
def busy_bus():
    return BusyBus


@pytest.fixture
def link_to():
    """Makes a link to a board (made anew at each restart) in simulated time."""

    def make(
        make_board, tick_hz=1, kind="coil", deadman_ms=5000, has_clock=True, bench=Bench, bus=SimulatedBus
    ):
        link = bus(bench(make_board, deadman_ms, has_clock))
        return BoardLink(link, BOARD_KINDS[kind], tick_hz, clock=lambda: link.now_s)

    return make


@pytest.fixture(scope="session")
def failures():
    """What is wrong with a board, by the name of the check that has found it."""
    return lambda verdicts: {verdict.name: verdict.failure for verdict in verdicts if verdict.failure}
