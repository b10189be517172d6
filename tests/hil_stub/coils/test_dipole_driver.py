"""The continuous driver board: one dipole a tick, ended by itself, and nothing else."""

from math import isfinite

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.wire.frame import EXTENDED_FLAG, Frame
from fsw.wire.messages import (
    CLASSES,
    CoilBoot,
    CoilDipole,
    CoilDipoleStatus,
    CoilFire,
    CoilHeartbeat,
    CoilRefused,
    CoilStatus,
    Sync,
    TickDone,
    intact,
)
from fsw.wire.messages import CoilRefusedReason as Reason
from hil_stub.coils.coil_driver import MAX_REFUSALS, OFF, CoilDriver, CoilLimits
from hil_stub.coils.dipole_driver import DipoleBoardState, DipoleDrive, DipoleDriver

STEP = 2.0**-16
ASKED = (0.25, -0.5, 0.75)
NONE = (0.0, 0.0, 0.0)


@pytest.fixture
def board():
    return DipoleDriver(1)


@pytest.fixture
def step(board, read):
    """The next tick, with frames that come in it: the messages at its beginning, and the drive over it."""
    ticks = iter(range(100_000))

    def step(*messages, current_a=0.0):
        replies = read(board.begin_tick(next(ticks), current_a))
        for message in messages:
            board.receive(message if isinstance(message, Frame) else message.encode())
        return replies, board.drive()

    return step


def of(kind, replies):
    return [message for message in replies if isinstance(message, kind)]


def reasons(replies):
    return [(message.seq, message.reason) for message in of(CoilRefused, replies)]


class TestDrive:
    def test_a_dipole_is_driven_in_its_tick_and_told_at_the_next(self, step):
        replies, drive = step(CoilDipole(*ASKED))
        assert drive == DipoleDrive(ASKED, 0.8)
        assert of(CoilDipoleStatus, replies) == [CoilDipoleStatus(*NONE, 0)]
        replies, drive = step()
        assert of(CoilDipoleStatus, replies) == [CoilDipoleStatus(*ASKED, 1)]
        assert drive == DipoleDrive(NONE, 0.8)

    def test_without_a_new_request_nothing_is_driven(self, step):
        step(CoilDipole(*ASKED))
        replies = [step() for _ in range(20)]
        assert [drive.dipole for _, drive in replies] == [NONE] * 20
        shown = [of(CoilDipoleStatus, messages)[0].values()[:3] for messages, _ in replies]
        assert shown == [ASKED] + [NONE] * 19

    def test_requests_follow_each_other_tick_by_tick(self, step):
        asked = [(0.5 - k * STEP, k * STEP, -0.25) for k in range(50)]
        reports = [step(CoilDipole(*m, counter=k)) for k, m in enumerate(asked)]
        assert [drive.dipole for _, drive in reports] == asked
        assert [of(CoilDipoleStatus, replies)[0].values()[:3] for replies, _ in reports[1:]] == asked[:-1]
        counters = [of(CoilDipoleStatus, replies)[0].counter for replies, _ in reports]
        assert counters == [k % 16 for k in range(50)]

    @pytest.mark.parametrize("m", [(-1.0, 1.0 - STEP, -STEP), NONE, (STEP, 0.0, -1.0)])
    def test_the_whole_scale_passes_to_the_last_bit(self, step, m):
        assert step(CoilDipole(*m))[1].dipole == m

    def test_the_first_of_a_tick_is_driven_and_further_ones_are_refused(self, step):
        replies, drive = step(CoilDipole(*ASKED, 3), CoilDipole(0.1, 0.1, 0.1, 4), CoilDipole(*NONE, 5))
        assert drive.dipole == ASKED
        replies, _ = step()
        assert reasons(replies) == [(4, Reason.SECOND_DIPOLE), (5, Reason.SECOND_DIPOLE)]

    def test_a_dipole_of_zero_is_a_request_too(self, step):
        _, drive = step(CoilDipole(*NONE), CoilDipole(*ASKED, 1))
        assert drive.dipole == NONE
        assert reasons(step()[0]) == [(1, Reason.SECOND_DIPOLE)]

    def test_before_the_first_tick_and_after_drive_nothing_is_taken(self, board, read):
        board.receive(CoilDipole(*ASKED, 7).encode())
        assert board.drive().dipole == NONE
        board.begin_tick(0, 0.0)
        board.drive()
        board.receive(CoilDipole(*ASKED, 8).encode())
        assert board.drive().dipole == NONE
        replies = read(board.begin_tick(1, 0.0))
        assert reasons(replies) == [(8, Reason.WRONG_TICK)]
        assert of(CoilDipoleStatus, replies)[0].values()[:3] == NONE

    def test_over_skipped_ticks_nothing_was_driven_in_the_last(self, board, read):
        board.begin_tick(0, 0.0)
        board.receive(CoilDipole(*ASKED).encode())
        board.drive()
        assert of(CoilDipoleStatus, read(board.begin_tick(2, 0.0)))[0].values()[:3] == NONE
        assert board.drive().dipole == NONE

    def test_a_tick_that_does_not_rise_ends_no_drive_and_says_nothing(self, board):
        board.begin_tick(5, 0.0)
        board.receive(CoilDipole(*ASKED).encode())
        assert board.begin_tick(5, 0.0) == board.begin_tick(4, 0.0) == []
        assert board.drive().dipole == ASKED

    def test_the_part_of_a_tick_is_that_of_the_board(self):
        board = DipoleDriver(10, on_fraction=0.55)
        board.begin_tick(0, 0.0)
        assert board.drive().fraction == 0.55

    @pytest.mark.parametrize("part", [0.0, -0.1, 1.01, float("nan")])
    def test_a_part_of_a_tick_that_is_none_is_refused(self, part):
        with pytest.raises(ValueError, match="on_fraction"):
            DipoleDriver(1, part)


class TestWhatItSays:
    def test_one_status_a_tick_of_coils_that_are_off(self, step):
        for tick in range(12):
            replies, _ = step(CoilDipole(*ASKED), current_a=0.0)
            (status,) = of(CoilStatus, replies)
            assert status == CoilStatus(0, tick % 3, 0, 0, 0, 0, counter=tick)

    def test_what_current_still_flows_is_read_back(self, step):
        assert of(CoilStatus, step(current_a=-0.0424)[0])[0].current_ma == -42

    def test_boot_status_dipole_refusals_heartbeat_in_this_order(self, step):
        names = [[type(m).__name__ for m in step(CoilFire(1, 0, 1, 0, 3000))[0]] for _ in range(121)]
        usual = ["CoilStatus", "CoilDipoleStatus"]
        assert names[0] == ["CoilBoot", *usual]
        assert names[1] == [*usual, "CoilRefused"]
        assert names[60] == names[120] == [*usual, "CoilRefused", "CoilHeartbeat"]

    def test_boot_names_the_table_and_heartbeat_what_it_does(self, read):
        board = DipoleDriver(1, table_crc=0xDEAD_BEEF)
        assert of(CoilBoot, read(board.begin_tick(0, 0.0)))[0].table_crc == 0xDEAD_BEEF
        states = []
        for tick in range(1, 121):
            if tick in {60, 61}:
                board.receive(CoilDipole(*ASKED).encode())
                board.receive(Frame(0x7FF, b""))
            board.drive()
            states += of(CoilHeartbeat, read(board.begin_tick(tick, 0.0)))
        assert [(beat.state, beat.rejects, beat.tick) for beat in states] == [
            (DipoleBoardState.ON, 1, 60),
            (DipoleBoardState.READY, 2, 120),
        ]

    @pytest.mark.parametrize("m", [(STEP, 0.0, 0.0), (0.0, -STEP, 0.0), (0.0, 0.0, -1.0)])
    @pytest.mark.parametrize("tick_hz", [1, 7])
    def test_a_heartbeat_after_a_minute_of_ticks_tells_of_a_single_driven_coil(self, read, m, tick_hz):
        board, beats = DipoleDriver(tick_hz), []
        for tick in range(60 * tick_hz + 1):
            beats += of(CoilHeartbeat, read(board.begin_tick(tick, 0.0)))
            board.receive(CoilDipole(*m).encode())
        assert [(beat.tick, beat.state) for beat in beats] == [(60 * tick_hz, DipoleBoardState.ON)]


class TestRefusals:
    def test_each_names_the_tick_in_which_it_came(self, board, read):
        board.begin_tick(298, 0.0)
        board.receive(CoilFire(1, 2, 77, 0, 3000).encode())
        (refused,) = of(CoilRefused, read(board.begin_tick(301, 0.0)))
        assert (refused.coil, refused.tick) == (2, 298 & 0xFF)

    @pytest.mark.parametrize("length", range(7))
    def test_a_pulse_cut_short_is_named_if_coil_and_number_are_left_of_it(self, step, length):
        fire = CoilFire(-3, 2, 200, 0, 3000).encode()
        step(fire.replace(data=fire.data[:length]))
        told = [(m.coil, m.seq, m.reason) for m in of(CoilRefused, step()[0])]
        assert told == ([(2, 200, Reason.MALFORMED)] if length >= 3 else [])

    def test_a_pulse_is_refused_whatever_it_asks_and_the_dipole_is_driven(self, step):
        fires = [CoilFire(level, coil, 9 + level, 0, 3000) for level in (-3, 0, 1) for coil in (0, 2)]
        _, drive = step(*fires, CoilDipole(*ASKED))
        assert drive.dipole == ASKED
        refused = of(CoilRefused, step()[0])
        assert [(m.coil, m.seq, m.reason) for m in refused] == [
            (fire.coil, fire.seq, Reason.WRONG_BOARD) for fire in fires
        ]
        assert [m.counter for m in refused] == list(range(6))

    def test_a_damaged_request_drives_nothing_and_is_named_if_it_can_be(self, step, board):
        good = CoilDipole(*ASKED, counter=11).encode()
        flipped = Frame(good.can_id, good.data[:-1] + bytes([good.data[-1] ^ 1]))
        short, empty = Frame(good.can_id, good.data[:4]), Frame(good.can_id, b"")
        fire = CoilFire(1, 2, 77, 0, 3000).encode()
        broken = Frame(fire.can_id, fire.data[:-1] + bytes([fire.data[-1] ^ 1]))
        _, drive = step(flipped, short, empty, broken, Frame(good.can_id | EXTENDED_FLAG, good.data))
        assert drive.dipole == NONE
        assert board.rejects == 5
        assert reasons(step()[0]) == [(11, Reason.MALFORMED), (11, Reason.MALFORMED), (77, Reason.MALFORMED)]

    def test_every_single_flipped_bit_is_found(self, step):
        good = CoilDipole(*ASKED, counter=5).encode()
        for bit in range(64):
            data = (int.from_bytes(good.data, "little") ^ 1 << bit).to_bytes(8, "little")
            assert step(Frame(good.can_id, data))[1].dipole == NONE

    def test_frames_for_others_are_passed_over(self, step, board):
        _, drive = step(Sync(0, 0), TickDone(0, 0), CoilStatus(3, 1, 1, 1, 0, 1), CoilDipoleStatus(*ASKED))
        assert drive.dipole == NONE
        assert board.rejects == 0
        assert reasons(step()[0]) == []

    def test_a_flood_is_not_answered_by_a_flood(self, step):
        step(*[CoilFire(1, 0, k, 0, 3000) for k in range(300)])
        assert len(of(CoilRefused, step()[0])) == MAX_REFUSALS
        assert of(CoilRefused, step()[0]) == []


def test_the_pulsed_board_never_drives_a_dipole():
    board = CoilDriver(CoilLimits(1, backoff_ms=0))
    for tick in range(300):
        board.begin_tick(tick, 0.0)
        board.receive(CoilDipole(*ASKED, counter=tick).encode())
        assert board.drive() == OFF


def alterations():
    frame = st.sampled_from([CoilDipole(*ASKED).encode(), CoilFire(2, 1, 3, 0, 3000).encode()])
    return st.one_of(
        frame,
        st.builds(lambda m: CoilDipole(*m).encode(), st.tuples(*[st.floats(-1.0, 1.0)] * 3)),
        st.builds(Frame, st.sampled_from([CoilDipole.ID, CoilFire.ID, 0x101]), st.binary(max_size=8)),
    )


@pytest.mark.long
@given(st.lists(st.tuples(st.lists(alterations(), max_size=4), st.booleans()), max_size=20))
def test_whatever_comes_only_the_first_intact_dipole_of_a_tick_is_driven(ticks):
    """Against a model: what is open, what was asked, what is told."""
    board, reports = DipoleDriver(1), NONE
    for tick, (frames, late) in enumerate(ticks):
        replies = board.begin_tick(tick, 0.0)
        assert all(intact(frame) for frame in replies)
        (status,) = [CLASSES[f.can_id].decode(f.data) for f in replies if f.can_id == CoilDipoleStatus.ID]
        assert status.values()[:3] == reports
        for frame in frames:
            board.receive(frame)
        dipoles = [
            CoilDipole.decode(f.data).values()[:3] for f in frames if f.can_id == CoilDipole.ID and intact(f)
        ]
        reports = dipoles[0] if dipoles else NONE
        assert board.drive().dipole == reports
        assert all(isfinite(part) and -1.0 <= part <= 1.0 for part in reports)
        if late:
            board.receive(CoilDipole(0.5, 0.5, 0.5).encode())
            assert board.drive().dipole == reports
