"""Magnetometer and Sun sensor boards on their frames."""

from math import inf, nan, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fsw.wire.messages import MagBoot, MagField, MagHeartbeat, SunBoot, SunHeartbeat, SunVector
from hil_stub.sensors.magnetometer import Magnetometer
from hil_stub.sensors.sun_sensor import SunSensor

FIELD_T = (21.4e-6, -3.2e-6, 40.002e-6)
DIAGONAL = (1 / sqrt(3), -1 / sqrt(3), 1 / sqrt(3))
BOARDS = pytest.mark.parametrize(
    ("make", "boot", "sample", "heartbeat", "vector"),
    [
        (Magnetometer, MagBoot, MagField, MagHeartbeat, FIELD_T),
        (SunSensor, SunBoot, SunVector, SunHeartbeat, DIAGONAL),
    ],
    ids=["magnetometer", "sun"],
)


@BOARDS
class TestBoth:
    def test_boot_comes_first_and_a_sample_in_every_tick(self, read, make, boot, sample, heartbeat, vector):
        board = make(1)
        kinds = [[type(m) for m in read(board.begin_tick(tick, vector, True))] for tick in range(60)]
        assert kinds == [[boot, sample]] + [[sample]] * 59

    def test_the_sample_counter_rises(self, read, make, boot, sample, heartbeat, vector):
        board = make(1)
        samples = [read(board.begin_tick(tick, vector, True))[-1] for tick in range(40)]
        assert [m.counter for m in samples] == [n % 16 for n in range(40)]

    @pytest.mark.parametrize("hz", [1, 3, 50])
    def test_a_heartbeat_every_60_s_after_boot(self, read, make, boot, sample, heartbeat, vector, hz):
        board = make(hz)
        beats = [
            tick
            for tick in range(7, 7 + 121 * hz)
            if [type(m) for m in read(board.begin_tick(tick, vector, True))][1:] == [heartbeat]
        ]
        assert beats == [7 + 60 * hz, 7 + 120 * hz]

    def test_the_boot_message_and_the_heartbeat_have_nothing_to_complain_of(
        self, read, make, boot, sample, heartbeat, vector
    ):
        board = make(1)
        replies = [message for tick in range(61) for message in read(board.begin_tick(tick, vector, True))]
        assert replies[0] == boot(reason=0, version=1, table_crc=0)
        assert replies[-1] == heartbeat(state=0, rejects=0, slips=0, tick=60)

    @pytest.mark.parametrize("backwards", [0, 1, 10**6])
    def test_a_tick_that_does_not_rise_is_ignored(
        self, read, make, boot, sample, heartbeat, vector, backwards
    ):
        board = make(1)
        board.begin_tick(5, vector, True)
        assert board.begin_tick(5 - backwards, vector, True) == []
        (after,) = read(board.begin_tick(6, vector, True))
        assert after.counter == 1

    @pytest.mark.parametrize("axis", range(3))
    @pytest.mark.parametrize("value", [nan, inf, -inf, 1e300, -1e300])
    def test_what_is_not_a_number_or_out_of_range_is_invalid(
        self, read, make, boot, sample, heartbeat, vector, axis, value
    ):
        wrong = list(vector)
        wrong[axis] = value
        board = make(1)
        assert read(board.begin_tick(0, tuple(wrong), True))[-1].valid == 0
        assert read(board.begin_tick(1, vector, True))[-1].valid == 1, "and passes"

    @pytest.mark.parametrize("hz", [0, -1])
    def test_a_rate_that_is_none_is_refused(self, make, boot, sample, heartbeat, vector, hz):
        with pytest.raises(ValueError, match="tick_hz"):
            make(hz)

    @pytest.mark.parametrize("hz", [1.0, None])
    def test_so_is_what_is_no_integer(self, make, boot, sample, heartbeat, vector, hz):
        with pytest.raises((ValueError, TypeError)):
            make(hz)


class TestMagnetometer:
    def test_the_field_is_in_nanotesla(self, read):
        (_, field) = read(Magnetometer(1).begin_tick(0, FIELD_T, True))
        assert field == MagField(1, 21_400.0, -3200.0, 40_002.0)

    @given(b_nt=st.tuples(*[st.floats(-65_536, 65_534)] * 3))
    def test_in_range_it_is_right_within_half_a_step(self, b_nt):
        (_, frame) = Magnetometer(1).begin_tick(0, tuple(b * 1e-9 for b in b_nt), True)
        field = MagField.decode(frame.data)
        assert all(abs(ours - b) <= 1.0 + 1e-9 for ours, b in zip(field.values()[1:4], b_nt, strict=True))

    @pytest.mark.parametrize(
        ("b_nt", "valid", "shown"),
        [
            (65_533.0, 1, 65_532.0),
            (65_536.0, 0, 65_534.0),
            (70_000.0, 0, 65_534.0),
            (-65_535.0, 1, -65_536.0),
            (-65_538.0, 0, -65_536.0),
            (-70_000.0, 0, -65_536.0),
        ],
    )
    @pytest.mark.parametrize("axis", range(3))
    def test_beyond_the_range_it_saturates_and_says_so(self, read, axis, b_nt, valid, shown):
        b_body_t = [0.0, 0.0, 0.0]
        b_body_t[axis] = b_nt * 1e-9
        (_, field) = read(Magnetometer(1).begin_tick(0, tuple(b_body_t), True))
        assert field.valid == valid
        assert field.values()[1 + axis] == shown

    def test_a_failed_self_test_makes_it_invalid(self, read):
        assert read(Magnetometer(1).begin_tick(0, FIELD_T, False))[-1].valid == 0


class TestSunSensor:
    def test_the_direction(self, read):
        (_, sun) = read(SunSensor(1).begin_tick(0, DIAGONAL, True))
        assert sun.valid == 1
        assert (sun.s_x, sun.s_y, sun.s_z) == pytest.approx(DIAGONAL, abs=2**-15)

    @pytest.mark.parametrize("axis", range(3))
    @pytest.mark.parametrize("sign", [-1.0, 1.0])
    def test_along_an_axis_it_is_exact(self, read, axis, sign):
        along = tuple(sign if other == axis else 0.0 for other in range(3))
        assert read(SunSensor(1).begin_tick(0, along, True))[-1].values()[:4] == (1, *along)

    @pytest.mark.parametrize(
        ("component", "valid"), [(-2.0, 1), (-2.0001, 0), (2.0 - 2.0**-14, 1), (2.0, 0), (-2.1, 0), (2.1, 0)]
    )
    @pytest.mark.parametrize("axis", range(3))
    def test_the_range_is_that_of_the_signal(self, read, axis, component, valid):
        sun_body = [0.0, 0.0, 0.0]
        sun_body[axis] = component
        (_, sun) = read(SunSensor(1).begin_tick(0, tuple(sun_body), True))
        assert sun.valid == valid
        assert sun.values()[1 + axis] == (component if valid else 0.0)

    def test_in_the_dark_no_direction_is_on_the_bus(self, read):
        assert read(SunSensor(1).begin_tick(0, DIAGONAL, False))[-1] == SunVector(0, 0.0, 0.0, 0.0)
