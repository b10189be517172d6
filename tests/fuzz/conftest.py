"""What may become of a file: bytes altered, moved, cut, and numbers that are none or too large."""

import re

import pytest
from hypothesis import strategies as st

EXTREMES = [
    b"0", b"-0.0", b"-1", b"1", b"3", b"1e15", b"-1e15", b"1e-18", b"1e308", b"-1e308", b"5e-324", b"nan",
    b"inf", b"-inf", b"4294967296", b"18446744073709551616", b"9" * 6000, b"0x" + b"f" * 6000, b"true",
    b"null", b"''", b'"x"', b'"\\u0000"', b"[]", b"{}", b"[" * 300, b"{a=" * 300, b"1979-05-27T07:32:00Z",
    b"\x00", b"\xff", b"\n", b",", b"#",
]  # fmt: skip
"""Put in the place of a word."""

_WORD = re.compile(rb"[^\s,;:=\[\]{}\"'()#]+")


def _put(content, place, length, text):
    return content[:place] + text + content[place + length :]


@st.composite
def mutations(draw, content):
    """The content with one to four things done to it."""
    words = [(found.start(), len(found[0])) for found in _WORD.finditer(content)]
    for _ in range(draw(st.integers(1, 4))):
        place = draw(st.integers(0, max(0, len(content) - 1)))
        length = draw(st.integers(0, 40))
        match draw(
            st.sampled_from(("flip", "write", "cut", "drop", "repeat", "insert", "word", "word", "word"))
        ):
            case "flip" if content:
                content = _put(content, place, 1, bytes([content[place] ^ 1 << draw(st.integers(0, 7))]))
            case "write":
                content = _put(content, place, length, draw(st.binary(min_size=length, max_size=length)))
            case "cut":
                content = content[:place]
            case "drop":
                content = _put(content, place, length, b"")
            case "repeat":
                content = _put(content, place, 0, content[place : place + length] * draw(st.integers(1, 20)))
            case "insert":
                content = _put(content, place, 0, draw(st.sampled_from(EXTREMES)))
            case "word" if words:
                start, size = draw(st.sampled_from(words))
                content = _put(content, start, size, draw(st.sampled_from(EXTREMES)))
    return content


@pytest.fixture(scope="session")
def mutated():
    """The strategy of what may become of a content."""
    return mutations
