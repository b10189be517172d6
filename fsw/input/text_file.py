"""Text files that people hand over: in UTF-8, or in UTF-16 or UTF-32 with a byte order mark."""

import codecs
import errno
from pathlib import Path

from fsw.input.regular_file import read_regular

_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16, whose mark it begins with
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
"""Byte order marks, and what follows each."""


def read_text(path: Path, most_bytes: int, odd_letters: bool = False) -> str:
    """The text of a file, without its byte order mark.

    Args:
        path: the file.
        most_bytes: that it may hold.
        odd_letters: letters that are not in UTF-8 do not matter, and become U+FFFD.

    Raises:
        OSError: as for ``read_regular``, or it is no such text; ``strerror`` says what is odd, and where.
    """
    return text_of(read_regular(path, most_bytes), odd_letters)


def text_of(content: bytes, odd_letters: bool = False) -> str:
    """The text that these bytes hold; the rest as for ``read_text``."""
    mark, codec = next(((mark, codec) for mark, codec in _MARKS if content.startswith(mark)), (b"", "utf-8"))
    try:
        text = content[len(mark) :].decode(codec, errors="replace" if odd_letters else "strict")
    except UnicodeDecodeError as error:
        raise OSError(errno.EILSEQ, _odd(error, content, codec)) from None
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise OSError(errno.EILSEQ, f"line {line} holds a NUL: it is no text, or UTF-16 without its mark")
    return text


def _odd(error: UnicodeDecodeError, content: bytes, codec: str) -> str:
    if codec != "utf-8":
        return f"it begins with the mark of {codec.upper()}, and is cut or damaged further on"
    if b"\0" in content:
        return "it is no text: there are NULs in it"
    line = error.object[: error.start].count(b"\n") + 1
    byte = error.object[error.start]
    letter = bytes([byte]).decode("cp1252", errors="replace")
    meant = f", which is {letter!r} in Windows-1252" if letter.isprintable() and letter != "\ufffd" else ""
    return f"line {line} is not UTF-8 text: byte 0x{byte:02X}{meant}; save the file as UTF-8"
