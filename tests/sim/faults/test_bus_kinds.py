"""Faults of the bus: frames are altered, added and lost."""

from collections import Counter
from itertools import groupby
from random import Random

import pytest

from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import (
    CLASSES,
    SENDERS,
    CoilFire,
    MagField,
    PlantEnd,
    SunCells,
    SunVector,
    Sync,
    TickDone,
    intact,
)
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


def test_duplicates_follow_their_frame_as_often_as_they_are_to():
    doubling = fault("duplicates", part=0.2)
    come = [doubling.from_boards(tick, list(FRAMES)) for tick in range(1500)]
    assert sum(map(len, come)) / 4500 == pytest.approx(1.2, abs=0.02)
    for frames in come:
        assert [
            frame for frame, before in zip(frames, [None, *frames], strict=False) if frame != before
        ] == FRAMES


def test_every_order_comes():
    reordering = fault("reordering")
    orders = {tuple(reordering.to_boards(tick, list(FRAMES))) for tick in range(200)}
    assert len(orders) == 6
    assert all(Counter(order) == Counter(FRAMES) for order in orders)


def test_corruption_reaches_every_bit_of_the_data_and_no_identifier():
    frame = FRAMES[0]
    whole, flipped = int.from_bytes(frame.data, "little"), 0
    for seed in range(400):
        (broken,) = fault("corruption", seed, part=1.0).to_boards(0, [frame])
        flipped |= int.from_bytes(broken.data, "little") ^ whole
        assert broken.can_id == frame.can_id
    assert flipped == (1 << 8 * len(frame.data)) - 1


@pytest.mark.parametrize("kind", ["loss", "corruption", "wrong_length", "unknown_id", "rtr", "duplicates"])
def test_both_directions_are_tampered_with_alike(kind):
    assert fault(kind, part=1.0).to_boards(0, list(FRAMES)) == fault(kind, part=1.0).from_boards(
        0, list(FRAMES)
    )


@pytest.mark.parametrize("kind", ["rtr", "extended_id", "error_frames"])
def test_a_flag_leaves_the_identifier_and_only_a_remote_frame_has_no_data(kind):
    for frame, flagged in zip(FRAMES, fault(kind, part=1.0).from_boards(0, list(FRAMES)), strict=True):
        assert flagged.can_id & 0x7FF == frame.can_id
        assert flagged.data == (b"" if kind == "rtr" else frame.data)


def test_bursts_shut_both_directions_together_for_no_longer_than_they_say():
    bursts, opened = fault("bursts", ticks=5.0), []
    for tick in range(500):
        inward, outward = bursts.from_boards(tick, list(FRAMES)), bursts.to_boards(tick, list(FRAMES))
        assert inward == outward
        assert inward in ([], FRAMES)
        opened.append(bool(inward))
    stretches = [(is_open, len(list(ticks))) for is_open, ticks in groupby(opened)][:-1]
    lengths = {state: {n for one, n in stretches if one is state} for state in (True, False)}
    assert not opened[0]
    assert lengths == {True: {1, 2, 3, 4, 5}, False: {1, 2, 3, 4, 5}}


def test_with_jitter_a_frame_is_late_by_none_to_as_many_ticks_as_it_says():
    late = fault("delay", ticks=3.0, jitter=1.0)
    late_by = {
        tick - frame.can_id for tick in range(400) for frame in late.to_boards(tick, [Frame(tick, b"")])
    }
    assert late_by == {0, 1, 2, 3}


def test_an_unknown_identifier_is_none_of_the_contract():
    come = [f for seed in range(100) for f in fault("unknown_id", seed, part=1.0).to_boards(0, FRAMES)]
    assert not {frame.can_id for frame in come} & set(CLASSES)
    assert [frame.data for frame in come] == [frame.data for frame in FRAMES] * 100


def test_a_delay_keeps_the_directions_apart():
    late = fault("delay", ticks=1.0)
    inward, outward = FRAMES[:1], FRAMES[2:]
    assert late.from_boards(0, inward) == late.to_boards(0, outward) == []
    assert late.from_boards(1, []) == inward
    assert late.to_boards(1, []) == outward


def test_a_full_queue_loses_all_to_none():
    full = fault("queue_full")
    assert {len(full.to_boards(tick, list(FRAMES))) for tick in range(100)} == {0, 1, 2, 3}
    assert full.from_boards(0, list(FRAMES)) == FRAMES


def test_where_the_link_is_down_nothing_passes():
    down, sync = fault("link_down"), Sync(3, 7).encode()
    assert down.from_boards(3, list(FRAMES)) == down.to_boards(3, list(FRAMES)) == down.sync(3, sync) == []


@pytest.mark.parametrize("as_fsw", [0.0, 1.0])
def test_a_stranger_uses_the_identifiers_of_the_flight_software_only_where_it_may(as_fsw):
    noise = fault("random_frames", frames=400.0, as_fsw=as_fsw)
    come = [frame for tick in range(20) for frame in noise.strangers(tick)]
    assert len(come) == 8000
    senders = {SENDERS.get(frame.can_id) for frame in come}
    assert ("FSW" in senders) is bool(as_fsw)
    assert {"COIL", "MAG", "GROUND"} < senders
    assert {flag for flag in (ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG) for f in come if f.can_id & flag} == {
        ERROR_FLAG,
        EXTENDED_FLAG,
        REMOTE_FLAG,
    }


def test_a_babbling_node_sends_as_much_as_it_says_ahead_of_all_others():
    frames = fault("flood", frames=70.0).strangers(4)
    assert len(frames) == 70
    assert all(frame.can_id < min(CLASSES) for frame in frames)


def test_forged_requests_answer_their_tick_some_within_the_limits_and_some_not():
    forger = fault("second_sender", frames=2.0)
    asked = [(tick, CoilFire.decode(f.data)) for tick in range(600) for f in forger.strangers(tick)]
    assert [tick for tick, _ in asked] == [tick for tick in range(600) for _ in range(2)]
    assert all(request.tick == tick & 0xFF for tick, request in asked)
    assert {request.coil for _, request in asked} == {0, 1, 2}
    assert {request.level for _, request in asked} == {-3, -2, -1, 1, 2, 3}
    assert {request.duration_ms <= 3000 for _, request in asked} == {True, False}


@pytest.mark.parametrize(("kind", "usual"), [("sync_forged", 1), ("done_forged", 1)])
@pytest.mark.parametrize("part", [0.0, 0.25, 1.0])
def test_forged_frames_come_as_often_as_they_are_to(kind, usual, part):
    forger = fault(kind, part=part)
    come = sum(len(forger.strangers(tick)) for tick in range(2000))
    assert come / 2000 == pytest.approx(usual * part, abs=0.03)
