"""A board's own time: its dead-man, and a clock that does not depend on the ticks of the bus."""

import pytest

from fsw.wire.messages import (
    CoilEvent,
    CoilFire,
    CoilRefused,
    CoilStatus,
    Severity,
    Sync,
    TickDone,
)
from fsw.wire.messages import CoilRefusedReason as Reason
from hil_stub.bench import Bench, CoilBoard, SunBoard
from hil_stub.coils.coil_driver import CoilLimits, Pin
from hil_stub.coils.events import CoilEventCode
from hil_stub.sensors.stimulus import constant


class TestTheDeadMan:
    """SYNC stays away: off, and nothing is accepted until it is back and a full back-off has passed."""

    @pytest.fixture
    def watched(self):
        bench = Bench(lambda: CoilBoard(CoilLimits(1)), deadman_ms=5000)
        bench.switch_on(now_ms=1000)
        return bench

    def fly(self, bench, ticks, *frames):
        """In real time: SYNC of tick k at k + 2 s, frames in the middle of the tick, then the answer."""
        sent = []
        for tick in ticks:
            now_ms = 2000 + 1000 * tick
            bench.receive(Sync(tick, 0).encode(), now_ms)
            for frame in frames:
                bench.receive(frame, now_ms + 1)
            sent = bench.receive(TickDone(tick, 0).encode(), now_ms + 2)
        return sent

    def fire(self, tick, seq=5):
        return CoilFire(-2, 1, seq, tick & 0xFF, 3000).encode()

    def test_ticks_in_time_never_wake_it(self, watched, read):
        self.fly(watched, range(100))
        (status,) = read(self.fly(watched, [100], self.fire(100)))
        assert (status.level, status.remaining_ms) == (-2, 2000)

    @pytest.mark.parametrize("has_clock", [False, True])
    @pytest.mark.parametrize("backoff_ms", [0, 10])
    def test_without_a_back_off_it_accepts_nothing_until_sync_is_back(self, has_clock, backoff_ms):
        bench = Bench(lambda: CoilBoard(CoilLimits(1, 3000, backoff_ms)), 5000, has_clock)
        bench.switch_on()
        bench.receive(Sync(0, 0).encode(), 0)
        for now_ms in (5001, 6000):
            bench.receive(self.fire(0), now_ms)
            assert bench.pin is None
        bench.receive(Sync(0, 0).encode(), 6001)
        bench.receive(self.fire(0), 6050)
        assert bench.pin is None, "the same SYNC once more is none"
        bench.receive(Sync(1, 0).encode(), 7000)
        bench.receive(self.fire(1), 7000 + backoff_ms)
        assert bench.pin is not None

    def test_it_switches_off_and_locks_out_in_full_from_the_sync_on(self, watched, read):
        self.fly(watched, range(150))
        self.fly(watched, [150], self.fire(150))
        watched.watch(152_000 + 5001)
        watched.watch(152_000 + 60_000)
        assert watched.receive(Sync(151, 0).encode(), 300_000) == []
        status, event = read(watched.receive(TickDone(151, 0).encode(), 300_002))
        assert (status.level, status.remaining_ms, status.lockout_ms) == (0, 0, 99_000)
        assert (event.event, event.severity, event.argument) == (CoilEventCode.DEAD_MAN, Severity.ERROR, 0)
        (status,) = read(watched.receive(Sync(153, 0).encode(), 301_000))
        assert status.lockout_ms == 98_000

    def test_just_in_time_is_in_time(self, watched, read):
        self.fly(watched, range(10))
        watched.watch(11_000 + 5000)
        watched.receive(Sync(10, 0).encode(), 11_000 + 5000)
        (status,) = read(watched.receive(TickDone(10, 0).encode(), 16_001))
        assert status.lockout_ms == 89_000

    def test_a_millisecond_later_is_too_late(self, watched, read):
        self.fly(watched, range(10))
        watched.receive(Sync(10, 0).encode(), 11_000 + 5001)
        status, event = read(watched.receive(TickDone(10, 0).encode(), 16_002))
        assert (status.lockout_ms, event.event) == (99_000, CoilEventCode.DEAD_MAN)

    def test_answers_alone_do_not_keep_it_awake(self, watched, read):
        self.fly(watched, range(200))
        for tick in range(200, 400):
            frames = watched.receive(TickDone(tick, 0).encode(), 203_000 + 1000 * (tick - 200))
        assert read(frames)[0].lockout_ms == 99_000, "it begins anew as long as it is silent"
        assert not any(m.level for m in read(frames) if isinstance(m, CoilStatus))

    @pytest.mark.parametrize("strange", [0, 77, 149, 152, 2**31])
    def test_nor_does_a_sync_of_another_tick(self, watched, read, strange):
        self.fly(watched, range(150))
        watched.receive(Sync(strange, 0).encode(), 153_000)
        watched.receive(Sync(150, 0).encode(), 151_000 + 5001)
        status, event = read(watched.receive(TickDone(150, 0).encode(), 157_000))
        assert (status.lockout_ms, event.event) == (99_000, CoilEventCode.DEAD_MAN)

    def test_a_request_while_it_is_silent_is_refused(self, watched, read):
        self.fly(watched, range(150))
        watched.watch(160_000)
        watched.receive(self.fire(150), 160_001)
        status, refused, event = read(watched.receive(Sync(151, 0).encode(), 160_002))
        assert (status.level, refused.reason, event.event) == (0, Reason.LOCKOUT, CoilEventCode.DEAD_MAN)

    def test_it_is_told_once(self, watched, read):
        self.fly(watched, range(10))
        watched.watch(60_000)
        assert len(read(watched.receive(Sync(11, 0).encode(), 60_001))) == 2
        assert len(read(watched.receive(Sync(12, 0).encode(), 61_000))) == 1

    @pytest.mark.parametrize(("last_ms", "silent"), [(157_000, False), (157_001, True)])
    def test_a_sync_that_only_repeats_its_tick_does_not_keep_it_awake(self, watched, read, last_ms, silent):
        self.fly(watched, range(150))
        for now_ms in (*range(152_000, 157_000, 100), last_ms):
            watched.receive(Sync(150, 0).encode(), now_ms)
        status, *events = read(watched.receive(TickDone(150, 0).encode(), last_ms))
        assert [event.event for event in events] == [CoilEventCode.DEAD_MAN] * silent
        assert status.lockout_ms == 99_000 * silent

    def test_it_tells_when_it_will_wake(self, watched):
        watched.receive(Sync(0, 0).encode(), 2000)
        assert watched.due_ms() == 7001
        watched.receive(Sync(0, 0).encode(), 3000)
        assert watched.due_ms() == 7001
        watched.watch(7001)
        assert watched.due_ms() is None, "it is awake"
        watched.receive(Sync(1, 0).encode(), 8000)
        assert watched.due_ms() == 13_001

    def test_without_one_nothing_happens(self, bench, read):
        self.fly(bench, range(10))
        assert bench.due_ms() is None
        bench.watch(10**9)
        assert read(self.fly(bench, [10]))[0].lockout_ms == 89_000

    def test_sensors_go_on(self, read):
        bench = Bench(lambda: SunBoard(1, constant((1.0, 0.0, 0.0))), deadman_ms=5000)
        bench.switch_on()
        bench.watch(10**6)
        assert len(read(bench.receive(Sync(1, 0).encode(), 10**6))) == 1


class TestAClockOfItsOwn:
    @pytest.fixture
    def clocked(self):
        bench = Bench(lambda: CoilBoard(CoilLimits(1)), has_clock=True)
        bench.switch_on(now_ms=5_000_000)
        return bench

    def test_ticks_too_fast_do_not_shorten_the_lockout(self, clocked, read):
        """A hundred ticks in a tenth of a second."""
        for tick in range(100):
            frames = clocked.receive(TickDone(tick, 0).encode(), 5_000_000 + tick)
        assert read(frames)[0].lockout_ms == 99_910, "100 s less 99 ms, in steps of 10 ms"

    def test_ticks_that_stand_still_do_not_stretch_the_pulse(self, clocked, read):
        for tick in range(100):
            clocked.receive(TickDone(tick, 0).encode(), 5_001_000 + 1000 * tick)
        clocked.receive(CoilFire(-2, 1, 5, 100, 3000).encode(), 5_100_500)
        (status,) = read(clocked.receive(TickDone(100, 0).encode(), 5_101_000))
        assert (status.level, status.remaining_ms) == (-2, 2000)
        (status,) = read(clocked.receive(TickDone(101, 0).encode(), 5_104_000))
        assert (status.level, status.remaining_ms, status.current_ma) == (-2, 0, 0)
        (status,) = read(clocked.receive(TickDone(102, 0).encode(), 5_105_000))
        assert (status.level, status.current_ma) == (0, 0)


class TestTimeThatPassesWithoutTicks:
    """A board's clock is the time that passes, not the ticks that it hears."""

    @pytest.fixture
    def free(self):
        """In tick 150, all back-offs over; the last thing heard is its SYNC, at 151 s."""
        bench = Bench(lambda: CoilBoard(CoilLimits(1)), deadman_ms=5000, has_clock=True)
        bench.switch_on(now_ms=1000)
        for tick in range(150):
            bench.receive(Sync(tick, 0).encode(), 1000 + 1000 * tick)
            bench.receive(TickDone(tick, 0).encode(), 1000 + 1000 * tick)
        bench.receive(Sync(150, 0).encode(), 151_000)
        return bench

    def fire(self, bench, tick, now_ms, seq=5):
        bench.receive(CoilFire(-2, 1, seq, tick & 0xFF, 3000).encode(), now_ms)
        return bench.pin

    def rush(self, bench, ticks, now_ms):
        """Ticks in no time; what the board says in the last."""
        for tick in ticks:
            bench.receive(Sync(tick, 0).encode(), now_ms)
            replies = bench.receive(TickDone(tick, 0).encode(), now_ms)
        return replies

    def test_a_request_late_in_a_held_tick_is_timed_from_when_it_came(self, free, read):
        assert self.fire(free, 150, 155_900) == Pin(1, -2, 158_900)
        replies = self.rush(free, range(150, 260), 156_000)
        assert free.pin is None
        assert read(replies)[0].lockout_ms == 102_900
        assert self.fire(free, 260, 258_890, seq=6) is None, "99.99 s after the end that it was armed for"

    def test_after_a_held_tick_and_a_rush_the_gap_is_whole(self, free):
        assert self.fire(free, 150, 155_800) == Pin(1, -2, 158_800)
        tick, on_at_ms = 150, []
        for now_ms in range(155_900, 262_000, 10):
            free.receive(Sync(tick, 0).encode(), now_ms)
            free.receive(TickDone(tick, 0).encode(), now_ms)
            tick += 1
            if self.fire(free, tick, now_ms, seq=tick & 0xFF) is not None:
                on_at_ms.append(now_ms)
        assert on_at_ms[:3] == [155_900, 155_910, 155_920], "the rush ends the pulse early"
        assert on_at_ms[3] == 155_800 + 3000 + 100_000

    def test_a_pulse_lasts_as_long_as_was_asked_though_ticks_are_told_of_ahead(self, free, read):
        """fsw answers at once: the board enters each tick nearly a second before its SYNC."""
        self.fire(free, 150, 151_010)
        reports, on = [], []
        for tick in range(150, 155):
            (status,) = read(free.receive(TickDone(tick, 0).encode(), 1020 + 1000 * tick))
            reports.append((status.level, status.remaining_ms))
            free.watch(2000 + 1000 * tick - 1)
            on.append(free.pin is not None)
            free.receive(Sync(tick + 1, 0).encode(), 2000 + 1000 * tick)
        assert reports == [(-2, 2000), (-2, 1000), (-2, 0), (0, 0), (0, 0)]
        assert on == [True, True, True, False, False]

    def test_a_pulse_that_the_ticks_end_ends_with_sync(self, free):
        self.fire(free, 150, 151_010)
        for tick in (150, 151, 152):
            free.receive(Sync(tick, 0).encode(), 151_020)
            free.receive(TickDone(tick, 0).encode(), 151_020)
        assert free.pin == Pin(1, -2, 154_010), "in the last of its ticks"
        free.receive(Sync(153, 0).encode(), 151_030)
        assert free.pin is None

    def test_a_pulse_ends_with_no_bus_at_all(self, free):
        self.fire(free, 150, 151_500)
        assert free.due_ms() == 154_500
        free.watch(154_499)
        assert free.pin == Pin(1, -2, 154_500)
        free.watch(154_500)
        assert free.pin is None

    def test_one_sync_repeated_for_seven_seconds_is_silence(self, free, read):
        for now_ms in range(151_000, 158_001, 100):
            free.receive(Sync(150, 0).encode(), now_ms)
        assert self.fire(free, 150, 158_000) is None
        replies = read(free.receive(TickDone(150, 0).encode(), 158_000))
        assert [m.event for m in replies if isinstance(m, CoilEvent)] == [CoilEventCode.DEAD_MAN]
        assert [m.reason for m in replies if isinstance(m, CoilRefused)] == [Reason.LOCKOUT]

    def test_the_back_off_after_silence_runs_from_when_it_ended(self, free):
        free.watch(200_000)
        self.rush(free, range(150, 300), 210_000)
        for tick in range(300, 324):
            self.rush(free, [tick], 210_000 + (tick - 300) * 4300)
        assert self.fire(free, 324, 309_999) is None
        assert self.fire(free, 324, 310_000, seq=6) is not None

    def test_the_status_of_a_held_tick_tells_what_was_driven_in_it(self, free, read):
        self.fire(free, 150, 151_500)
        (status,) = read(free.receive(TickDone(150, 0).encode(), 155_900))
        assert (status.level, status.remaining_ms, status.current_ma) == (-2, 0, 0)
        (status,) = read(free.receive(TickDone(151, 0).encode(), 155_950))
        assert status.level == 0
