"""Faults of the bus: frames are altered, added and lost."""

from random import Random

import pytest

from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import CoilFire, MagField, PlantEnd, SunCells, SunVector, Sync, TickDone, intact
from sim.faults import kinds
from sim.faults.kinds import KINDS, make

FRAMES = [
    MagField(1, 20000.0, -7000.0, 31000.0, 3).encode(),
    SunVector(1, 0.6, -0.64, 0.48, 3).encode(),
    CoilFire(-3, 2, 7, 200, 3000, 1).encode(),
]


def fault(kind, seed=1, **parameters):
    return make(kind, parameters, Random(seed))


@pytest.mark.parametrize("kind", KINDS)
def test_same_seed_same_fault(kind):
    one, other = fault(kind), fault(kind)
    for tick in range(30):
        assert one.from_boards(tick, list(FRAMES)) == other.from_boards(tick, list(FRAMES))
        assert one.strangers(tick) == other.strangers(tick)
        assert one.to_boards(tick, list(FRAMES)) == other.to_boards(tick, list(FRAMES))
        assert one.condition(tick) == other.condition(tick)


@pytest.mark.parametrize("part", [0.01, 0.1, 0.5])
def test_loss_loses_its_part(part):
    lossy = fault("loss", part=part)
    left = sum(len(lossy.from_boards(tick, list(FRAMES))) for tick in range(4000))
    assert left / 12000 == pytest.approx(1.0 - part, abs=0.015)


@pytest.mark.parametrize(
    "kind", ["corruption", "wrong_length", "unknown_id", "rtr", "extended_id", "error_frames"]
)
def test_broken_frames_are_broken(kind):
    broken = [
        frame for seed in range(200) for frame in fault(kind, seed, part=1.0).from_boards(0, list(FRAMES))
    ]
    assert not any(frame in FRAMES for frame in broken) or kind == "corruption"
    passed = sum(intact(frame) for frame in broken)
    assert passed <= (0.02 * len(broken) if kind == "corruption" else 0)


@pytest.mark.parametrize("first", ["rtr", "wrong_length", "random_frames"])
def test_frames_that_another_fault_has_left_without_data_are_not_corrupted(first):
    emptied, corrupting = fault(first), fault("corruption", part=1.0)
    for tick in range(100):
        frames = [*emptied.from_boards(tick, list(FRAMES)), *emptied.strangers(tick)]
        come = corrupting.from_boards(tick, frames)
        assert [len(frame.data) for frame in come] == [len(frame.data) for frame in frames]
        assert [f for f in come if not f.data] == [f for f in frames if not f.data]


@pytest.mark.parametrize(
    ("kind", "flag"), [("rtr", REMOTE_FLAG), ("extended_id", EXTENDED_FLAG), ("error_frames", ERROR_FLAG)]
)
def test_flags_are_those_of_socketcan(kind, flag):
    assert all(frame.can_id & flag for frame in fault(kind, part=1.0).to_boards(0, list(FRAMES)))


def test_late_frames_all_come_and_none_early():
    late = fault("delay", ticks=2.0)
    come = [late.to_boards(tick, [Frame(tick, b"")]) for tick in range(10)]
    assert come[:2] == [[], []]
    assert [frames[0].can_id for frames in come[2:]] == list(range(8))


def test_jitter_loses_nothing():
    late = fault("delay", ticks=3.0, jitter=1.0)
    come = [
        frame.can_id
        for tick in range(50)
        for frame in late.from_boards(tick, [Frame(tick, b"")] * (tick < 40))
    ]
    assert sorted(come) == list(range(40))
    assert come != sorted(come)


@pytest.mark.parametrize(("kind", "sample"), [("mag_late", 0), ("sun_late", 1), ("cells_late", 2)])
def test_late_samples_are_those_of_one_sensor_in_their_order(kind, sample):
    late = fault(kind, ticks=3.0)
    numbers = []
    for tick in range(10):
        frames = [
            MagField(1, 20000.0, -7000.0, 31000.0, tick),
            SunVector(1, 0.6, -0.64, 0.48, tick),
            SunCells(1, 0.5, 0.25, 0.0, 1.0, 0.125, 1.5, tick),
        ]
        come = late.from_boards(tick, [frame.encode() for frame in frames])
        delayed = frames.pop(sample)
        assert all(other.encode() in come for other in frames)
        assert late.to_boards(tick, list(FRAMES)) == FRAMES
        numbers += [type(delayed).decode(f.data).counter for f in come if f.can_id == delayed.ID]
    assert numbers == list(range(7))


def test_a_queue_that_is_full_keeps_the_first_frames():
    full = fault("queue_full")
    for tick in range(50):
        left = full.to_boards(tick, list(FRAMES))
        assert left == FRAMES[: len(left)]


def test_random_frames_never_are_a_sync():
    noise = fault("random_frames", frames=2000.0)
    assert not any(
        frame.can_id == 0x180 and intact(frame) for tick in range(5) for frame in noise.strangers(tick)
    )


def test_every_default_is_in_its_range():
    for kind in kinds.KINDS.values():
        for parameter in kind.parameters.values():
            assert parameter.low <= parameter.default <= parameter.high


class TestForged:
    @pytest.mark.parametrize(("step", "count"), [(0.0, 2), (1.0, 1), (1.0, 5)])
    @pytest.mark.parametrize("ticks", [0.0, 50.0, -500.0, 1e9])
    def test_syncs_are_off_by_the_parameters(self, ticks, step, count):
        forger = fault("sync_forged", ticks=ticks, count=float(count), step=step)
        for tick in (0, 1000):
            forged = [Sync.decode(frame.data).tick for frame in forger.strangers(tick)]
            assert forged == [forged[0] + round(step) * i for i in range(count)]
            assert ticks == 0.0 or forged[0] == max(0, tick + round(ticks))

    def test_an_end_never_fits(self):
        forger = fault("end_forged")
        for tick in range(3000):
            (frame,) = forger.strangers(tick)
            assert intact(frame)
            assert 100 <= (PlantEnd.decode(frame.data).ticks - tick) % 2**24 < 2**24 - 100

    def test_an_answer_names_the_tick(self):
        assert [TickDone.decode(f.data).tick for f in fault("done_forged").strangers(77)] == [77]
