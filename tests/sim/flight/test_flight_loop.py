"""The flight loop: bound to the answer that names the tick, logged as it happens, late answers counted."""

import pytest

from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.messages import (
    CoilFire,
    FswBoot,
    NavRate,
    PlantBoot,
    PlantEnd,
    PlantHeartbeat,
    Sync,
    TickDone,
)
from sim.errors import FlightError
from sim.flight import fsw_answers
from sim.flight.flight_loop import fly
from sim.flight.virtual_bus import VirtualBus
from sim.plant.dynamics.torques import SOURCES
from sim.plant.plant import Plant
from sim.record.bus_log import BusLog
from sim.record.candump import read_log
from sim.record.pace import LOCKSTEP, Pace
from sim.record.truth import TruthFile, read_truth
from sim.scenario.assemble import plant_config
from sim.scenario.schema import flight_table, load, parse_settings

BOOT = FswBoot(0, 1, 2).encode()
FROM_FSW = {0x080, 0x200, 0x201, 0x202, 0x203, 0x280, 0x410, 0x610}
"""What the flight software sends in an answer."""


def done(tick):
    return TickDone(tick, 7).encode()


@pytest.fixture
def scripted(bus_of):
    """Makes a bus that answers each SYNC as it is told to, after what waits on it at first."""
    return lambda answer, first=(BOOT,): bus_of(first, answer=answer)


@pytest.fixture
def flown(tmp_path):
    """Flies on a bus: (FlightOutcome, log entries, histories, plant)."""

    def through(bus, ticks=20, pace=LOCKSTEP, *settings, watch=lambda tick: None):
        scenario = load("microsat", parse_settings(settings))
        plant = Plant(plant_config(scenario, 3))
        with (
            BusLog(tmp_path / "bus.log", bus.name) as log,
            TruthFile(tmp_path / "truth.h5", ticks, SOURCES) as truth,
        ):
            result = fly(
                plant, bus, log, truth, ticks, scenario.epoch_unix_s, scenario.time.tick_hz, pace, watch
            )
        return result, list(read_log(tmp_path / "bus.log")), read_truth(tmp_path / "truth.h5"), plant

    return through


@pytest.fixture
def virtual():
    """A virtual bus with flight software behind it."""

    def make(*settings):
        return VirtualBus(FlightNode(flight_config(flight_table(load("microsat", parse_settings(settings))))))

    return make


class TestLockstep:
    @pytest.mark.interpreted
    def test_sync_is_sent_again_to_a_flight_software_that_is_silent(self, flown, monkeypatch, scripted):
        """As one that a forged SYNC has led astray, which believes the second."""
        monkeypatch.setattr(fsw_answers, "REPEAT_SYNC_S", 0.01)
        asked = []

        def second_time(tick):
            asked.append(tick)
            return [done(tick)] if asked.count(tick) == 2 else []

        result, entries, *_ = flown(scripted(second_time), 5)
        assert result.slips == 0
        assert asked == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4]
        logged = [Sync.decode(e.frame.data).tick for e in entries if e.frame.can_id == Sync.ID]
        assert logged == asked

    def test_every_tick_is_flown_and_recorded(self, flown, virtual):
        result, entries, truth, plant = flown(virtual(), 50)
        assert (result.ticks, result.slips) == (50, 0)
        assert result.wall_s > 0.0
        assert truth["t_s"].tolist() == [float(tick) for tick in range(50)]
        assert plant.tick == 50
        assert [Sync.decode(e.frame.data).tick for e in entries if e.frame.can_id == Sync.ID] == list(
            range(50)
        )

    def test_the_log_begins_with_fsw_s_boot_and_ends_with_the_end_of_the_run(self, flown, virtual):
        _, entries, *_ = flown(virtual(), 10)
        assert entries[0].frame.can_id == FswBoot.ID
        assert PlantEnd.decode(entries[-1].frame.data).ticks == 10
        assert sum(entry.frame.can_id == FswBoot.ID for entry in entries) == 1
        assert sum(entry.frame.can_id == PlantEnd.ID for entry in entries) == 1

    @pytest.mark.parametrize("tick_hz", [1, 3, 7, 100])
    def test_each_frame_bears_the_simulated_time_of_its_tick(self, flown, virtual, tick_hz):
        setting = f"time.tick_hz={tick_hz}"
        _, entries, *_ = flown(virtual(setting), 20, LOCKSTEP, setting)
        epoch_us = load("microsat").epoch_unix_s * 1_000_000
        tick = 0
        for entry in entries[:-1]:
            assert entry.timestamp_us == epoch_us + tick * 1_000_000 // tick_hz
            tick += entry.frame.can_id == TickDone.ID
        assert entries[-1].timestamp_us == epoch_us + 20 * 1_000_000 // tick_hz

    def test_in_each_tick_the_boards_come_first_then_sync_then_the_answer_and_tick_done_last(
        self, flown, virtual
    ):
        _, entries, *_ = flown(virtual(), 30)
        body = [entry.frame.can_id for entry in entries[1:-1]]
        ticks, tick = [], []
        for can_id in body:
            tick.append(can_id)
            if can_id == TickDone.ID:
                ticks.append(tick)
                tick = []
        assert tick == []
        assert len(ticks) == 30
        for ids in ticks:
            sync = ids.index(Sync.ID)
            assert FROM_FSW.isdisjoint(ids[:sync])
            assert FROM_FSW.issuperset(ids[sync + 1 :])

    def test_only_the_answer_that_names_the_tick_releases_it(self, flown, scripted):
        """An old TICK_DONE, one of another tick and a shortened one are logged and waited past."""

        def answer(tick):
            stale = [done(tick - 1)] if tick else []
            return [*stale, done(tick + 1), done(tick).replace(data=b"\x01"), done(tick)]

        result, entries, *_ = flown(scripted(answer), 5)
        assert result.ticks == 5
        assert sum(entry.frame.can_id == TickDone.ID for entry in entries) == 4 * 5 - 1

    @pytest.mark.interpreted
    def test_without_an_answer_it_ends_with_a_sentence_and_exit_code_1(self, flown, monkeypatch, scripted):
        monkeypatch.setattr(fsw_answers, "ANSWER_TIMEOUT_S", 0.0)
        with pytest.raises(
            FlightError, match="no answer from the flight software to tick 3 within"
        ) as caught:
            flown(scripted(lambda tick: [done(tick)] if tick < 3 else []))
        assert caught.value.exit_code == 1

    @pytest.mark.interpreted
    def test_the_log_up_to_then_remains(self, flown, monkeypatch, tmp_path, scripted):
        monkeypatch.setattr(fsw_answers, "ANSWER_TIMEOUT_S", 0.0)
        with pytest.raises(FlightError):
            flown(scripted(lambda tick: [done(tick)] if tick < 3 else []))
        assert len(read_truth(tmp_path / "truth.h5")["t_s"]) == 3
        entries = list(read_log(tmp_path / "bus.log"))
        assert TickDone.decode(entries[-1].frame.data).tick == 2

    def test_requests_reach_the_board(self, flown, scripted):
        """A request in answer to tick 100 is driven from then on, and shows in the truth."""
        fire = CoilFire(2, 1, 1, 100, 3000).encode()
        _, _, truth, _ = flown(scripted(lambda tick: [fire] * (tick == 100) + [done(tick)]), 110)
        driven = [tick for tick, dipole in enumerate(truth["m_body_am2"][:, 1]) if dipole > 1.0]
        assert driven == [101, 102, 103]

    def test_progress_is_reported_now_and_then(self, flown, virtual):
        seen = []
        flown(virtual(), 200, watch=seen.append)
        assert seen == [0, 64, 128, 192]


class TestBoot:
    def test_waits_for_an_intact_fsw_boot_and_drops_what_comes_before(self, flown, scripted):
        broken = BOOT.replace(data=BOOT.data[:-1] + b"\0")
        bus = scripted(lambda tick: [done(tick)], first=(done(9), broken, BOOT))
        _, entries, *_ = flown(bus, 3)
        assert entries[0].frame == BOOT
        assert [e.frame.can_id for e in entries].count(TickDone.ID) == 3

    @pytest.mark.interpreted
    def test_asks_again_until_it_is_answered(self, flown, monkeypatch, scripted):
        monkeypatch.setattr(fsw_answers, "BOOT_REQUEST_S", 0.01)
        bus = scripted(lambda tick: [done(tick)], first=())
        receive = bus.receive

        def late(timeout_s):
            if sum(frame.can_id == PlantBoot.ID for frame in bus.sent) == 3 and not bus.queue:
                bus.queue.append(BOOT)
                bus.receive = receive
            return receive(timeout_s)

        bus.receive = late
        result, *_ = flown(bus, 3)
        assert result.ticks == 3


class TestRealTime:
    FAST = Pace(200.0)
    """5 ms a tick."""

    @pytest.mark.long
    def test_keeps_to_absolute_deadlines(self, flown, scripted):
        result, *_ = flown(scripted(lambda tick: [done(tick)]), 40, self.FAST)
        assert (result.ticks, result.slips) == (40, 0)
        assert 40 / 200.0 <= result.wall_s < 5.0

    @pytest.mark.long
    def test_also_where_nothing_could_come_any_more(self, flown, virtual):
        result, *_ = flown(virtual(), 40, self.FAST)
        assert result.slips == 0
        assert result.wall_s >= 40 / 200.0

    def test_a_missing_answer_is_a_counted_slip_and_never_a_wait(self, flown, scripted):
        result, entries, *_ = flown(
            scripted(lambda tick: [] if tick in (3, 4, 9) else [done(tick)]), 20, self.FAST
        )
        assert (result.ticks, result.slips) == (20, 3)
        assert [Sync.decode(e.frame.data).tick for e in entries if e.frame.can_id == Sync.ID] == list(
            range(20)
        )

    def test_late_answers_to_the_last_tick_still_reach_the_log(self, flown, monkeypatch, scripted):
        bus = scripted(lambda tick: [] if tick == 19 else [done(tick)])
        receive = bus.receive

        def slow(timeout_s):
            asked = [Sync.decode(f.data).tick for f in bus.sent if f.can_id == Sync.ID]
            if timeout_s == fsw_answers.LATE_TIMEOUT_S and asked[-1] == 19:
                bus.queue.append(done(19))
            return receive(timeout_s)

        bus.receive = slow
        result, entries, *_ = flown(bus, 20, self.FAST)
        assert result.slips == 1
        assert TickDone.decode(entries[-2].frame.data).tick == 19

    def test_a_late_answer_is_logged_when_it_comes_and_counted_as_a_slip(self, flown, scripted):
        rate = NavRate(1, 0.01, 0.0, 0.0).encode()

        def answer(tick):
            if tick == 5:
                return []
            return [rate, done(5), done(6)] if tick == 6 else [done(tick)]

        result, entries, *_ = flown(scripted(answer), 10, self.FAST)
        assert result.slips == 1
        order = [e.frame for e in entries if e.frame.can_id in (Sync.ID, NavRate.ID, TickDone.ID)]
        at = order.index(rate)
        assert Sync.decode(order[at - 1].data).tick == 6
        assert [TickDone.decode(frame.data).tick for frame in order[at + 1 : at + 3]] == [5, 6]

    @pytest.mark.long
    def test_slips_are_reported_in_the_plant_s_heartbeat(self, flown, scripted):
        _, entries, *_ = flown(scripted(lambda tick: [] if tick in (3, 4) else [done(tick)]), 62, Pace(500.0))
        (beat,) = [e.frame for e in entries if e.frame.can_id == PlantHeartbeat.ID]
        assert PlantHeartbeat.decode(beat.data).slips >= 2


class TestVirtualBus:
    def test_has_the_boot_of_the_flight_software_waiting(self, virtual):
        bus = virtual()
        assert bus.receive(1.0).can_id == FswBoot.ID
        assert bus.receive(0.0) is None

    def test_answers_a_sync_at_once(self, virtual):
        bus = virtual()
        bus.receive(None)
        bus.send([Sync(0, load("microsat").epoch_unix_s).encode()])
        answers = []
        while (frame := bus.receive(0.0)) is not None:
            answers.append(frame)
        assert TickDone.decode(answers[-1].data).tick == 0
