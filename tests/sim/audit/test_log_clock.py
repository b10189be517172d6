"""The clock that is read off the first seconds of a log."""

import pytest

from fsw.wire.messages import CoilBoot, CoilStatus, Sync
from sim.audit.log_clock import MICRO, LogClock, read_clock
from sim.record.candump import LogEntry

IDLE = CoilStatus(0, 0, 0, 0, 0, 0).encode()


def at(*times_us, frame=IDLE):
    """Entries at these times."""
    return [LogEntry(line, time_us, "can0", frame) for line, time_us in enumerate(times_us, 1)]


def clock_of(entries, tick_hz=None):
    return read_clock(iter(entries), tick_hz)[0]


def test_every_entry_is_handed_on(bus_log):
    entries = bus_log(10, 300).entries()
    assert list(read_clock(iter(entries), None)[1]) == entries


def test_ticks_and_simulated_time(bus_log):
    log = bus_log(10, 30)
    epoch_us = log.epoch_s * 1_000_000
    assert clock_of(log.entries(7)) == LogClock(10, MICRO, log.epoch_s, epoch_us, True, False)
    log.shifts_us = dict.fromkeys(range(30), 1)
    assert clock_of(log.entries(7)) == LogClock(10, MICRO, log.epoch_s, epoch_us, False, False)


@pytest.mark.parametrize("tick_hz", [None, 10, 11, 12])
def test_a_lost_sync_makes_the_rate_known_later_not_falsely(bus_log, tick_hz):
    """After the first second both 10 and 11 fit."""
    log = bus_log(11, 60)
    assert clock_of(log.entries(without_sync={10}), tick_hz).units == 11


@pytest.mark.parametrize("entries", [99_999, 100_000])
def test_sync_is_looked_for_among_the_first_hundred_thousand_entries(entries):
    (sync,) = at(0, frame=Sync(7, 1007).encode())
    clock = clock_of([*at(0) * entries, sync], tick_hz=1)
    assert clock.epoch_s == (1000 if entries < 100_000 else None)


def test_of_nothing():
    assert clock_of([]) == LogClock(1, MICRO, None, 0, False, False)


def test_without_sync_time_begins_with_the_first_entry():
    assert clock_of(at(5, 7, 9)) == LogClock(500_000, MICRO, None, 5, False, False)
    assert clock_of(at(5, 7, 9), tick_hz=3) == LogClock(3, MICRO, None, 5, False, False)


@pytest.mark.parametrize(
    ("period_us", "units", "period"),
    [
        (100_000, 10, MICRO),
        (333_333, 3, MICRO),
        (333_334, 3, MICRO),
        (333_335, 1, 333_335),
        (1_000_000, 1, MICRO),
        (1_000_001, 1, 1_000_001),
        (500_001, 1, 500_001),
        (400_000, 1, 400_000),
        (2_500_000, 1, 2_500_000),
    ],
)
def test_without_sync_the_spacing_of_statuses_is_a_rate_where_that_is_whole(period_us, units, period):
    clock = clock_of(at(*range(0, 5 * period_us, period_us)))
    assert clock == LogClock(units, period, None, 0, False, False)


def test_without_sync_what_is_no_status_has_no_spacing():
    others = at(*range(0, 9_000_000, 500_000), frame=CoilBoot(0, 1, 0).encode())
    entries = sorted(at(0, 2_000_000, 4_000_000) + others, key=lambda entry: entry.timestamp_us)
    assert clock_of(entries).period == 2_000_000


def test_without_sync_the_least_of_the_most_common_spacings_is_the_period():
    assert clock_of(at(0, 300_000, 1_000_000)).period == 300_000
    assert clock_of(at(0, 700_000, 1_000_000)).period == 300_000


def test_syncs_that_contradict_each_other(bus_log):
    entries = [
        entry._replace(frame=Sync(tick, 1000 - tick).encode())
        for tick, entry in enumerate(at(*range(0, 9_000_000, 1_000_000)))
    ]
    assert clock_of(entries).contradictory
    assert clock_of(entries).epoch_s is None


@pytest.mark.parametrize("tick_hz", [None, 1, 10])
@pytest.mark.parametrize("tick", [40_000_000, 2**32 - 1])
def test_an_absurd_tick_is_no_rate_and_takes_no_time(tick, tick_hz):
    syncs = [Sync(0, 1000).encode(), Sync(tick, 1001).encode()]
    entries = [entry._replace(frame=frame) for entry, frame in zip(at(0, 1_000_000), syncs, strict=True)]
    assert clock_of(entries, tick_hz).epoch_s == (None if tick_hz is None else 1000)
    assert clock_of(entries).contradictory


def test_a_rate_faster_than_any_is_one_only_if_it_is_stated(bus_log):
    entries = bus_log(2000, 2050).entries(1999)
    assert clock_of(entries, 2000).units == 2000
    assert clock_of(bus_log(1000, 1050).entries()).units == 1000


@pytest.mark.parametrize("units", [1, 3, 7, 64, 1000])
def test_the_instant_of_a_timestamp_is_that_of_its_tick_to_the_microsecond(units):
    clock = LogClock(units, MICRO, 0, 0, True, False)
    for tick in range(3 * units):
        down = tick * MICRO // units
        assert clock.of_timestamp(down) == tick * MICRO
        up = -(-tick * MICRO // units)
        assert clock.of_timestamp(up) == tick * MICRO
        assert clock.of_timestamp(down - 1) == (down - 1) * units
        assert clock.of_timestamp(up + 1) == (up + 1) * units
