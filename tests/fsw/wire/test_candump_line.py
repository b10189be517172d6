"""A frame as a line of a candump log: as can-utils writes it, and every variant that it writes is read."""

import pytest

from fsw.wire.candump_line import (
    MOST_REMEMBERED,
    LineReader,
    format_line,
    format_time,
    is_beginning,
    is_fd,
)
from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame

STAMP = "1427513417.000000"
TIME_US = 1_427_513_417_000_000
LINE = f"({STAMP}) vcan0 110#133E0014F79838B7\n"


def read(line):
    return LineReader().read(line.encode())


def test_a_line_is_what_candump_writes():
    assert format_line(STAMP, "vcan0", Frame(0x110, bytes.fromhex("133E0014F79838B7"))) == LINE


@pytest.mark.parametrize(
    ("frame", "text"),
    [
        (Frame(0x000, b""), "000#"),
        (Frame(0x7FF, b"\x00\xab"), "7FF#00AB"),
        (Frame(0x123 | EXTENDED_FLAG, b"\x01"), "00000123#01"),
        (Frame(0x1FFFFFFF | EXTENDED_FLAG, b""), "1FFFFFFF#"),
        (Frame(0x123 | REMOTE_FLAG, b""), "123#R"),
        (Frame(0x123 | EXTENDED_FLAG | REMOTE_FLAG, b""), "00000123#R"),
        (Frame(0x004 | ERROR_FLAG, bytes(8)), "20000004#0000000000000000"),
    ],
)
def test_identifiers_are_written_and_read_as_their_kind_demands(frame, text):
    line = format_line(STAMP, "can1", frame)
    assert line == f"({STAMP}) can1 {text}\n"
    assert read(line) == (TIME_US, "can1", frame)


@pytest.mark.parametrize(
    ("timestamp_us", "text"),
    [(0, "0000000000.000000"), (1_500_000, "0000000001.500000"), (TIME_US + 1, "1427513417.000001")],
)
def test_times_have_ten_digits_and_six_decimals(timestamp_us, text):
    assert format_time(timestamp_us) == text


@pytest.mark.parametrize(
    "line",
    [
        f"({STAMP}) vcan0 110#133E0014F79838B7 R\n",
        f"({STAMP}) vcan0 110#133E0014F79838B7 T\n",
        f"({STAMP})   vcan0 110#133E0014F79838B7\n",
        "(1427513417.000000999) vcan0 110#133E0014F79838B7\n",
        f"({STAMP}) vcan0 110#133E0014F79838B7_9\n",
        f"({STAMP}) vcan0 110#133e0014f79838b7\n",
        f"({STAMP}) vcan0 110#133E0014F79838B7\r\n",
    ],
)
def test_the_variants_of_newer_candumps_are_read(line):
    assert read(line) == (TIME_US, "vcan0", Frame(0x110, bytes.fromhex("133E0014F79838B7")))


@pytest.mark.parametrize("payload", ["R", "R0", "R8", "R8_F", "R R"])
def test_a_remote_frame_differs_from_one_with_data(payload):
    assert read(f"({STAMP}) vcan0 123#{payload}\n") == (TIME_US, "vcan0", Frame(0x123 | REMOTE_FLAG, b""))


@pytest.mark.parametrize(
    "line", ["", "\n", "no frame\n", LINE[:-1], f"({STAMP}) 110#13\n", f"({STAMP}) c 800#\n"]
)
def test_what_is_no_line_is_no_frame(line):
    assert read(line) is None


def test_a_reader_does_not_mix_the_words_of_its_lines():
    reader = LineReader()
    lines = [(n * 700_000, f"can{n % 3}", Frame(0x100 + n % 5, bytes((n,)))) for n in range(50)]
    texts = [format_line(format_time(time_us), channel, frame) for time_us, channel, frame in lines]
    assert [reader.read(text.encode()) for text in texts] == lines


def test_a_line_that_has_been_cut_is_a_beginning_and_another_text_is_none():
    assert all(is_beginning(LINE[:length].encode()) for length in range(1, len(LINE)))
    assert not is_beginning(b"(142751x")


def test_the_line_of_a_can_fd_frame_is_recognised():
    assert is_fd(f"({STAMP}) vcan0 110##1133E0014F79838B7\n".encode())
    assert not is_fd(LINE.encode())


def test_a_reader_forgets_words_rather_than_grow():
    reader = LineReader()
    for number in range(MOST_REMEMBERED + 2):
        text = format_line(STAMP, f"can{number}", Frame(number | EXTENDED_FLAG, b""))
        assert reader.read(text.encode()) == (TIME_US, f"can{number}", Frame(number | EXTENDED_FLAG, b""))
