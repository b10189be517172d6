"""What a bench in real time measures of the frames that it receives."""

import time

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import Sync, TickDone
from sim.bench.command import NoLog
from sim.bench.realtime_loop import RealtimeLoop
from sim.bench.tick_source import SyncOnly

pytestmark = pytest.mark.long

TICKS, TICK_HZ = 3, 100


class AnsweredBus:
    """A bus on which each SYNC is answered by the frames that ``answer`` makes of its tick."""

    name = "made up"

    def __init__(self, answer):
        self.answer = answer
        self.waiting = []

    def send(self, frames):
        ticks = [Sync.decode(frame.data).tick for frame in frames if frame.can_id == Sync.ID]
        self.waiting += [frame for tick in ticks for frame in self.answer(tick)]

    def receive(self, timeout_s):
        if not self.waiting:
            time.sleep(timeout_s)
            return None
        return self.waiting.pop(0)


def whole(tick):
    return [TickDone(tick, 0).encode()]


def too_long(tick):
    return [Frame(TickDone.ID, TickDone(tick, 0).encode().data + b"\x00")]


def cut(tick):
    return [Frame(TickDone.ID, TickDone(tick, 0).encode().data[:1])]


@pytest.mark.parametrize(
    ("answer", "slips"), [(whole, 0), (too_long, TICKS), (cut, TICKS)], ids=["whole", "too long", "cut"]
)
def test_an_answer_counts_only_if_its_frame_is_whole(answer, slips):
    loop = RealtimeLoop(AnsweredBus(answer), SyncOnly(0, TICK_HZ), NoLog(), 0, TICK_HZ)
    measured = loop.run(TICKS)
    assert (measured.ticks, measured.slips) == (TICKS, slips)
    assert measured.latency.quantile(0.5) == float("inf") if slips else measured.latency.quantile(0.5) > 0.0


class HeldUpBus(AnsweredBus):
    """One whose host is held up once, past the next SYNC: the answer came in time, and waits to be read."""

    def receive(self, timeout_s):
        if self.waiting and timeout_s > 0.0:
            time.sleep(1.5 / TICK_HZ)
            return None
        return super().receive(timeout_s)


class FramesInOrder:
    """A log that keeps the frames in order."""

    def __init__(self):
        self.frames = []

    def write(self, _, frames):
        self.frames += frames


def test_what_came_while_the_bench_was_held_up_stands_before_the_sync_that_followed_it():
    log = FramesInOrder()
    measured = RealtimeLoop(HeldUpBus(whole), SyncOnly(0, TICK_HZ), log, 0, TICK_HZ).run(TICKS)
    kinds = [frame.can_id for frame in log.frames if frame.can_id in (Sync.ID, TickDone.ID)]
    assert kinds == [Sync.ID, TickDone.ID] * TICKS
    assert measured.slips == 0
