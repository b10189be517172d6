"""What a bench in real time measures of the frames that it receives."""

import random
import time

import pytest

from fsw.wire.frame import Frame
from fsw.wire.messages import Sync, TickDone
from sim.bench.command import NoLog
from sim.bench.realtime_loop import RealtimeLoop, TimeHistogram
from sim.bench.tick_source import SyncOnly

PARTS = (0.0, 0.5, 0.9, 0.99, 1.0)


def ranked(seconds, part):
    return sorted(seconds)[min(len(seconds) - 1, int(part * len(seconds)))]


@pytest.mark.parametrize("number", [1, 2, 3, 99, 1000])
def test_quantiles_are_true_to_a_hundredth_and_never_too_small(number):
    stream = random.Random(number)
    seconds = [stream.lognormvariate(-6.0, 2.0) for _ in range(number)]
    times = TimeHistogram(seconds)
    for part in PARTS:
        exact = ranked(seconds, part)
        assert exact * (1.0 - 1e-12) <= times.quantile(part) <= exact * 1.01


def test_the_longest_is_exact_however_long_and_nothing_is_too_short():
    assert TimeHistogram([1e-3, 7.654321e3]).quantile(1.0) == 7.654321e3
    assert TimeHistogram([0.0]).quantile(0.5) == 0.0
    assert TimeHistogram([2e-9, 1e-3]).quantile(0.0) <= 1e-6


def test_where_nothing_was_counted_no_budget_is_kept():
    assert [TimeHistogram().quantile(part) for part in PARTS] == [float("inf")] * len(PARTS)


def test_they_take_no_more_memory_the_more_there_are():
    stream, times = random.Random(1), TimeHistogram()
    for _ in range(20_000):
        times.add(stream.uniform(1e-4, 1e-1))
    assert len(times._counts) < 750


# --- What a bench in real time measures of the frames that it receives

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


@pytest.mark.long
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
