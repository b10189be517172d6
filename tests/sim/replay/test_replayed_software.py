"""Runs with frames of strangers replay bit-exact, wherever these crossed those of the plant."""

from dataclasses import dataclass
from itertools import islice
from random import Random

import pytest

from fsw.core.packing import copy_state
from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.candump_line import format_line, format_time
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilStatus, FswEvent, MagField, PlantEnd, SunVector, Sync, TickDone
from sim.flight import fsw_answers
from sim.flight.record_flight import record_flight
from sim.flight.virtual_bus import VirtualBus
from sim.record import run_dir
from sim.record.candump import read_log
from sim.record.pace import Pace
from sim.record.run_dir import BUS_LOG
from sim.replay.log_replay import replay
from sim.replay.replayed_software import MAX_ORDERS, orders
from sim.report.conclude import conclude
from sim.scenario.schema import flight_table, load

TICKS = 250
FAR = 10**9


class RacingBus(VirtualBus):
    """A stranger's frames meet the plant's frames of each tick, at every place."""

    def __init__(self, node, frames_of, seed=3):
        super().__init__(node)
        self.random, self.frames_of, self.count = Random(seed), frames_of, 0

    def send(self, frames):
        strangers = self.frames_of(self.random)
        places = sorted(self.random.randrange(len(frames) + 1) for _ in strangers)
        for place, frame in enumerate([*frames, None]):
            while places and places[0] == place:
                places.pop(0)
                self.count += 1
                stranger = strangers.pop(0)
                self._queue.append(stranger)
                super().send([stranger])
            if frame is not None:
                super().send([frame])


def sync(tick):
    return Sync(tick % 2**32, 77).encode()


@dataclass
class CountingStranger:
    """Counts on tick by tick from ``FAR``, in a part of the ticks."""

    part: float
    tick: int = FAR

    def __call__(self, random):
        if random.random() > self.part:
            return []
        self.tick += 1
        return [sync(self.tick)]


def seldom(frames_of):
    return lambda random: frames_of(random) if random.random() < 0.05 else []


STRANGERS = {
    "one strange SYNC": seldom(lambda random: [sync(random.getrandbits(32))]),
    "one in each tick": lambda random: [sync(random.getrandbits(32))],
    "one that goes on": CountingStranger(0.5),
    "pairs": seldom(lambda random: [sync(x := random.getrandbits(32)), sync(x + 1)]),
    "equal pairs": seldom(lambda random: [sync(random.getrandbits(32))] * 2),
    "ends": seldom(lambda random: [PlantEnd(random.getrandbits(24), counter=random.getrandbits(4)).encode()]),
    "frames as the plant sends them, broken": lambda random: (
        [Frame(can_id, b"\0") for can_id in (MagField.ID, SunVector.ID, CoilStatus.ID)] * random.randrange(9)
    ),
    "noise": lambda random: (
        [Frame(random.getrandbits(11) | 0x700, random.randbytes(8))] * random.randrange(3)
    ),
}


@pytest.fixture
def fly_with(tmp_path, monkeypatch):
    """A flight with a stranger: its bus and configuration; the log is in the run directory."""
    monkeypatch.setattr(fsw_answers, "REPEAT_SYNC_S", 0.01)

    def fly(frames_of, ticks=TICKS):
        scenario = load("microsat")
        run_dir.begin(tmp_path, scenario, 5, ticks, "virtual", Pace())
        config = flight_config(flight_table(scenario))
        bus = RacingBus(FlightNode(config), frames_of)
        record_flight(tmp_path, scenario, bus)
        return bus, config

    return fly


@pytest.mark.parametrize("frames_of", STRANGERS.values(), ids=STRANGERS)
@pytest.mark.interpreted
def test_replays_bit_exact(tmp_path, fly_with, frames_of):
    bus, config = fly_with(frames_of)
    states = []
    result = replay(tmp_path / BUS_LOG, config, lambda state: states.append(copy_state(state)))
    assert bus.count > 5
    assert result.bit_exact, result.first_bit_difference
    assert result.ended
    done = [e.frame for e in read_log(tmp_path / BUS_LOG) if e.frame.can_id == TickDone.ID]
    assert {TickDone.decode(frame.data).tick for frame in done} >= set(range(TICKS))


@pytest.mark.interpreted
def test_a_run_that_strangers_disturbed_is_concluded_too(tmp_path, fly_with):
    fly_with(STRANGERS["pairs"])
    summary = conclude(tmp_path)
    assert summary["replay"]["bit_exact"]
    assert run_dir.read_run(tmp_path)["complete"] is True


@pytest.mark.interpreted
def test_the_order_that_is_found_explains_an_altered_frame_no_more_than_the_logged_one(tmp_path, fly_with):
    _, config = fly_with(STRANGERS["one in each tick"])
    entries = list(read_log(tmp_path / BUS_LOG))
    events = [i for i, e in enumerate(entries) if e.frame.can_id == FswEvent.ID]
    for index in (events[3], events[-1]):
        event = FswEvent.decode(entries[index].frame.data)
        altered = entries[index]._replace(frame=event.replace(argument=event.argument ^ 4).encode())
        lines = [*entries[:index], altered, *entries[index + 1 :]]
        log = tmp_path / "altered.log"
        log.write_text("".join(format_line(format_time(e.timestamp_us), e.channel, e.frame) for e in lines))
        result = replay(log, config)
        assert not result.bit_exact
        assert result.first_bit_difference.signal == "FSW_EVENT.argument"


class TestOrders:
    FIELD, BROKEN = MagField(1, 20e3, 0.0, -30e3).encode(), Frame(MagField.ID, b"\0")
    SENT = (FIELD, SunVector(1, 0.6, 0.0, 0.8).encode(), *[Frame(0x108, bytes(5))] * 12, sync(1))
    FLOOD = (BROKEN, Frame(0x7FF, b"\xde\xad"), Frame(0x080, bytes(8))) * 60

    @pytest.mark.parametrize(("before_field", "before_sync"), [(3, 3), (1, 2), (0, 90), (90, 90), (30, 60)])
    def test_a_flood_that_met_the_first_of_many_frames_is_found(self, before_field, before_sync):
        """The part of the flood before the field, and the part before the SYNC."""
        found = [
            order
            for order in islice(orders([*self.SENT, *self.FLOOD]), MAX_ORDERS)
            if order.index(self.SENT[-1]) == len(self.SENT) - 1 + before_sync
            and order[: order.index(self.FIELD)].count(self.BROKEN) == -(-before_field // 3)
        ]
        assert found

    def test_each_part_keeps_its_order_and_all_frames(self):
        own = [Frame(0x700, bytes([index])) for index in range(4)]
        for order in orders([*self.SENT, *own, self.BROKEN]):
            assert [frame for frame in order if frame not in (*own, self.BROKEN)] == list(self.SENT)
            assert [frame for frame in order if frame in own] == own
            assert len(order) == len(self.SENT) + 5

    def test_no_order_is_between_frames_that_do_not_meet(self):
        own = [Frame(0x700, bytes([index])) for index in range(4)]
        assert len({tuple(order) for order in orders([*self.SENT, *own])}) == 5


class TestEnd:
    @pytest.fixture
    def entries(self, recorded_run):
        return list(read_log(recorded_run / BUS_LOG))

    @pytest.fixture
    def replay_entries(self, tmp_path, recorded_run, config_of):
        def of(entries):
            log = tmp_path / "bus.log"
            log.write_text(
                "".join(format_line(format_time(e.timestamp_us), e.channel, e.frame) for e in entries)
            )
            return replay(log, config_of(recorded_run))

        return of

    @pytest.mark.parametrize("ticks", [150, 149, 300, 9999])
    def test_in_the_middle_is_no_end_and_no_reason_to_stop(self, replay_entries, entries, ticks):
        """As a log that was edited: the flight software would have reported it."""
        done = [i for i, e in enumerate(entries) if e.frame.can_id == TickDone.ID][149]
        forged = entries[done]._replace(frame=PlantEnd(ticks, counter=1).encode())
        result = replay_entries([*entries[: done + 1], forged, *entries[done + 1 :]])
        assert result.first_bit_difference.tick == 150
        assert "PLANT_END" not in result.first_bit_difference.signal

    @pytest.mark.parametrize("ticks", [299, 301, 9999])
    def test_that_does_not_fit_is_none(self, replay_entries, entries, ticks):
        result = replay_entries([*entries[:-1], entries[-1]._replace(frame=PlantEnd(ticks).encode())])
        assert not result.ended
        assert result.first_bit_difference.signal == "PLANT_END.ticks"
