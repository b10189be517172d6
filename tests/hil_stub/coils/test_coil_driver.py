"""The coil driver board: what it refuses and how it says so, its gate, its ticks."""

import pytest

from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import (
    CoilBoot,
    CoilDipole,
    CoilEvent,
    CoilFire,
    CoilRefused,
    CoilStatus,
    Severity,
    Sync,
    TickDone,
)
from fsw.wire.messages import CoilRefusedReason as Reason
from hil_stub.coils.coil_driver import OFF, BoardState, CoilDriver, CoilLimits, Drive, Pin
from hil_stub.coils.events import CoilEventCode


@pytest.fixture
def rig(rig_with):
    """At 1 Hz, the next tick being the 300th: any coil may be fired in it."""
    rig = rig_with(CoilLimits(1))
    rig.skip_to(300)
    return rig


class TestRefusals:
    def test_a_proper_request_is_driven_and_not_refused(self, rig):
        assert rig.step(rig.fire()).drive == Drive(1, 3, 1.0)
        assert rig.step().refused == []

    @pytest.mark.parametrize(
        ("wrong", "reason"),
        [
            ({"tick": 299}, Reason.WRONG_TICK),
            ({"tick": 301}, Reason.WRONG_TICK),
            ({"tick": 255}, Reason.WRONG_TICK),
            ({"coil": 3}, Reason.BAD_COIL),
            *[({"level": level}, Reason.BAD_LEVEL) for level in (-8, -5, -4, 0, 4, 7)],
            *[({"duration_ms": ms}, Reason.BAD_DURATION) for ms in (0, 3001, 3100, 65_535)],
        ],
    )
    def test_each_is_named_in_the_next_tick_and_nothing_is_driven(self, rig, wrong, reason):
        request = rig.fire(**{"seq": 42} | wrong)
        assert rig.step(request).drive == OFF
        step = rig.step()
        assert step.refused == [CoilRefused(request.coil, 42, reason, 300 & 0xFF)]
        assert (step.status.level, step.status.seq) == (0, 0)

    def test_of_many_requests_in_a_tick_the_first_proper_one_is_taken(self, rig):
        step = rig.step(
            rig.fire(coil=0, level=5, seq=1),
            rig.fire(coil=1, level=2, seq=2),
            rig.fire(coil=1, level=2, seq=2),
            rig.fire(coil=2, level=3, seq=3),
        )
        assert step.drive == Drive(1, 2, 1.0)
        refused = rig.step().refused
        assert [(m.seq, m.reason) for m in refused] == [
            (1, Reason.BAD_LEVEL),
            (2, Reason.REPEATED_SEQ),
            (3, Reason.COIL_ON),
        ]
        assert [m.counter for m in refused] == [0, 1, 2]

    def test_a_request_that_is_sent_again_after_the_lockout_is_refused(self, rig):
        rig.step(rig.fire(seq=5))
        while rig.tick < 402:
            rig.step()
        assert rig.step(rig.fire(seq=5)).drive == OFF
        step = rig.step(rig.fire(seq=4))
        assert (step.reasons, step.drive.level) == ([Reason.REPEATED_SEQ], 3)

    def test_they_are_said_once(self, rig):
        rig.step(rig.fire(level=4))
        assert [len(rig.step().refused) for _ in range(3)] == [1, 0, 0]

    def test_after_drive_it_is_too_late(self, rig):
        request = rig.fire()
        rig.step()
        rig.board.receive(request.encode())
        assert rig.board.drive() == OFF
        step = rig.step()
        assert (step.reasons, step.status.level, step.drive) == ([Reason.WRONG_TICK], 0, OFF)

    def test_before_the_first_tick_nothing_is_accepted(self, read):
        board = CoilDriver(CoilLimits(1, backoff_ms=0))
        board.receive(CoilFire(3, 0, 1, 0, 3000).encode())
        assert board.drive() == OFF
        boot, report, refused = read(board.begin_tick(0, 0.0))
        assert isinstance(boot, CoilBoot)
        assert report.level == 0
        assert (refused.reason, refused.tick) == (Reason.WRONG_TICK, 0)

    @pytest.mark.long
    def test_a_flood_is_not_answered_by_a_flood(self, rig):
        rig.step(*[rig.fire(level=0, seq=seq & 0xFF) for seq in range(10_000)])
        assert [len(rig.step().refused) for _ in range(2)] == [64, 0]

    def test_a_low_byte_wraps_after_256_ticks(self, rig):
        """What answers a tick that is 256 older looks new: no frame lives that long."""
        assert rig.step(rig.fire(tick=300 - 256)).drive == Drive(1, 3, 1.0)


class TestTheGate:
    @pytest.fixture
    def good(self, rig):
        return rig.fire(coil=2, seq=9).encode()

    @pytest.fixture
    def after(self, rig):
        """Brings a frame to the board in the tick: the drive, and the refusals of the next."""

        def bring(*frames):
            rig.tick += 1
            rig.board.begin_tick(rig.tick, 0.0)
            for frame in frames:
                rig.board.receive(frame)
            return rig.board.drive(), rig.step().refused

        return bring

    def test_the_frame_itself_is_taken(self, rig, good, after):
        assert after(good) == (Drive(2, 3, 1.0), [])
        assert rig.board.rejects == 0

    @pytest.mark.parametrize("bit", range(56))
    def test_one_flipped_bit_is_malformed(self, rig, good, after, bit):
        data = bytearray(good.data)
        data[bit // 8] ^= 1 << bit % 8
        drive, (refused,) = after(Frame(CoilFire.ID, bytes(data)))
        assert (drive, refused.reason, rig.board.rejects) == (OFF, Reason.MALFORMED, 1)

    @pytest.mark.parametrize("length", [0, 1, 2, 3, 4, 5, 6, 8, 9, 64])
    def test_a_wrong_length_is_malformed_and_named_if_it_names_itself(self, rig, good, after, length):
        drive, refused = after(Frame(CoilFire.ID, (good.data + bytes(64))[:length]))
        assert (drive, rig.board.rejects) == (OFF, 1)
        assert refused == ([CoilRefused(2, 9, Reason.MALFORMED, 300 & 0xFF)] if length >= 3 else [])

    @pytest.mark.parametrize("flag", [EXTENDED_FLAG, REMOTE_FLAG, ERROR_FLAG, 0x800])
    def test_a_frame_with_a_flag_is_no_request(self, rig, good, after, flag):
        assert after(Frame(CoilFire.ID | flag, good.data)) == (OFF, [])
        assert rig.board.rejects == 1

    def test_a_request_under_another_id_is_no_request(self, rig, good, after):
        ids = [can_id for can_id in range(0x800) if can_id != CoilFire.ID]
        assert after(*[Frame(can_id, good.data) for can_id in ids]) == (OFF, [])
        assert rig.board.rejects == len(ids)

    def test_another_message_is_not_for_the_board(self, rig, after):
        others = (Sync(300, 0), TickDone(300, 0), CoilDipole(1.0, 0.0, 0.0), CoilStatus(3, 1, 1, 1, 0, 1))
        assert after(*[message.encode() for message in others]) == (OFF, [])
        assert rig.board.rejects == 0


class TestTicks:
    @pytest.mark.parametrize("first_tick", [0, 1, 77, 2**31])
    def test_boot_at_any_tick_costs_a_full_lockout(self, rig_with, first_tick):
        rig = rig_with(CoilLimits(1), first_tick)
        first = rig.step()
        assert isinstance(first.said[0], CoilBoot)
        assert first.status.lockout_ms == 100_000
        rig.skip_to(first_tick + 99)
        assert rig.step(rig.fire()).drive == OFF
        free = rig.step(rig.fire())
        assert (free.status.lockout_ms, free.drive.level, free.only(CoilBoot)) == (0, 3, [])

    @pytest.mark.parametrize("backwards", [0, 1, 50, 100, 10**6])
    def test_a_tick_that_does_not_rise_is_ignored(self, rig, backwards):
        rig.step(rig.fire())
        assert rig.board.begin_tick(300 - backwards, 0.0) == []
        assert rig.board.drive() == Drive(1, 3, 1.0)
        rig.board.receive(rig.fire(seq=2, tick=300 - backwards).encode())
        step = rig.step()
        assert (step.status.remaining_ms, step.status.lockout_ms) == (2000, 102_000)
        assert step.reasons == [Reason.WRONG_TICK]

    def test_repeating_a_tick_does_not_shorten_the_lockout(self, rig_with):
        rig = rig_with(CoilLimits(1))
        rig.skip_to(50)
        assert not any(rig.board.begin_tick(49, 0.0) for _ in range(1000))
        assert rig.step().status.lockout_ms == 50_000

    @pytest.mark.parametrize("jump", [1, 2, 3, 4, 5, 102, 103, 104, 10**6])
    def test_over_a_jump_a_pulse_ends_by_its_own_time(self, rig, jump):
        rig.step(rig.fire(coil=0, level=2))
        rig.tick += jump - 1
        step = rig.step()
        report = step.status
        rest_ms = max(0, 3000 - 1000 * jump)
        assert (report.remaining_ms, report.lockout_ms) == (rest_ms, max(0, 103_000 - 1000 * jump))
        assert (report.level, report.coil) == ((2, 0) if jump <= 3 else (0, rig.tick % 3))
        assert step.drive == (Drive(0, 2, 1.0) if rest_ms else OFF)

    def test_asking_for_the_drive_twice_changes_nothing(self, rig):
        first = rig.step(rig.fire()).drive
        assert [rig.board.drive() for _ in range(10)] == [first] * 10
        assert rig.step().status.remaining_ms == 2000


class TestDeadMan:
    """Nobody is heard: the board is told so again and again, until it next enters a tick."""

    def fall_silent(self, rig, times=3):
        for _ in range(times):
            rig.board.silence()
            assert rig.board.drive() == OFF

    def test_a_pulse_ends_at_once_and_a_full_back_off_begins(self, rig):
        assert rig.step(rig.fire()).drive == Drive(1, 3, 1.0)
        self.fall_silent(rig)
        report = rig.step().status
        assert (report.level, report.remaining_ms, report.lockout_ms) == (0, 0, 99_000)
        rig.board.sync()
        rig.skip_to(399)
        assert rig.step(rig.fire(seq=2)).drive == OFF
        assert rig.step(rig.fire(seq=3)).drive == Drive(1, 3, 1.0)

    def test_it_costs_a_full_back_off_also_when_all_was_off(self, rig):
        self.fall_silent(rig)
        assert rig.step(rig.fire()).drive == OFF
        refused = rig.step()
        assert (refused.reasons, refused.status.lockout_ms) == ([Reason.LOCKOUT], 98_000)

    def test_it_is_told_once_when_it_is_over(self, rig):
        self.fall_silent(rig)
        events = [m for _ in range(5) for m in rig.step().only(CoilEvent)]
        assert events == [CoilEvent(Severity.ERROR, CoilEventCode.DEAD_MAN, 300 & 0xFF, argument=0)]
        self.fall_silent(rig)
        (again,) = rig.step().only(CoilEvent)
        assert (again.event, again.counter) == (CoilEventCode.DEAD_MAN, 1)

    def test_a_bus_that_is_heard_is_never_called_silent(self, rig):
        assert not any(rig.step(rig.fire(seq=tick)).only(CoilEvent) for tick in range(200))


class TestHeartbeat:
    def test_the_states_have_fixed_numbers(self):
        numbers = {"READY": 0, "ON": 1, "LOCKED_OUT": 2, "FAULT": 3}
        assert {state.name: state.value for state in BoardState} == numbers

    @pytest.mark.parametrize("hz", [1, 2, 3, 7, 10, 50])
    def test_it_comes_last_every_60_s_after_boot(self, rig_with, hz):
        rig = rig_with(CoilLimits(hz), first_tick=1000)
        beats = {}
        for _ in range(181 * hz):
            step = rig.step()
            if step.beats:
                assert [step.said[-1]] == step.beats
                beats[rig.tick] = step.said[-1]
        assert list(beats) == [1000 + 60 * hz, 1000 + 120 * hz, 1000 + 180 * hz]
        assert [(beat.tick, beat.counter) for beat in beats.values()] == list(
            zip(beats, range(3), strict=True)
        )

    def test_it_tells_the_state_the_rejects_and_the_ticks_skipped(self, rig_with):
        rig = rig_with(CoilLimits(1))
        rig.step()
        for _ in range(5):
            rig.board.receive(Frame(0x7FF, b""))
        rig.tick = 69  # over the 60th: the beat comes late, not never
        (beat,) = rig.step().beats
        assert (beat.state, beat.rejects, beat.slips, beat.tick) == (BoardState.LOCKED_OUT, 5, 69, 70)
        rig.tick = 118
        rig.step(rig.fire())
        (beat,) = rig.step().beats
        assert (beat.state, rig.tick, beat.counter) == (BoardState.ON, 120, 1)
        rig.tick = 299
        (beat,) = rig.step().beats
        assert (beat.state, beat.counter) == (BoardState.READY, 2)

    def test_its_numbers_saturate(self, rig_with):
        rig = rig_with(CoilLimits(1))
        rig.step()
        for _ in range(65_537):
            rig.board.receive(Frame(0x7FF, b""))
        rig.tick = 70_000
        (beat,) = rig.step().beats
        assert (beat.state, beat.rejects, beat.slips) == (BoardState.READY, 65_535, 65_535)
        assert beat.tick == 70_001 & 0xFFFF


class TestAClockOfItsOwn:
    """It is told the time with whatever comes, and when nothing comes."""

    @pytest.fixture
    def board(self):
        """Free since a second: in tick 101, at 101 s of its clock."""
        board = CoilDriver(CoilLimits(1))
        board.begin_tick(0, 0.0, 0)
        board.begin_tick(101, 0.0, 101_000)
        return board

    def fire(self, seq=7, tick=101):
        return CoilFire(-3, 2, seq, tick & 0xFF, 3000).encode()

    def test_the_pin_is_on_from_the_request_until_the_clock_ends_it(self, board):
        assert board.pin is None
        board.receive(self.fire(), 101_400)
        assert board.pin == Pin(2, -3, 104_400)
        board.pass_time(104_399)
        assert board.pin == Pin(2, -3, 104_400)
        board.pass_time(104_400)
        assert board.pin is None

    def test_its_last_tick_ends_with_sync(self, board):
        board.receive(self.fire(), 101_000)
        for tick in (102, 103, 104):
            board.sync()
            board.begin_tick(tick, 0.0, 101_010)
        assert board.pin == Pin(2, -3, 104_000)
        board.sync()
        assert board.pin is None

    def test_silence_is_timed_from_when_it_is_told(self, board):
        board.receive(self.fire(), 101_000)
        board.silence(150_000)
        assert board.pin is None
        board.begin_tick(250, 0.0, 249_999)
        board.sync()
        board.receive(self.fire(8, 250), 249_999)
        assert board.pin is None
        board.receive(self.fire(9, 250), 250_000)
        assert board.pin == Pin(2, -3, 253_000)

    def test_without_one_the_pin_has_no_timer(self):
        board = CoilDriver(CoilLimits(1))
        board.begin_tick(0, 0.0)
        board.begin_tick(101, 0.0)
        board.receive(self.fire())
        assert board.pin == Pin(2, -3, None)
