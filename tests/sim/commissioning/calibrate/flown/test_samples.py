"""The samples of a log, tick by tick: their time, and ticks that are missing or wrong."""

import numpy as np
import pytest

from fsw.wire.candump_line import format_line, format_time
from fsw.wire.messages import CoilStatus, MagField, Sync
from sim.commissioning.calibrate.flown.samples import read_samples
from sim.errors import HarnessError

EPOCH_UNIX_S = 1_742_428_800


def sync(tick, tick_hz, stamp_s=None):
    """A SYNC as the plant sends it, at the time of the tick unless another is given."""
    stamp_s = EPOCH_UNIX_S + tick / tick_hz if stamp_s is None else stamp_s
    frame = Sync(tick, EPOCH_UNIX_S + tick // tick_hz).encode()
    return format_line(format_time(round(stamp_s * 1e6)), "can0", frame)


@pytest.fixture
def log(tmp_path):
    """Writes a log of these lines."""

    def write(*lines):
        path = tmp_path / "bus.log"
        path.write_text("".join(lines))
        return path

    return write


@pytest.mark.parametrize("first", [0, 15, 20])
def test_a_tick_has_the_time_that_the_plant_gives_it_wherever_the_log_begins(log, first):
    samples = read_samples(log(*(sync(tick, 10) for tick in range(first, 40))), 10)
    assert samples.tick.tolist() == list(range(first, 40))
    assert samples.unix_s == pytest.approx(EPOCH_UNIX_S + np.arange(first, 40) / 10, abs=1e-6)


def test_so_has_one_that_is_earlier_than_the_first_in_the_log(log):
    samples = read_samples(log(*(sync(tick, 10) for tick in (15, 16, 3, 4))), 10)
    assert samples.tick.tolist() == list(range(3, 17))
    assert samples.unix_s[[0, -1]] == pytest.approx(EPOCH_UNIX_S + np.array([0.3, 1.6]), abs=1e-6)


def test_ticks_that_are_missing_have_no_samples(log):
    def field(tick):
        return format_line(
            format_time(EPOCH_UNIX_S * 10**6), "can0", MagField(1, 20.0, 40.0, -60.0, tick).encode()
        )

    samples = read_samples(log(field(0), sync(0, 1), field(4), sync(4, 1)), 1)
    assert np.isnan(samples.field_nt[1:4]).all()
    assert samples.field_nt[[0, 4]].tolist() == [[20.0, 40.0, -60.0]] * 2
    assert samples.level.tolist() == [0] * 5
    assert not samples.reported.any()


@pytest.mark.parametrize("wild", [5_000, 4_294_967_295])
def test_a_tick_that_the_time_stamps_do_not_bear_out_is_named(log, wild):
    path = log(sync(0, 1), sync(1, 1), sync(wild, 1, EPOCH_UNIX_S + 2), sync(3, 1))
    with pytest.raises(HarnessError) as error:
        read_samples(path, 1)
    assert str(error.value) == (
        f"{path}: a SYNC names tick {wild}, {wild - 3} s after tick 3, "
        "from which it is 1 s by the time stamps: it cannot be right"
    )


def test_nor_may_the_time_stamps_be_as_wrong_as_the_tick(log):
    with pytest.raises(HarnessError, match="a SYNC names tick 4000000000"):
        read_samples(log(sync(0, 1), sync(4_000_000_000, 1)), 1)


def test_a_recording_that_paused_is_filled(log):
    """Some hours, as the stamps say; and less than one where the flight had no pace, and they say nothing."""
    assert len(read_samples(log(sync(0, 1), sync(20_000, 1)), 1)) == 20_001
    assert len(read_samples(log(sync(0, 1), sync(3_000, 1, EPOCH_UNIX_S + 0.5)), 1)) == 3_001


@pytest.mark.parametrize("ticks", [1, 2, 7, 20])
def test_ticks_near_a_pulse_are_not_free_in_a_log_of_any_length(log, ticks):
    def lines(tick):
        status = CoilStatus(0 if tick else 2, 0, 0, 0, 0, 0, tick & 0xF).encode()
        frames = (MagField(1, 20_000.0, 0.0, 0.0, tick & 0xF).encode(), status)
        stamp = format_time((EPOCH_UNIX_S + tick) * 1_000_000)
        return [*(format_line(stamp, "can0", frame) for frame in frames), sync(tick, 1)]

    samples = read_samples(log(*(line for tick in range(ticks) for line in lines(tick))), 1)
    assert samples.free(3).tolist() == [tick > 3 for tick in range(ticks)]


@pytest.mark.parametrize(("level", "coil"), [(4, 1), (-8, 0), (2, 3)])
def test_a_level_or_a_coil_that_no_board_has_is_refused_with_its_line(log, level, coil):
    status = CoilStatus(level, coil, 0, 100, 0, 7).encode()
    path = log(sync(0, 1), format_line(format_time(EPOCH_UNIX_S * 10**6), "can0", status), sync(1, 1))
    with pytest.raises(HarnessError) as error:
        read_samples(path, 1)
    said = f"{path}: line 2: a COIL_STATUS of coil {coil} at level {level}: there are coils 0 to 2"
    assert str(error.value).startswith(said)


def test_of_a_tick_with_two_statuses_that_differ_nothing_is_told(log):
    """The frame of the tick before once more: a coil may have been driven or not."""
    driven, idle = CoilStatus(3, 1, 0, 300, 0, 7), CoilStatus(0, 1, 0, 0, 0, 7)
    lines = [sync(0, 1)]
    for tick, statuses in enumerate(
        [(driven,), (idle, driven), (driven, driven), (idle, CoilStatus(0, 2, 0, 0, 0, 8))], 1
    ):
        for status in statuses:
            lines.append(format_line(format_time((EPOCH_UNIX_S + tick) * 10**6), "can0", status.encode()))
        lines.append(sync(tick, 1))
    samples = read_samples(log(*lines), 1)
    assert samples.reported.tolist() == [False, True, False, True, True]
    assert samples.level.tolist() == [0, 3, 0, 3, 0]
