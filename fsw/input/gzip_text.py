"""Text files that may be compressed: those whose names end in ``.gz``, of one or more members of gzip."""

import errno
import io
import zlib
from pathlib import Path
from typing import BinaryIO, cast

from typing_extensions import Buffer

from fsw.input.regular_file import check_regular

SUFFIX = ".gz"
_PIECE_BYTES = 1 << 16
_BEGIN = bytes.fromhex("1f8b 0800 0000 0000")
_GZIP = 16 + zlib.MAX_WBITS


def is_compressed(path: Path) -> bool:
    """Whether a file of this name is compressed."""
    return path.suffix == SUFFIX


def stored(path: Path) -> Path:
    """The file of this name, or its compressed form where there is only that."""
    compressed = path.with_name(path.name + SUFFIX)
    return compressed if compressed.is_file() and not path.is_file() else path


def open_text(path: Path) -> BinaryIO:
    """Open a file for reading; what is read of a compressed one is its text.

    A file that is still being written, or whose end is lost, is read as far as it goes, and further once
    it has grown. Where the text is damaged, reading raises ``OSError`` with a ``strerror`` that says so.

    Raises:
        OSError: it cannot be opened, or is not a regular file.
    """
    check_regular(path)
    if not is_compressed(path):
        return path.open("rb")
    return cast(BinaryIO, io.BufferedReader(_Members(path), _PIECE_BYTES))


def last_member(tail: bytes) -> bytes:
    """The text of the last member, as far as it goes, in the last bytes of a file; empty if it begins before.

    The members must carry no name and no time, like those that are compressed in memory.
    """
    begin = tail.rfind(_BEGIN)
    try:
        return zlib.decompressobj(_GZIP).decompress(tail[begin:]) if begin >= 0 else b""
    except zlib.error:
        return b""


class _Members(io.RawIOBase):
    """The text of a compressed file."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("rb", buffering=0)
        self._member = zlib.decompressobj(_GZIP)
        self._rest = b""

    def readable(self) -> bool:
        """It is for reading."""
        return True

    def fileno(self) -> int:
        """That of the file: its position is how much has been read of it."""
        return self._file.fileno()

    def close(self) -> None:
        """Close the file too."""
        self._file.close()
        super().close()

    def readinto(self, buffer: Buffer) -> int:
        """The next bytes of the text; 0 at the end so far."""
        view = memoryview(buffer)
        while True:
            text = self._inflated(len(view))
            if text:
                view[: len(text)] = text
                return len(text)
            if not self._rest:
                self._rest = self._file.read(_PIECE_BYTES) or b""
                if not self._rest:
                    return 0

    def _inflated(self, most: int) -> bytes:
        """Text of what has been read and not given yet; none at the end of a member."""
        if self._member.eof and self._rest:
            self._member = zlib.decompressobj(_GZIP)
        try:
            text = self._member.decompress(self._rest, most)
        except zlib.error:
            raise OSError(errno.EIO, "its compressed text is damaged") from None
        self._rest = self._member.unused_data if self._member.eof else self._member.unconsumed_tail
        return text
