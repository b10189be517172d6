import tempfile
import tracemalloc
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fsw.wire.candump_line import MOST_REMEMBERED, format_line, format_time
from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from sim.record.candump import (
    LogEntry,
    LogError,
    LogTruncatedError,
    read_log,
)

STAMP = "1427513417.000000"
TIME_US = 1_427_513_417_000_000
LINE = f"({STAMP}) vcan0 110#133E0014F79838B7\n"

standard = st.builds(Frame, st.integers(0, 0x7FF), st.binary(max_size=8))
extended = st.builds(
    lambda number, data: Frame(number | EXTENDED_FLAG, data),
    st.integers(0, 0x1FFFFFFF),
    st.binary(max_size=8),
)
error = st.builds(lambda bits: Frame(bits | ERROR_FLAG, bytes(8)), st.integers(0, 0x1FFFFFFF))
remote = st.builds(lambda number: Frame(number | REMOTE_FLAG, b""), st.integers(0, 0x7FF))
remote_extended = st.builds(
    lambda number: Frame(number | EXTENDED_FLAG | REMOTE_FLAG, b""), st.integers(0, 0x1FFFFFFF)
)
any_frame = st.one_of(standard, extended, error, remote, remote_extended)


@pytest.fixture
def read(tmp_path):
    def read_text(text: str | bytes) -> list[LogEntry]:
        log = tmp_path / "bus.log"
        log.write_bytes(text if isinstance(text, bytes) else text.encode())
        return list(read_log(log))

    return read_text


def read_in_new_file(content: bytes) -> tuple[list[LogEntry], LogError | None]:
    """The entries, and what ended them."""
    entries = []
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder, "bus.log")
        log.write_bytes(content)
        try:
            for entry in read_log(log):
                entries.append(entry)
        except LogError as refusal:
            return entries, refusal
    return entries, None


@pytest.mark.long
@given(st.lists(st.tuples(st.integers(0, 10**16), any_frame), min_size=1, max_size=20))
def test_what_is_written_is_read_back(rows):
    text = "".join(format_line(format_time(time_us), "vcan0", frame) for time_us, frame in rows)
    entries, refusal = read_in_new_file(text.encode())
    assert refusal is None
    assert [(entry.timestamp_us, entry.frame) for entry in entries] == rows
    assert [entry.line for entry in entries] == list(range(1, len(rows) + 1))


# --- entry by entry


def test_entries_come_one_by_one(tmp_path):
    log = tmp_path / "bus.log"
    log.write_text(LINE + "no candump line\n")
    assert next(read_log(log)).frame.can_id == 0x110


@pytest.mark.long
def test_a_log_in_which_every_line_has_words_of_its_own_takes_no_memory(tmp_path):
    lines = 3 * MOST_REMEMBERED
    with (tmp_path / "bus.log").open("w") as log:
        log.writelines(f"(0000000000.000000) can0 {n:08X}#\n" for n in range(lines))
    tracemalloc.start()
    read = [entry.frame.can_id & 0xFFFFFF for entry in read_log(tmp_path / "bus.log")]
    kept, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert read == list(range(lines))
    assert peak - kept < 400 * MOST_REMEMBERED


# --- comments and channels


def test_comments_and_empty_lines_are_passed_over(read):
    entries = read(f"# {'a comment ' * 60}\n" + LINE + "\n# another\n \n" + LINE)
    assert [entry.line for entry in entries] == [2, 6]


def test_of_two_channels_one_must_be_named(read, tmp_path):
    text = LINE + LINE.replace("vcan0", "can1")
    with pytest.raises(LogError, match="line 2 is of channel can1, those before it are of vcan0") as refusal:
        read(text)
    assert refusal.value.exit_code == 2
    (entry,) = read_log(tmp_path / "bus.log", channel="can1")
    assert (entry.line, entry.channel) == (2, "can1")
    with pytest.raises(LogError, match="no frame of channel can2, only of can1"):
        list(read_log(tmp_path / "bus.log", channel="can2"))


def test_a_file_of_comments_alone_is_no_log(read):
    with pytest.raises(LogError, match="no line of a frame"):
        read("# nothing\n")


# --- what is no log


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "the file is empty"),
        (b"\n", "not a candump log: no line of a frame"),
        (b"time,id,data\n1,2,3\n", "not a candump log"),
        (b"\x89HDF\r\n\x1a\n" + bytes(2000), "not a candump log"),
        (bytes(100_000), "not a candump log"),
        (b"(" + b"1" * 100_000, "not a candump log"),
    ],
)
def test_a_file_that_is_no_log_is_refused_in_one_sentence(read, tmp_path, content, reason):
    with pytest.raises(LogError, match=reason) as refusal:
        read(content)
    assert not isinstance(refusal.value, LogTruncatedError)
    assert refusal.value.exit_code == 2
    assert str(refusal.value).startswith(f"{tmp_path / 'bus.log'}: ")
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("name", ["missing.log", "."])
def test_a_file_that_cannot_be_read_is_refused(tmp_path, name):
    with pytest.raises(LogError, match="cannot be read"):
        list(read_log(tmp_path / name))


@pytest.mark.parametrize(
    "line",
    [
        "hello\n",
        f"({STAMP}) vcan0 110#133\n",
        f"({STAMP}) vcan0 110#133E0014F79838B700\n",
        f"({STAMP}) vcan0 800#13\n",
        f"({STAMP}) vcan0 1100#13\n",
        f"({STAMP}) vcan0 40000000#13\n",
        f"({STAMP}) vcan0 110#1G\n",
        f"({STAMP}) vcan0 110 13\n",
        f"({STAMP}) vcan0  110#13\n",
        f"({STAMP}) 110#13\n",
        "(1427513417.00000) vcan0 110#13\n",
        "1427513417.000000 vcan0 110#13\n",
        f"({STAMP}) vcan0 110#13 X\n",
        f"({STAMP}) vcan0 110#13" + LINE,
    ],
)
def test_a_line_that_is_none_is_refused_by_its_number(read, line):
    with pytest.raises(LogError, match="line 2 is not a candump line"):
        read(LINE + line + LINE)


def test_a_can_fd_frame_is_refused_as_one(read):
    with pytest.raises(LogError, match="line 2 is a CAN FD frame"):
        read(LINE + f"({STAMP}) vcan0 110##1133E0014F79838B7\n")


# --- where a log ends

KINDS = [
    LINE,
    f"({STAMP}) vcan0 123#R8_F T\n",
    f"({STAMP}) vcan0 1FFFFFFF#00 R\n",
    "(1427513417.000000123)    vcan0 7FF#0011223344556677_C\r\n",
    f"({STAMP}) vcan0 20000004#0000000000000000\n",
]


@pytest.mark.parametrize("last", KINDS)
def test_a_log_cut_at_any_byte_yields_its_whole_lines_and_says_where_it_ends(last):
    text = (LINE + LINE + last).encode()
    for length in range(1, len(text) + 1):
        content = text[:length]
        lines = content.count(b"\n")
        entries, refusal = read_in_new_file(content)
        assert len(entries) == lines
        if content.endswith(b"\n"):
            assert refusal is None
        else:
            assert isinstance(refusal, LogTruncatedError)
            assert refusal.line == lines + 1
            assert f"bus.log: truncated: line {lines + 1} is incomplete" in str(refusal)
            assert refusal.exit_code == 1


def test_a_last_line_that_is_only_without_newline_is_cut_too(read):
    with pytest.raises(LogTruncatedError):
        read(LINE.rstrip("\n"))


def test_an_end_that_no_line_begins_with_is_no_cut(read):
    with pytest.raises(LogError, match="line 2 is not a candump line") as refusal:
        read(LINE + "(142751x")
    assert not isinstance(refusal.value, LogTruncatedError)


@given(st.binary(max_size=300))
@example(b"(")
@example(b"(\n")
@example(b"(1427513417.000000) \xff\xfe 110#00\n")
def test_random_bytes_never_raise_anything_but_log_errors(content):
    _, refusal = read_in_new_file(content)
    assert refusal is None or "\n" not in str(refusal)


@pytest.mark.long
@given(st.data())
def test_a_log_with_altered_bytes_is_refused_or_read_whole(data):
    content = bytearray((LINE * 5).encode())
    for _ in range(data.draw(st.integers(1, 3))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    entries, refusal = read_in_new_file(bytes(content))
    assert len(entries) == bytes(content).count(b"\n") or refusal is not None


class TestGrowing:
    """A log that is read while it is being written."""

    def grown(self, tmp_path, *parts):
        """The lines read of a log to which a part is added whenever the reader asks for more."""
        log, left = tmp_path / "bus.log", [part.encode() for part in parts]
        log.write_bytes(left.pop(0))

        def more():
            if not left:
                return False
            with log.open("ab") as file:
                file.write(left.pop(0))
            return True

        return [entry.line for entry in read_log(log, more)]

    def test_what_is_added_is_read(self, tmp_path):
        assert self.grown(tmp_path, "", LINE, "", LINE + LINE) == [1, 2, 3]

    @pytest.mark.parametrize("cut", [1, 20, len(LINE) - 1])
    def test_a_line_in_parts_is_one_line(self, tmp_path, cut):
        assert self.grown(tmp_path, LINE + LINE[:cut], "", LINE[cut:] + LINE) == [1, 2, 3]

    def test_a_line_that_is_never_finished_is_truncated(self, tmp_path):
        with pytest.raises(LogTruncatedError, match="line 2 is incomplete"):
            self.grown(tmp_path, LINE, LINE[:20])

    def test_what_is_no_line_is_refused_at_once(self, tmp_path):
        with pytest.raises(LogError, match="line 2 is not a candump line"):
            self.grown(tmp_path, LINE + "no line\n", LINE)
