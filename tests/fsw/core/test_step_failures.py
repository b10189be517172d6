"""The flight loop when boards fall silent, a coil drives by itself, or what it remembers is spoiled."""

import pytest
from replies import events_of, of

from fsw.core.gate.readings import INBOX_LIMIT
from fsw.core.telemetry import Event
from fsw.wire.messages import (
    CoilFire,
    CoilStatus,
    FswEvent,
    MagField,
    Mode,
    SunVector,
    TickDone,
)


def lose_syncs(world, ticks):
    """The inbox after so many lost SYNCs, with all frames since the last one."""
    frames = ()
    for _ in range(ticks):
        frames += world.inbox().frames
        world.plant.end_tick()
    inbox = world.inbox()
    return inbox.replace(frames=frames + inbox.frames)


class TestLostSyncs:
    def test_the_field_is_that_of_now_though_many_frames_have_come_since(self, make_world):
        world = make_world()
        world.fly_until_valid()
        inbox = lose_syncs(world, 40)
        assert len(inbox.frames) > INBOX_LIMIT
        world.step(lambda _: inbox)
        latest = [MagField.decode(frame.data) for frame in inbox.frames if frame.can_id == MagField.ID][-1]
        sample = world.state.sample
        assert sample.tick == world.state.tick
        sent_t = [1e-9 * number for number in (latest.b_x, latest.b_y, latest.b_z)]
        assert sample.b_body_t == pytest.approx(sent_t, abs=1e-12)
        assert world.state.estimator.rejected_in_a_row == 0

    def test_a_sample_that_may_date_from_a_pulse_in_skipped_ticks_is_not_taken(self, make_world):
        """Of most of those ticks no report is read: how long the coils have been idle is not known."""
        world = make_world(flight={"uncertainty": {"latency_s": 2.0}})
        world.fly_until_valid()
        blank_ticks, taken = world.config.estimator.blank_ticks, []
        assert blank_ticks >= 2
        assert world.state.coil.idle_ticks > blank_ticks
        inbox = lose_syncs(world, 1)
        world.step(lambda _: inbox)
        for _ in range(blank_ticks + 1):
            taken.append(world.state.sample.tick == world.state.tick)
            world.step()
        assert taken == [False] * blank_ticks + [True]


class TestSilence:
    STALE_S = 60

    @pytest.mark.parametrize(
        ("board", "monitor"), [(CoilStatus, 6), (MagField, 5)], ids=["coil driver", "magnetometer"]
    )
    def test_a_silent_board_leads_to_safe_and_no_pulse(self, make_world, without, board, monitor):
        world = make_world()
        world.fly(90)
        assert world.state.modes.mode is not Mode.SAFE
        ticks = world.fly(150, without(board))
        after = [tick for tick, *_ in events_of(ticks)]
        trips = [e for e in events_of(ticks) if e[1] == Event.MONITOR_TRIPPED]
        assert trips == [(self.STALE_S - 1, Event.MONITOR_TRIPPED, monitor)]
        assert (self.STALE_S - 1, Event.MODE_CHANGED, Mode.SAFE) in events_of(ticks)
        assert max(after) == self.STALE_S - 1
        assert world.state.modes.mode is Mode.SAFE
        assert not any(of(CoilFire, replies) for replies in ticks[self.STALE_S - 1 :])

    def test_without_coil_status_not_one_request_goes_out(self, make_world, without):
        """Not even in the minute before the monitor trips, with both timers long run out."""
        world = make_world()
        world.fly(90)
        assert not any(of(CoilFire, replies) for replies in world.fly(200, without(CoilStatus)))

    def test_a_board_that_comes_back_is_trusted_again(self, make_world, without):
        """SAFE is left once the magnetometer is readmitted: without field and attitude no law can act."""
        world = make_world()
        world.fly(90)
        world.fly(70, without(MagField))
        assert world.state.modes.mode is Mode.SAFE
        isolated, modes = [], []
        while world.state.modes.mode is Mode.SAFE:
            world.step()
            isolated.append(bool(world.state.health.sensors.field.fault))
            modes.append(world.state.modes.mode)
        assert modes[-1] is Mode.DETUMBLE
        assert isolated.index(False) == len(modes) - 1 - 5
        assert 100 < len(modes) < 700
        assert world.state.modes.trips == 1

    @pytest.mark.long
    def test_the_third_time_it_stays_safe(self, make_world, without):
        world = make_world()
        world.fly(40)
        for _ in range(3):
            world.fly(70, without(MagField))
            world.fly(700)
        assert (world.state.modes.mode, world.state.modes.trips) == (Mode.SAFE, 3)
        assert not any(of(CoilFire, replies) for replies in world.fly(200))
        assert world.state.modes.mode is Mode.SAFE

    def test_without_a_sun_sensor_the_flight_goes_on(self, make_world, without):
        world = make_world()
        world.fly_until_valid()
        world.fly(150, without(SunVector))
        assert world.state.modes.trips == 0
        assert world.state.attitude.valid

    def test_without_any_board_from_the_start_nothing_is_ever_fired(self, make_world):
        world = make_world()
        ticks = world.fly(250, lambda inbox: inbox.replace(frames=()))
        assert world.state.modes.mode is Mode.SAFE
        assert world.state.estimator.estimate is None
        assert not any(of(CoilFire, replies) for replies in ticks)
        assert all(isinstance(replies[-1], TickDone) for replies in ticks)

    def test_a_coil_that_drives_by_itself_leads_to_safe_in_its_second_tick(self, make_world):
        world = make_world()
        world.fly(90)
        rogue = CoilStatus(2, 1, 2000, 40, 103000, 0, counter=0)

        def drive(inbox):
            frames = [f for f in inbox.frames if f.can_id != CoilStatus.ID]
            frames.append(rogue.replace(counter=inbox.tick & 0xF).encode())
            return inbox.replace(frames=tuple(frames))

        world.step(drive)
        assert world.state.modes.mode is not Mode.SAFE
        replies = world.step(drive)
        assert (Event.MONITOR_TRIPPED, 7) in [(m.event, m.argument) for m in of(FswEvent, replies)]
        assert world.state.modes.mode is Mode.SAFE
