"""The board of a reaction wheel: what it drives, what it refuses and says, and that it then coasts."""

from math import inf, nan

import pytest

from fsw.wire.messages import (
    CLASSES,
    CoilFire,
    WheelBoot,
    WheelEvent,
    WheelHeartbeat,
    WheelStatus,
    WheelStatusResult,
    WheelTorque,
    intact,
)
from hil_stub.wheel.wheel_driver import WheelBoardState, WheelDriver, WheelEventCode
from hil_stub.wheel.wheel_guard import WheelLimits

LIMITS = WheelLimits(tick_hz=2, max_torque_nm=0.002, max_speed_radps=600.0)
TORQUE_NM = 2.0**-10
"""On the wire to the last bit, and within the limit."""


def said(frames):
    assert all(intact(frame) for frame in frames)
    return [CLASSES[frame.can_id].decode(frame.data) for frame in frames]


def status_of(frames):
    (status,) = [message for message in said(frames) if isinstance(message, WheelStatus)]
    return status


class Rig:
    """The board, tick by tick: requests in, its torque and the status that tells of it out."""

    def __init__(self, limits=LIMITS):
        self.board, self.tick = WheelDriver(limits), -1

    def step(self, *requests, speed_radps=100.0):
        self.tick += 1
        frames = self.board.begin_tick(self.tick, speed_radps)
        for request in requests:
            self.board.receive(request if hasattr(request, "can_id") else request.encode())
        return frames, self.board.drive()

    def ask(self, torque_nm, tick=None, speed_radps=100.0):
        """The torque driven in answer, and what the next status says of it."""
        named = self.tick + 1 if tick is None else tick
        _, driven_nm = self.step(WheelTorque(torque_nm, named), speed_radps=speed_radps)
        frames, after_nm = self.step(speed_radps=speed_radps)
        assert after_nm == 0.0  # a torque ends by itself
        status = status_of(frames)
        assert status.torque == driven_nm
        return driven_nm, status.result


def test_a_torque_is_driven_in_the_tick_it_answers_and_no_longer():
    rig = Rig()
    assert rig.ask(TORQUE_NM) == (TORQUE_NM, WheelStatusResult.DRIVEN)
    frames, driven_nm = rig.step()
    assert driven_nm == 0.0
    assert status_of(frames).values()[1:4:2] == (WheelStatusResult.NONE, 0.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("torque_nm", "result"),
    [(0.002, WheelStatusResult.DRIVEN), (0.002 + 2.0**-23, WheelStatusResult.BAD_TORQUE)],
)
def test_the_limit_of_the_torque_is_sharp(sign, torque_nm, result):
    driven_nm, found = Rig().ask(sign * torque_nm)
    assert found == result
    assert (driven_nm == 0.0) == (result is not WheelStatusResult.DRIVEN)


@pytest.mark.parametrize("tick", [-1, 1, 128, 255])
def test_a_request_that_answers_another_tick_is_refused(tick):
    rig = Rig()
    rig.step()
    assert rig.ask(TORQUE_NM, tick=rig.tick + 1 + tick) == (0.0, WheelStatusResult.WRONG_TICK)


def test_a_request_before_the_first_tick_or_after_the_drive_answers_none():
    board = WheelDriver(LIMITS)
    board.receive(WheelTorque(TORQUE_NM, 0).encode())
    frames = board.begin_tick(0, 0.0)
    assert status_of(frames).result == WheelStatusResult.WRONG_TICK
    assert board.drive() == 0.0
    board.receive(WheelTorque(TORQUE_NM, 0).encode())
    frames = board.begin_tick(1, 0.0)
    assert (status_of(frames).result, status_of(frames).torque) == (WheelStatusResult.WRONG_TICK, 0.0)
    assert board.drive() == 0.0


@pytest.mark.parametrize("speed_radps", [600.0, 900.0, -600.0, -900.0])
def test_a_wheel_at_its_limit_is_slowed_down_but_not_sped_up(speed_radps):
    faster = TORQUE_NM if speed_radps > 0.0 else -TORQUE_NM
    assert Rig().ask(faster, speed_radps=speed_radps) == (0.0, WheelStatusResult.TOO_FAST)
    assert Rig().ask(-faster, speed_radps=speed_radps) == (-faster, WheelStatusResult.DRIVEN)
    below = speed_radps * 0.999 * 600.0 / abs(speed_radps)
    assert Rig().ask(faster, speed_radps=below) == (faster, WheelStatusResult.DRIVEN)


@pytest.mark.parametrize("speed_radps", [nan, inf, -inf, 2048.0])
def test_without_a_measured_speed_nothing_is_driven(speed_radps):
    rig = Rig()
    assert rig.ask(TORQUE_NM, speed_radps=speed_radps) == (0.0, WheelStatusResult.NO_SPEED)
    assert not status_of(rig.step(speed_radps=speed_radps)[0]).valid


def test_the_second_torque_of_a_tick_is_refused_and_the_first_stays():
    rig = Rig()
    _, driven_nm = rig.step(WheelTorque(TORQUE_NM, 0), WheelTorque(-TORQUE_NM, 0))
    assert driven_nm == TORQUE_NM
    assert status_of(rig.step()[0]).result == WheelStatusResult.SECOND_TORQUE


@pytest.mark.parametrize("byte", range(6))
def test_a_broken_request_is_refused_and_counted(byte):
    rig = Rig()
    good = WheelTorque(TORQUE_NM, 0).encode()
    data = bytearray(good.data)
    data[byte] ^= 0x10
    _, driven_nm = rig.step(good.replace(data=bytes(data)))
    assert (driven_nm, rig.board.rejects) == (0.0, 1)
    assert status_of(rig.step()[0]).result == WheelStatusResult.MALFORMED


def test_frames_for_others_do_not_matter():
    rig = Rig()
    _, driven_nm = rig.step(WheelTorque(TORQUE_NM, 0), CoilFire(1, 0, 1, 0, 500))
    assert (driven_nm, rig.board.rejects) == (TORQUE_NM, 0)


def test_over_skipped_ticks_the_wheel_coasts():
    board = WheelDriver(LIMITS)
    board.begin_tick(0, 10.0)
    board.receive(WheelTorque(TORQUE_NM, 0).encode())
    assert board.drive() == TORQUE_NM
    status = status_of(board.begin_tick(3, 10.0))
    assert (status.torque, status.result) == (0.0, WheelStatusResult.NONE)
    assert board.drive() == 0.0
    assert board.begin_tick(3, 10.0) == []


def test_the_speed_is_told_as_measured():
    frames, _ = Rig().step(speed_radps=-123.4567)
    assert status_of(frames).speed == pytest.approx(-123.4567, abs=2.0**-13)


def test_it_boots_once_and_beats_every_minute():
    rig = Rig()
    steps = [said(rig.step()[0]) for _ in range(3 * 120 + 1)]
    assert [tick for tick, frames in enumerate(steps) if any(isinstance(m, WheelBoot) for m in frames)] == [0]
    beats = [(tick, m) for tick, frames in enumerate(steps) for m in frames if isinstance(m, WheelHeartbeat)]
    assert [tick for tick, _ in beats] == [120, 240, 360]
    assert {m.state for _, m in beats} == {WheelBoardState.READY}
    counters = [m.counter for frames in steps for m in frames if isinstance(m, WheelStatus)]
    assert counters == [tick & 0xF for tick in range(361)]


def test_each_fault_is_told_once_when_it_is_found():
    rig = Rig()
    speeds = [599.0, 601.0, 602.0, 600.0, 601.0, nan, nan, 5.0]
    told = [
        [m.event for m in said(rig.step(speed_radps=speed)[0]) if isinstance(m, WheelEvent)]
        for speed in speeds
    ]
    over, gone = [WheelEventCode.OVER_SPEED], [WheelEventCode.NO_SPEED]
    assert told == [[], over, [], [], over, gone, [], []]


class TestClock:
    """A board with a clock of its own ends a torque by it too."""

    def test_a_torque_ends_after_a_tick_though_no_next_one_comes(self):
        board = WheelDriver(LIMITS)
        board.begin_tick(0, 10.0, clock_ms=1000)
        board.receive(WheelTorque(TORQUE_NM, 0).encode(), clock_ms=1010)
        board.pass_time(1509)
        assert board.drive() == TORQUE_NM
        board.pass_time(1510)
        assert board.drive() == 0.0

    def test_it_is_reported_though_it_has_ended(self):
        board = WheelDriver(LIMITS)
        board.begin_tick(0, 10.0, clock_ms=1000)
        board.receive(WheelTorque(TORQUE_NM, 0).encode(), clock_ms=1010)
        board.pass_time(1510)
        status = status_of(board.begin_tick(1, 10.0, clock_ms=1520))
        assert (status.torque, status.result) == (TORQUE_NM, WheelStatusResult.DRIVEN)
        assert board.drive() == 0.0
        assert status_of(board.begin_tick(2, 10.0, clock_ms=2020)).torque == 0.0

    def test_after_it_no_second_torque_is_taken_in_the_same_tick(self):
        board = WheelDriver(LIMITS)
        board.begin_tick(0, 10.0, clock_ms=1000)
        board.receive(WheelTorque(TORQUE_NM, 0).encode(), clock_ms=1010)
        board.pass_time(1510)
        board.receive(WheelTorque(-TORQUE_NM, 0).encode(), clock_ms=1511)
        assert board.drive() == 0.0
        status = status_of(board.begin_tick(1, 10.0, clock_ms=1520))
        assert (status.torque, status.result) == (TORQUE_NM, WheelStatusResult.SECOND_TORQUE)

    def test_silence_ends_it_at_once_and_is_told_in_the_next_tick(self):
        board = WheelDriver(LIMITS)
        board.begin_tick(0, 10.0, clock_ms=0)
        board.receive(WheelTorque(TORQUE_NM, 0).encode(), clock_ms=1)
        board.silence()
        assert board.drive() == 0.0
        board.receive(WheelTorque(TORQUE_NM, 0).encode(), clock_ms=2)
        assert board.drive() == 0.0
        events = [m.event for m in said(board.begin_tick(1, 10.0, clock_ms=3)) if isinstance(m, WheelEvent)]
        assert events == [WheelEventCode.DEAD_MAN]


WRONG = (("tick_hz", (0, -1)), ("max_torque_nm", (0.0, nan, 0.5)), ("max_speed_radps", (-1.0, 2048.0)))


@pytest.mark.parametrize(("name", "value"), [(name, value) for name, values in WRONG for value in values])
def test_limits_that_cannot_be_are_refused(name, value):
    sound = {"tick_hz": 1, "max_torque_nm": 0.1, "max_speed_radps": 100.0}
    with pytest.raises(ValueError, match=name):
        WheelLimits(**(sound | {name: value}))
