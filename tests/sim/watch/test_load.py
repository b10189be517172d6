"""The load of the bus: bits of frames over the time in which they came."""

import pytest

from fsw.wire.frame import EXTENDED_FLAG, Frame
from sim.bench.bus_load import BITRATE, frame_bits
from sim.watch.flight_view import Load, most_bits


@pytest.mark.parametrize("length", range(9))
@pytest.mark.parametrize("byte", [0x00, 0xFF, 0xA5, 0x1F])
def test_no_frame_has_more_bits_than_the_most(length, byte):
    assert frame_bits(Frame(0x000, bytes([byte] * length))) <= most_bits(length)
    assert most_bits(length) - frame_bits(Frame(0x2AA, bytes([0xA5] * length))) < 0.25 * most_bits(length)


def test_frames_count_for_two_seconds():
    load = Load()
    for tick in range(100):
        load.take(Frame(0x100, bytes(8)), 0.1 * tick)
    assert load.frames_per_s == pytest.approx(10.0, abs=0.6)
    assert load.part == pytest.approx(10.0 * 135 / BITRATE, rel=0.06)
    load.pass_time(13.0)
    assert (load.frames_per_s, load.part) == (0.0, 0.0)


def test_a_time_that_stands_still_or_goes_back_loses_nothing():
    load = Load()
    for now_s in (5.0, 5.0, 4.0, 5.0):
        load.take(Frame(EXTENDED_FLAG | 5, b""), now_s)
    assert load.frames_per_s == 2.0


def test_a_flight_that_follows_another_in_a_log_is_counted_by_itself():
    load = Load()
    for start_s in (0.0, 0.0):
        for tick in range(1000):
            load.take(Frame(0x100, bytes(8)), start_s + 0.1 * tick)
    assert load.frames_per_s == pytest.approx(10.0, abs=0.6)
    assert load.part == pytest.approx(10.0 * 135 / BITRATE, rel=0.06)
