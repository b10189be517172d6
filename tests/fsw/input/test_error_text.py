"""An error is told on one line, whatever the names in it hold."""

import pytest

from fsw.input.error_text import LONGEST, error_text


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
