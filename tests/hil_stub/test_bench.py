"""A board that follows a bus by itself: when it sends, and when it starts over."""

import pytest

from fsw.wire.messages import (
    CoilBoot,
    CoilDipole,
    CoilDipoleStatus,
    CoilFire,
    CoilStatus,
    MagBoot,
    MagField,
    PlantBoot,
    PlantEnd,
    SunVector,
    Sync,
    TickDone,
)
from hil_stub.bench import Bench, DipoleBoard, MagnetometerBoard, SunBoard
from hil_stub.sensors.stimulus import constant

LAST_TICK = 2**32 - 1


def fly(bench, ticks):
    """Lockstep: in each tick SYNC, then fsw's answer; what the board sent in the last."""
    sent = []
    for tick in ticks:
        assert bench.receive(Sync(tick, 0).encode()) == []
        sent = bench.receive(TickDone(tick, 0).encode())
    return sent


class TestLockstep:
    def test_the_frames_of_the_first_tick_come_at_the_start(self, read):
        bench = Bench(lambda: MagnetometerBoard(1, constant((2e-5, 0.0, -3e-5))))
        assert [type(m) for m in read(bench.switch_on())] == [MagBoot, MagField]

    def test_those_of_the_next_when_fsw_has_answered(self, bench, read):
        assert bench.receive(Sync(0, 0).encode()) == []
        (status,) = read(bench.receive(TickDone(0, 0).encode()))
        assert (status.coil, status.lockout_ms) == (1, 99_000)
        assert bench.receive(Sync(1, 0).encode()) == [], "they are out already"
        (status,) = read(bench.receive(TickDone(1, 0).encode()))
        assert (status.coil, status.lockout_ms) == (2, 98_000)

    @pytest.mark.parametrize("tick", [0, 1, 3, 4, 2**32 - 1])
    def test_only_the_answer_to_its_own_tick_moves_it(self, bench, tick):
        fly(bench, range(2))
        assert bench.receive(TickDone(tick, 0).encode()) == []
        assert len(bench.receive(TickDone(2, 0).encode())) == 1

    def test_an_answer_that_was_lost_is_made_up_for_by_the_next_sync(self, bench, read):
        fly(bench, range(5))
        (status,) = read(bench.receive(Sync(6, 0).encode()))
        assert status.lockout_ms == 94_000

    @pytest.mark.parametrize(
        ("make", "stimulus", "kind", "shown"),
        [
            (SunBoard, (0.0, 0.5, -0.75), SunVector, (0.0, 0.5, -0.75)),
            (MagnetometerBoard, (0.0, 3e-5, -6e-5), MagField, (0.0, 30_000.0, -60_000.0)),
        ],
    )
    def test_a_sensor_shows_its_stimulus_and_ignores_requests(self, read, make, stimulus, kind, shown):
        bench = Bench(lambda: make(1, constant(stimulus)))
        bench.switch_on()
        bench.receive(CoilFire(3, 0, 1, 0, 3000).encode())
        (sample,) = read(fly(bench, range(50)))
        assert isinstance(sample, kind)
        assert sample.values()[:4] == (1, *shown)

    @pytest.mark.parametrize("reports", [0, 3, 10, 2**24 - 1])
    def test_an_end_that_the_plant_tells_of_is_nothing_to_it(self, bench, read, reports):
        fly(bench, range(10))
        assert bench.receive(PlantEnd(reports).encode()) == []
        assert read(fly(bench, [10]))[0].lockout_ms == 89_000


class TestTheCoilDriver:
    def test_it_fires_and_reads_the_nominal_current_back(self, bench, read):
        fly(bench, range(100))
        bench.receive(Sync(100, 0).encode())
        bench.receive(CoilFire(-2, 1, 5, 100, 2500).encode())
        rows = [read(bench.receive(TickDone(tick, 0).encode()))[0] for tick in range(100, 105)]
        assert [(s.level, s.remaining_ms, s.current_ma) for s in rows] == [
            (-2, 1500, -200),
            (-2, 500, -200),
            (-2, 0, 0),
            (0, 0, 0),
            (0, 0, 0),
        ]

    def test_full_level_is_300_ma(self, bench, read):
        fly(bench, range(100))
        bench.receive(CoilFire(3, 0, 5, 100, 3000).encode())
        assert read(fly(bench, (100, 101, 102)))[0].current_ma == 300
        assert read(fly(bench, (103,)))[0].current_ma == 0

    def test_a_late_request_is_refused(self, bench, read):
        fly(bench, range(100))
        bench.receive(Sync(100, 0).encode())
        bench.receive(TickDone(100, 0).encode())
        bench.receive(CoilFire(3, 0, 5, 100, 3000).encode())
        status, refused = read(bench.receive(TickDone(101, 0).encode()))
        assert (status.level, refused.seq) == (0, 5)


class TestLosingCount:
    """A board that has missed ticks cannot vouch for its timers: it starts over, with a full lockout."""

    def test_two_syncs_in_a_row_that_are_strange_are_believed(self, bench, read):
        fly(bench, range(200))
        assert bench.receive(Sync(250, 0).encode()) == []
        boot, status = read(bench.receive(Sync(251, 0).encode()))
        assert isinstance(boot, CoilBoot)
        assert (status.coil, status.lockout_ms) == (251 % 3, 100_000)
        bench.receive(CoilFire(3, 0, 5, 251, 3000).encode())
        assert read(bench.receive(TickDone(251, 0).encode()))[0].level == 0

    @pytest.mark.parametrize("strange", [0, 9, 12, 90, 110, 2**31, 2**32 - 1])
    def test_one_alone_moves_nothing(self, bench, read, strange):
        fly(bench, range(10))
        assert bench.receive(Sync(strange, 0).encode()) == []
        (status,) = read(fly(bench, [10]))
        assert status.lockout_ms == 89_000

    @pytest.mark.parametrize(("first", "second"), [(250, 250), (7, 7), (7, 8), (2**32 - 2, 2**32 - 1)])
    def test_so_are_two_of_one_tick_and_two_backwards(self, bench, read, first, second):
        fly(bench, range(200))
        assert bench.receive(Sync(first, 0).encode()) == []
        boot, status = read(bench.receive(Sync(second, 0).encode()))
        assert isinstance(boot, CoilBoot)
        assert (status.coil, status.lockout_ms) == (second % 3, 100_000)
        assert bench.receive(Sync(second, 0).encode()) == [], "it is in that tick now"

    @pytest.mark.parametrize(("first", "second"), [(0, 1), (0, 0), (1, 2)])
    def test_the_count_does_not_wrap_but_starts_anew_after_its_last_tick(self, bench, read, first, second):
        """A pulse that ends with the count may be followed by none before a full back-off."""
        bench.switch_on(LAST_TICK - 110)
        for tick in range(LAST_TICK - 110, LAST_TICK):
            status, *_ = read(fly(bench, [tick]))
        assert status.lockout_ms == 0, "in the last tick it counts as in any other"
        bench.receive(Sync(LAST_TICK, 0).encode())
        bench.receive(CoilFire(3, status.coil, 5, LAST_TICK, 3000).encode())
        assert bench.pin is not None, "a request is taken in the last tick"
        assert bench.receive(TickDone(LAST_TICK, 0).encode()) == [], "no tick follows"
        assert bench.receive(TickDone(0, 0).encode()) == [], "nor is it tick 0"
        assert bench.receive(Sync(first, 0).encode()) == []
        boot, status = read(bench.receive(Sync(second, 0).encode()))
        assert isinstance(boot, CoilBoot)
        assert (status.level, status.lockout_ms) == (0, 100_000)

    def test_two_with_a_good_one_between_them_move_nothing(self, bench, read):
        fly(bench, range(10))
        for tick in range(10, 20):
            bench.receive(Sync(500 + tick, 0).encode())
            (status,) = read(fly(bench, [tick]))
        assert status.lockout_ms == 80_000

    def test_two_that_do_not_follow_each_other_move_nothing(self, bench, read):
        fly(bench, range(10))
        for strange in (500, 502, 501, 503, 7, 9, 3):
            assert bench.receive(Sync(strange, 0).encode()) == []
        assert read(fly(bench, [10]))[0].lockout_ms == 89_000

    def test_a_plant_that_starts_anew_starts_the_board_anew(self, bench, read):
        fly(bench, range(200))
        boot, status = read(bench.receive(PlantBoot(0, 1, 0).encode()))
        assert (type(boot), status.coil, status.lockout_ms) == (CoilBoot, 0, 100_000)
        assert read(fly(bench, range(3)))[0].lockout_ms == 97_000

    def test_also_in_the_second_tick(self, bench, read):
        fly(bench, range(1))
        assert isinstance(read(bench.receive(PlantBoot(0, 1, 0).encode()))[0], CoilBoot)

    def test_a_new_board_remembers_no_strange_sync(self, bench):
        fly(bench, range(9))
        bench.receive(Sync(250, 0).encode())
        bench.receive(PlantBoot(0, 1, 0).encode())
        assert bench.receive(Sync(251, 0).encode()) == []

    def test_a_plant_that_starts_after_the_board_finds_it_in_tick_0(self, bench, read):
        assert bench.receive(PlantBoot(0, 1, 0).encode()) == []
        (status,) = read(fly(bench, range(1)))
        assert status.lockout_ms == 99_000


def test_a_continuous_driver_tells_the_dipole_of_the_tick_that_has_ended(read):
    bench = Bench(lambda: DipoleBoard(1))
    assert [type(m) for m in read(bench.switch_on())] == [CoilBoot, CoilStatus, CoilDipoleStatus]
    reports = []
    for tick, asked in enumerate([0.25, 0.5, None, -0.75, None]):
        bench.receive(Sync(tick, 0).encode())
        if asked is not None:
            bench.receive(CoilDipole(asked, 0.0, -asked).encode())
        _, status = read(bench.receive(TickDone(tick, 0).encode()))
        reports.append(status.values()[:3])
    assert reports == [
        (0.25, 0.0, -0.25),
        (0.5, 0.0, -0.5),
        (0.0, 0.0, 0.0),
        (-0.75, 0.0, 0.75),
        (0.0, 0.0, 0.0),
    ]
