"""bus.log and its index as they are written: a whole tick at a time, whatever happens.

A full disk, and a kill at any moment: ``test_log_index.py``.
"""

import hashlib

import pytest

from fsw.wire.messages import FswBoot, PlantEnd, TickDone
from sim.errors import FlightError
from sim.record.bus_log import BusLog
from sim.record.candump import read_log
from sim.record.log_index import LogStanding, check_against_index

BOOT = FswBoot(0, 1, 2).encode()


def done(tick):
    return TickDone(tick, 7).encode()


@pytest.fixture
def path(tmp_path):
    return tmp_path / "bus.log"


def test_the_log_is_there_a_tick_at_a_time(path):
    """Each write is on disk when it returns: who reads then finds whole lines."""
    with BusLog(path, "vcan0") as log:
        for tick in range(5):
            log.write(1_000_000 * tick, [done(tick), BOOT])
            assert [e.timestamp_us for e in read_log(path)][-1] == 1_000_000 * tick
            assert path.read_bytes().count(b"\n") == 2 * (tick + 1)


def test_frames_of_one_write_bear_one_time_and_the_channel(path):
    with BusLog(path, "can7") as log:
        log.write(1_500_000, [BOOT, done(0)])
    entries = list(read_log(path))
    assert [(entry.timestamp_us, entry.channel) for entry in entries] == [(1_500_000, "can7")] * 2
    assert [entry.frame for entry in entries] == [BOOT, done(0)]


def test_the_digest_is_that_of_the_file(path):
    with BusLog(path, "vcan0") as log:
        assert log.sha256 == hashlib.sha256(b"").hexdigest()
        for tick in range(3):
            log.write(tick, [done(tick)])
            assert log.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()


def test_a_write_of_nothing_writes_nothing(path):
    with BusLog(path, "vcan0") as log:
        log.write(0, [])
    assert path.read_bytes() == b""


def test_what_was_there_is_replaced(path):
    path.write_text("an older run\n")
    with BusLog(path, "vcan0") as log:
        log.write(0, [BOOT])
    assert [entry.frame for entry in read_log(path)] == [BOOT]


def test_the_index_vouches_for_a_flight_that_came_to_its_end(path):
    with BusLog(path, "vcan0") as log:
        log.write(0, [BOOT, PlantEnd(0).encode()])
    assert check_against_index(path)[0] is LogStanding.VOUCHED


def test_it_has_no_end_mark_of_one_that_failed(path):
    def fail():
        with BusLog(path, "vcan0") as log:
            log.write(0, [BOOT])
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert check_against_index(path)[0] is LogStanding.OPEN


def test_a_folder_that_is_not_there_is_one_sentence(tmp_path):
    with pytest.raises(FlightError, match=r"bus\.log: cannot be written: No such file or directory$"):
        BusLog(tmp_path / "nowhere" / "bus.log", "vcan0")
