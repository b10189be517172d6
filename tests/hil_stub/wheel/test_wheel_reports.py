"""What the board of a wheel says of itself: boot, status, events and heartbeat."""

from math import nan

import pytest

from fsw.wire.messages import (
    CoilFire,
    Severity,
    WheelBoot,
    WheelEvent,
    WheelHeartbeat,
    WheelStatus,
    WheelStatusResult,
    WheelTorque,
)
from hil_stub.wheel.wheel_driver import WheelBoardState, WheelDriver, WheelEventCode
from hil_stub.wheel.wheel_guard import REFUSAL_ORDER, WheelLimits

LIMITS = WheelLimits(tick_hz=1, max_torque_nm=0.002, max_speed_radps=600.0)
TORQUE_NM = 2.0**-10


@pytest.fixture
def board():
    return WheelDriver(LIMITS, table_crc=0xDEAD_BEEF)


@pytest.fixture
def tell(board, read):
    """Enters a tick: what the board says of one kind."""

    def tell(kind, tick, speed_radps=100.0):
        return [m for m in read(board.begin_tick(tick, speed_radps)) if isinstance(m, kind)]

    return tell


def spoilt(message):
    frame = message.encode()
    return frame.replace(data=frame.data[:-1] + bytes([frame.data[-1] ^ 1]))


def test_the_boot_names_the_table(tell):
    assert tell(WheelBoot, 7) == [WheelBoot(reason=0, version=1, table_crc=0xDEAD_BEEF)]


@pytest.mark.parametrize(
    ("speed_radps", "valid"), [(0.0, 1), (-0.0, 1), (-2047.0, 1), (-2048.0, 0), (-5000.0, 0), (nan, 0)]
)
def test_a_wheel_at_rest_is_measured_and_one_out_of_range_is_not(tell, speed_radps, valid):
    (status,) = tell(WheelStatus, 0, speed_radps)
    assert (status.valid, status.speed) == (valid, speed_radps if valid else 0.0)


def test_a_broken_frame_for_others_is_counted_and_is_no_malformed_torque(board, tell):
    tell(WheelStatus, 0)
    board.receive(spoilt(CoilFire(1, 0, 1, 0, 500)))
    assert board.rejects == 1
    assert tell(WheelStatus, 1)[0].result == WheelStatusResult.NONE


def test_of_several_reasons_the_first_is_told():
    order = ("WRONG_TICK", "SECOND_TORQUE", "BAD_TORQUE", "NO_SPEED", "TOO_FAST")
    assert tuple(result.name for result in REFUSAL_ORDER) == order


class TestEvents:
    @pytest.mark.parametrize("speed_radps", [-601.0, 601.0])
    def test_a_wheel_too_fast_in_either_sense_is_told_with_its_tick_and_speed(self, tell, speed_radps):
        assert tell(WheelEvent, 298) == []
        told = [event for tick in range(299, 310) for event in tell(WheelEvent, tick, speed_radps)]
        argument = round(speed_radps)
        assert told == [WheelEvent(Severity.WARNING, WheelEventCode.OVER_SPEED, 299 & 0xFF, argument)]

    def test_each_has_its_severity_and_they_are_counted(self, board, tell):
        told = []
        for tick in range(40):
            told += tell(WheelEvent, tick, (nan, 700.0, 700.0)[tick % 3])
            if tick % 3 == 1:
                board.silence()
        severity = {
            WheelEventCode.OVER_SPEED: Severity.WARNING,
            WheelEventCode.NO_SPEED: Severity.ERROR,
            WheelEventCode.DEAD_MAN: Severity.ERROR,
        }
        assert [(event.event, event.severity) for event in told[:3]] == [
            (code, severity[code])
            for code in (WheelEventCode.NO_SPEED, WheelEventCode.OVER_SPEED, WheelEventCode.DEAD_MAN)
        ]
        assert [event.counter for event in told] == [number % 16 for number in range(40)]

    def test_the_dead_man_is_told_once_however_long_it_lasted(self, board, tell):
        tell(WheelEvent, 0)
        for _ in range(3):
            board.silence()
        told = [event.event for tick in range(1, 6) for event in tell(WheelEvent, tick)]
        assert told == [WheelEventCode.DEAD_MAN]


def test_after_the_dead_man_a_torque_that_came_too_late_for_its_tick_is_refused(board, tell):
    """Also the first of that tick."""
    tell(WheelStatus, 0)
    board.silence()
    board.receive(WheelTorque(TORQUE_NM, 0).encode())
    assert board.drive() == 0.0
    (status,) = tell(WheelStatus, 1)
    assert (status.torque, status.result) == (0.0, WheelStatusResult.WRONG_TICK)


class TestHeartbeat:
    @pytest.mark.parametrize(
        ("speed_radps", "torque_nm", "state"),
        [
            (100.0, 0.0, WheelBoardState.READY),
            (100.0, -TORQUE_NM, WheelBoardState.DRIVEN),
            (700.0, 0.0, WheelBoardState.READY),
            (700.0, -TORQUE_NM, WheelBoardState.DRIVEN),
            (nan, 0.0, WheelBoardState.FAULT),
        ],
    )
    def test_it_tells_what_was_driven_in_the_tick_before_and_a_wheel_without_a_speed(
        self, board, tell, speed_radps, torque_nm, state
    ):
        for tick in range(60):
            tell(WheelHeartbeat, tick, speed_radps)
        if torque_nm:
            board.receive(WheelTorque(torque_nm, 59).encode())
        (beat,) = tell(WheelHeartbeat, 60, speed_radps)
        assert beat.state == state

    def test_it_tells_the_rejects_of_all_the_time(self, board, tell):
        tell(WheelHeartbeat, 0)
        board.receive(spoilt(WheelTorque(TORQUE_NM, 0)))
        board.receive(spoilt(CoilFire(1, 0, 1, 0, 500)))
        assert tell(WheelHeartbeat, 60) == [WheelHeartbeat(0, rejects=2, slips=59, tick=60)]


@pytest.mark.parametrize(("tick_hz", "hold_ms"), [(1, 1000), (3, 334), (7, 143), (64, 16), (1000, 1)])
def test_by_the_clock_a_torque_lasts_a_tick_rounded_up(tick_hz, hold_ms):
    board = WheelDriver(WheelLimits(tick_hz, LIMITS.max_torque_nm, LIMITS.max_speed_radps))
    board.begin_tick(0, 10.0, clock_ms=70_000)
    board.receive(WheelTorque(TORQUE_NM, 0).encode(), clock_ms=70_020)
    board.pass_time(70_020 + hold_ms - 1)
    assert board.drive() == TORQUE_NM
    board.pass_time(70_020 + hold_ms)
    assert board.drive() == 0.0
