"""An error is told on one line, whatever the names in it hold."""

import pytest

from fsw.input.error_text import LONGEST, error_text, lines_text


@pytest.mark.parametrize("text", ["a.toml: x = 'ü' is not allowed", "", "→ 5 µT"])
def test_what_can_be_read_stays(text):
    assert error_text(ValueError(text)) == text


@pytest.mark.parametrize(
    ("text", "reports"),
    [
        ("a\nb", r"a\nb"),
        ("a\0b", r"a\x00b"),
        ("\x1b[31m", r"\x1b[31m"),
        ("\udcff", r"\udcff"),
        ("\u2028", r"\u2028"),
        ("\x9b31m", r"\x9b31m"),
        ("\u202eltr\u2069", r"\u202eltr\u2069"),
    ],
)
def test_what_cannot_is_escaped(text, reports):
    assert error_text(text) == reports


def test_what_is_too_long_is_cut_in_its_middle():
    reports = error_text("begin" + "x" * 10**6 + "end")
    assert reports.startswith("begin")
    assert reports.endswith("end")
    assert " ... " in reports
    assert len(reports) == LONGEST + 5


def test_lines_stay_lines_and_nothing_else_moves_the_cursor():
    assert lines_text("a\n\x1b[2J\r\t\x08b\x9b\u202e\n") == "a\n\\x1b[2J\\r\\t\\x08b\\x9b\\u202e\n"
    assert (
        lines_text("28\N{DEGREE SIGN}  \N{GREEK SMALL LETTER MU}T\n")
        == "28\N{DEGREE SIGN}  \N{GREEK SMALL LETTER MU}T\n"
    )


def test_no_character_at_all_is_a_control_or_a_mark_of_direction():
    text = "".join(map(chr, (*range(0x250), *range(0x2000, 0x2100), 0xFEFF, 0xE0001)))
    assert all(char == "\n" or char.isprintable() for char in lines_text(text))
