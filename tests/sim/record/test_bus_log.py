"""bus.log and its index as they are written: in blocks of whole ticks, compressed or not, whatever happens.

A full disk, and a kill at any moment: ``test_log_index.py``.
"""

import gzip
import hashlib
import os
from contextlib import suppress
from random import Random

import pytest

from fsw.wire.messages import FswBoot, PlantEnd, TickDone
from sim.errors import FlightError
from sim.record.binding import sha256_of
from sim.record.bus_log import BLOCK_WRITES, BusLog
from sim.record.candump import LogTruncatedError, last_lines, read_log
from sim.record.log_index import LogStanding, check_against_index, index_path

BOOT = FswBoot(0, 1, 2).encode()


def done(tick):
    return TickDone(tick, 7).encode()


@pytest.fixture
def path(tmp_path):
    return tmp_path / "bus.log"


class Clock:
    """A clock that stands until it is set."""

    now_s = 100.0

    def __call__(self):
        return self.now_s


def fly(path, ticks):
    """A log of so many writes in no time."""
    with BusLog(path, "vcan0", Clock()) as log:
        for tick in range(ticks):
            log.write(1_000_000 * tick, [done(tick), BOOT])
    return log


def ticks_on_disk(path):
    """How many writes of a ``fly`` can be read, each whole."""
    entries = list(read_log(path)) if path.stat().st_size else []
    ticks = range(len(entries) // 2)
    assert [entry.frame for entry in entries] == [frame for tick in ticks for frame in (done(tick), BOOT)]
    return len(ticks)


@pytest.fixture(params=["bus.log", "bus.log.gz"])
def either(request, tmp_path):
    """The path of a log, compressed or not."""
    return tmp_path / request.param


def test_the_first_write_is_there_at_once_and_the_others_by_blocks(either):
    with BusLog(either, "vcan0", Clock()) as log:
        for tick in range(3 * BLOCK_WRITES):
            log.write(1_000_000 * tick, [done(tick), BOOT])
            assert ticks_on_disk(either) == 1 + BLOCK_WRITES * (tick // BLOCK_WRITES)
    assert ticks_on_disk(either) == 3 * BLOCK_WRITES


@pytest.mark.parametrize(("tick_s", "behind"), [(1.0, 0), (0.5, 0), (0.125, 3)])
def test_in_real_time_it_is_never_a_second_behind(either, tick_s, behind):
    clock = Clock()
    with BusLog(either, "vcan0", clock) as log:
        for tick in range(40):
            log.write(tick, [done(tick), BOOT])
            assert tick + 1 - ticks_on_disk(either) <= behind
            clock.now_s += tick_s


@pytest.mark.long
def test_what_is_on_the_disk_is_vouched_for_at_any_time(either):
    clock = Clock()
    with BusLog(either, "vcan0", clock) as log:
        for tick in range(200):
            log.write(tick, [done(tick), BOOT])
            clock.now_s += 0.02
            standing, sentence = check_against_index(either)
            assert standing is LogStanding.OPEN
            assert "did not come to its end" in sentence
            last = index_path(either).read_text().splitlines()[-1].split()
            assert int(last[0]) == 2 * ticks_on_disk(either)
    assert check_against_index(either).standing is LogStanding.VOUCHED


def test_a_compressed_log_has_the_text_the_digest_and_the_index_of_a_plain_one(tmp_path):
    plain, compressed = tmp_path / "plain" / "bus.log", tmp_path / "compressed" / "bus.log.gz"
    plain.parent.mkdir()
    compressed.parent.mkdir()
    digests = {fly(path, 500).sha256 for path in (plain, compressed)}
    assert digests == {sha256_of(plain)} == {sha256_of(compressed)}
    assert index_path(compressed).name == "bus.log.index"
    assert index_path(compressed).read_bytes() == index_path(plain).read_bytes()
    assert gzip.decompress(compressed.read_bytes()) == plain.read_bytes()
    assert compressed.stat().st_size < 0.3 * plain.stat().st_size
    assert list(read_log(compressed)) == list(read_log(plain))
    assert last_lines(compressed)[-5:] == last_lines(plain)[-5:] == plain.read_bytes().splitlines(True)[-5:]


def test_a_compressed_log_cut_at_any_byte_is_read_as_far_as_it_goes(tmp_path):
    """As a kill within a write leaves it."""
    path = tmp_path / "bus.log.gz"
    fly(path, 2 * BLOCK_WRITES)
    frames = [entry.frame for entry in read_log(path)]
    for size in range(path.stat().st_size - 1, 100, -7):
        os.truncate(path, size)
        read = []
        with suppress(LogTruncatedError):
            read.extend(entry.frame for entry in read_log(path))
        assert read == frames[: len(read)]
        assert check_against_index(path).standing is LogStanding.BROKEN or size > path.stat().st_size - 9


@pytest.mark.long
def test_a_compressed_log_with_any_byte_altered_is_vouched_for_if_its_text_is_what_it_was(tmp_path):
    path, chosen = tmp_path / "bus.log.gz", Random(3)
    fly(path, 2 * BLOCK_WRITES)
    stored, text = path.read_bytes(), gzip.decompress(path.read_bytes())
    unharmed = 0
    for place in range(len(stored)):
        altered = bytearray(stored)
        altered[place] ^= 1 << chosen.randrange(8)
        path.write_bytes(altered)
        vouched = check_against_index(path).standing is LogStanding.VOUCHED
        unharmed += vouched
        assert not vouched or gzip.decompress(altered) == text
    assert unharmed < 0.02 * len(stored), "bits of a header, or that fill a byte"


def test_frames_of_one_write_bear_one_time_and_the_channel(path):
    with BusLog(path, "can7") as log:
        log.write(1_500_000, [BOOT, done(0)])
    entries = list(read_log(path))
    assert [(entry.timestamp_us, entry.channel) for entry in entries] == [(1_500_000, "can7")] * 2
    assert [entry.frame for entry in entries] == [BOOT, done(0)]


def test_the_digest_is_that_of_the_file(path):
    with BusLog(path, "vcan0") as log:
        assert log.sha256 == hashlib.sha256(b"").hexdigest()
        for tick in range(300):
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
