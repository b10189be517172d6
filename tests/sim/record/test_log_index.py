"""The index of a log: what it confirms, and what it detects."""

import errno
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from random import Random

import pytest

from fsw.wire.messages import FswBoot, MagField, TickDone
from sim.errors import FlightError
from sim.record import bus_log
from sim.record.binding import sha256_of
from sim.record.bus_log import BLOCK_WRITES, BusLog
from sim.record.candump import LogTruncatedError, read_log
from sim.record.log_index import SUFFIX, LogIndex, LogStanding, check_against_index, index_path

TICKS = 3 * BLOCK_WRITES + 11


def frames(tick):
    return [MagField(1, 20_000.0 + tick, -7000.0, 31_000.0, tick & 0xF).encode(), TickDone(tick, 7).encode()]


def write(log, ticks=TICKS):
    """What a flight of so many ticks leaves."""
    fill(BusLog(log, "vcan0", lambda: 0.0), ticks)


def fill(file, ticks=TICKS):
    """The same, with a log that was opened."""
    with file:
        file.write(0, [FswBoot(0, 1, 2).encode()])
        for tick in range(ticks):
            file.write(1_000_000 * tick, frames(tick))


@pytest.fixture
def log(tmp_path):
    """A log with its index, of five blocks: that of FSW_BOOT, and four of ticks."""
    write(tmp_path / "bus.log")
    return tmp_path / "bus.log"


def test_a_log_as_it_was_flown_is_vouched_for(log):
    assert check_against_index(log) == (LogStanding.VOUCHED, "")
    assert check_against_index(log).holds
    assert len(index_path(log).read_text().splitlines()) == 1 + 5 + 1
    assert index_path(log).read_text().count(" end ") == 1


@pytest.mark.parametrize("ticks", [0, 1, BLOCK_WRITES - 1, BLOCK_WRITES, 2 * BLOCK_WRITES - 1])
def test_whatever_its_length(tmp_path, ticks):
    write(tmp_path / "bus.log", ticks)
    assert check_against_index(tmp_path / "bus.log").standing is LogStanding.VOUCHED


def test_the_index_is_beside_the_log_and_bears_its_name(log):
    assert index_path(log) == log.with_name("bus.log" + SUFFIX)
    moved = log.rename(log.with_name("flight.log"))
    assert check_against_index(moved).standing is LogStanding.UNKNOWN


def test_a_log_without_an_index_is_unknown_and_the_sentence_says_so(log):
    index_path(log).unlink()
    standing, sentence = check_against_index(log)
    assert standing is LogStanding.UNKNOWN
    assert "nothing vouches" in sentence
    assert check_against_index(log).holds


# --- whatever is cut or altered


def test_a_log_cut_at_any_byte_is_truncated(log):
    """From its end backwards."""
    whole = log.stat().st_size
    ends = [int(line.split()[1]) for line in index_path(log).read_text().splitlines()[1:]]
    near_ends = {size for end in ends for size in range(end - 60, end + 60)}
    for size in sorted(near_ends | set(range(0, whole, 41)), reverse=True):
        if 0 <= size < whole:
            os.truncate(log, size)
            told = next(end for end in ends if end > size)
            assert check_against_index(log) == (
                LogStanding.BROKEN,
                f"truncated: the log has {size} bytes, its index covers {told}",
            )


@pytest.mark.long
def test_any_byte_of_the_log_that_is_altered_is_found_and_in_its_block(log):
    whole, chosen = log.read_bytes(), Random(8)
    lines_in_a_block = 2 * BLOCK_WRITES
    for place in range(0, len(whole), 23):
        altered = bytearray(whole)
        altered[place] ^= 1 << chosen.randrange(8)
        log.write_bytes(altered)
        standing, sentence = check_against_index(log)
        assert standing is LogStanding.BROKEN
        first, last = (int(word) for word in sentence.split() if word.isdigit())
        assert first <= whole[: place + 1].count(b"\n") + 1 <= last + (whole[place : place + 1] == b"\n")
        assert last - first < lines_in_a_block


@pytest.mark.parametrize("more", [b"x", b"\n", b"(0000000300.000000) vcan0 110#00\n"])
def test_what_is_added_at_the_end_is_found(log, more):
    log.write_bytes(log.read_bytes() + more)
    assert check_against_index(log).sentence == f"altered: something was added after line {2 * TICKS + 1}"


def test_lines_that_change_places_are_found(log):
    lines = log.read_bytes().splitlines(keepends=True)
    lines[300], lines[301] = lines[301], lines[300]
    log.write_bytes(b"".join(lines))
    assert check_against_index(log).sentence.startswith("altered: lines ")


def test_blocks_that_change_places_are_found_although_each_is_as_it_was(log):
    whole = log.read_bytes()
    sizes = [int(line.split()[1]) for line in index_path(log).read_text().splitlines()[1:3]]
    log.write_bytes(whole[sizes[0] : sizes[1]] + whole[: sizes[0]] + whole[sizes[1] :])
    assert not check_against_index(log).holds


@pytest.mark.long
def test_an_index_cut_at_any_byte_vouches_no_more(log):
    whole = index_path(log).read_bytes()
    for size in range(len(whole)):
        index_path(log).write_bytes(whole[:size])
        standing, sentence = check_against_index(log)
        assert standing in (LogStanding.OPEN, LogStanding.BROKEN)
        assert sentence
        assert (standing is LogStanding.BROKEN) == (b"\n" not in whole[:size])


@pytest.mark.long
def test_an_index_with_any_bit_altered_vouches_no_more(tmp_path):
    log = tmp_path / "bus.log"
    write(log, BLOCK_WRITES + 3)
    whole = index_path(log).read_bytes()
    for place in range(len(whole)):
        for bit in range(8):
            altered = bytearray(whole)
            altered[place] ^= 1 << bit
            index_path(log).write_bytes(altered)
            standing, sentence = check_against_index(log)
            assert standing in (LogStanding.OPEN, LogStanding.BROKEN), (place, bit)
            assert (standing is LogStanding.OPEN) == (place == len(whole) - 1), "but for its last newline"
            assert "bus.log.index" in sentence


def sealed(text):
    """A line of an index with the CRC that belongs to it."""
    from zlib import crc32

    return b"%b %08x\n" % (text, crc32(text))


def test_an_index_of_another_version_is_reported(log):
    lines = index_path(log).read_bytes().splitlines(keepends=True)
    index_path(log).write_bytes(b"".join([sealed(b"torquer-log-index 2"), *lines[1:]]))
    assert check_against_index(log) == (
        LogStanding.BROKEN,
        "bus.log.index is of version 2, and only version 1 can be read",
    )


@pytest.mark.parametrize(
    "content", [b"", b"\n", b"\xff" * 500, b"torquer-log-index\n", sealed(b"torquer-log-index"), sealed(b"x")]
)
def test_an_index_that_is_none_is_no_error(log, content):
    index_path(log).write_bytes(content)
    assert check_against_index(log).standing is LogStanding.BROKEN


def test_an_index_that_cannot_be_read_is_no_error(log):
    index_path(log).unlink()
    index_path(log).mkdir()
    assert check_against_index(log).standing is LogStanding.BROKEN


@pytest.mark.parametrize("block", [(5, 10), (5, 10**14)])
def test_a_well_sealed_line_that_makes_no_sense_is_no_error(log, block):
    lines = index_path(log).read_bytes().splitlines(keepends=True)
    lines[2] = sealed(b"%d %d %b" % (*block, b"0" * 64))
    index_path(log).write_bytes(b"".join(lines))
    assert check_against_index(log).standing is LogStanding.BROKEN


# --- a flight that does not come to its end

CHILD = """
import sys
from pathlib import Path
sys.path.insert(0, {folder!r})
from test_log_index import BusLog, frames
with BusLog(Path({path!r}), "vcan0") as log:
    print("go", flush=True)
    for tick in range(10_000_000):
        log.write(1_000_000 * tick, frames(tick))
"""


def whole_lines(log):
    """A kill can cut a write in two, and with it the last line, which ``read_log`` then tells of."""
    count = 0
    with suppress(LogTruncatedError):
        for _ in read_log(log):
            count += 1
    return count


@pytest.mark.long
@pytest.mark.parametrize("delay_ms", [0, 1, 3, 10, 30])
def test_a_kill_at_any_moment_leaves_a_log_that_its_index_does_not_contradict(tmp_path, delay_ms):
    log = tmp_path / "bus.log"
    code = CHILD.format(folder=os.path.dirname(__file__), path=str(log))
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    assert process.stdout.readline() == b"go\n"
    time.sleep(delay_ms / 1000.0)
    process.kill()
    assert process.wait(20) == -signal.SIGKILL
    process.stdout.close()
    standing, sentence = check_against_index(log)
    assert standing is LogStanding.OPEN
    assert "has no end mark" in sentence
    *_, vouched = [0] + [int(line.split()[0]) for line in index_path(log).read_text().splitlines()[1:]]
    lines = whole_lines(log) if log.stat().st_size else 0
    assert lines - 2 * BLOCK_WRITES <= vouched <= lines


def test_a_flight_that_fails_is_vouched_for_as_far_as_it_went(tmp_path):
    log = tmp_path / "bus.log"

    def fly():
        with BusLog(log, "vcan0") as file:
            file.write(0, frames(0))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fly()
    assert check_against_index(log) == (
        LogStanding.OPEN,
        "bus.log.index has no end mark: "
        "the flight did not come to its end, and its last second may be missing",
    )


class FullDisk:
    """``os.write`` onto a disk with room for so many bytes."""

    def __init__(self, room):
        self.room = room
        self.write = os.write

    def __call__(self, descriptor, text):
        if self.room <= 0 < len(text):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        taken = self.write(descriptor, text[: self.room])
        self.room -= taken
        return taken


TICK_BYTES = 2 * BLOCK_WRITES * 45


@pytest.mark.parametrize("room", [*range(29, 400, 7), *range(TICK_BYTES - 300, TICK_BYTES + 900, 37)])
def test_a_full_disk_keeps_whole_ticks(tmp_path, monkeypatch, room):
    """Room for so many bytes, of log and index together."""
    log = tmp_path / "bus.log"
    monkeypatch.setattr(bus_log.os, "write", FullDisk(room))
    with pytest.raises(FlightError, match=r"bus\.log: .*No space left on device") as caught:
        write(log)
    monkeypatch.undo()
    assert caught.value.exit_code == 1
    standing, _ = check_against_index(log)
    assert standing is LogStanding.OPEN
    if log.stat().st_size:
        written = [entry.frame for entry in read_log(log)]
        assert written[0] == FswBoot(0, 1, 2).encode()
        assert written[1:] == [frame for tick in range(len(written) // 2) for frame in frames(tick)]


@pytest.mark.parametrize("name", ["bus.log", "bus.log.gz"])
@pytest.mark.parametrize("ticks", [0, 1, BLOCK_WRITES, 2 * BLOCK_WRITES])
@pytest.mark.interpreted
def test_a_disk_with_room_for_the_log_alone_holds_each_line_once(tmp_path, monkeypatch, name, ticks):
    """What was written before its index failed is kept, and not written again."""
    log = tmp_path / name
    index = LogIndex.add

    def add(self, text, lines):
        if lines + self._lines > 2 * ticks:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        index(self, text, lines)

    monkeypatch.setattr(LogIndex, "add", add)
    file = BusLog(log, "vcan0", lambda: 0.0)
    with pytest.raises(FlightError, match=r": its index cannot be written: No space .*; the log is kept$"):
        fill(file)
    written = [entry.frame for entry in read_log(log)]
    flown = [frame for tick in range(len(written) // 2) for frame in frames(tick)]
    assert written == [FswBoot(0, 1, 2).encode(), *flown]
    assert ticks <= len(written) // 2 <= ticks + BLOCK_WRITES
    assert file.sha256 == sha256_of(log)
    assert check_against_index(log).standing is LogStanding.OPEN


def test_half_a_line_of_the_index_is_taken_back(tmp_path, monkeypatch):
    """So that what is written when there is room again is not spoiled by it."""
    log = tmp_path / "bus.log"
    log.write_bytes(b"x\n" * 64)
    index = LogIndex(log)
    before = index_path(log).read_bytes()
    monkeypatch.setattr(bus_log.os, "write", FullDisk(10))
    with pytest.raises(OSError, match="No space left on device"):
        index.add(b"x\n" * 64, 64)
    monkeypatch.undo()
    assert index_path(log).read_bytes() == before
    index.add(b"x\n" * 64, 64)
    index.close(ended=True)
    assert check_against_index(log).standing is LogStanding.VOUCHED


@pytest.mark.parametrize("room", [0, 20])
def test_a_disk_that_is_full_before_the_flight_is_reported(tmp_path, monkeypatch, room):
    monkeypatch.setattr(bus_log.os, "write", FullDisk(room))
    with pytest.raises(FlightError, match="cannot be written: No space left on device"):
        write(tmp_path / "bus.log")


def test_a_disk_that_is_full_at_the_very_end_is_reported(tmp_path, monkeypatch):
    log = tmp_path / "bus.log"
    write(log, 5)
    room = log.stat().st_size + index_path(log).stat().st_size - 1
    monkeypatch.setattr(bus_log.os, "write", FullDisk(room))
    with pytest.raises(FlightError, match="its index cannot be written"):
        write(log, 5)


def test_what_it_costs_grows_by_blocks_alone(tmp_path, monkeypatch):
    """For each block one write of the log, and one of the index."""
    written = []
    monkeypatch.setattr(bus_log.os, "write", lambda descriptor, text: written.append(descriptor) or len(text))
    with BusLog(tmp_path / "bus.log", "vcan0", lambda: 0.0) as log:
        for tick in range(1 + 10 * BLOCK_WRITES):
            log.write(tick, frames(tick))
        assert len(written) == 1 + 2 * (1 + 10)


def test_the_file_of_an_index_is_everybodys_to_read_and_is_closed(tmp_path):
    before, mask = len(os.listdir("/proc/self/fd")), os.umask(0)
    try:
        LogIndex(tmp_path / "bus.log").close(ended=True)
    finally:
        os.umask(mask)
    assert index_path(tmp_path / "bus.log").stat().st_mode & 0o777 == 0o644
    assert len(os.listdir("/proc/self/fd")) == before


def test_an_index_can_be_made_for_any_log(log):
    """As ``LogIndex`` is told of it, so it vouches."""
    text = log.read_bytes().replace(b"vcan0", b"can0")
    log.write_bytes(text)
    index = LogIndex(log)
    index.add(text, text.count(b"\n"))
    index.close(ended=True)
    assert check_against_index(log).standing is LogStanding.VOUCHED
