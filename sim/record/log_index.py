"""The index of a bus log, by which one can check that the log is whole and unaltered.

``bus.log.index`` is written during the flight. Its first line has its version; then comes a line for each
block of the log, a block being what was written at once:

    torquer-log-index 1 crc32
    <lines> <bytes> <sha256> crc32
    <lines> <bytes> <sha256> end crc32

Lines and bytes count from the start of the log, before it is compressed. The digest is SHA-256 over the
digest before it (of the first block: nothing) and the block, so that every digest depends on the whole log
before it. ``end`` is on the last line of a completed flight. Each line has a CRC-32 of its text, which
distinguishes damage to the index from damage to the log.

A digest without a key protects against accidents, not against a forger who rewrites both files.
"""

import errno
import hashlib
import os
import re
from collections.abc import Iterator
from enum import Enum
from pathlib import Path
from typing import BinaryIO, NamedTuple
from zlib import crc32

from fsw.input.gzip_text import is_compressed, open_text
from fsw.input.regular_file import check_regular

VERSION = 1
SUFFIX = ".index"
_TITLE = "torquer-log-index"
_SEALED = re.compile(rb"(.{1,160}) ([0-9a-f]{8})\n")
_BLOCK = re.compile(rb"(\d{1,12}) (\d{1,15}) ([0-9a-f]{64})( end)?")


class LogStanding(Enum):
    """What an index shows about its log."""

    VOUCHED = "vouched"
    """Whole and unaltered."""
    UNKNOWN = "unknown"
    """There is no index."""
    OPEN = "open"
    """Unaltered, but the flight was cut short: the index does not cover the end."""
    BROKEN = "broken"
    """Cut, altered, or with an index that cannot be used."""


class IndexCheck(NamedTuple):
    """What the index shows about a log, and why, in a sentence; empty if it is whole and unaltered."""

    standing: LogStanding
    sentence: str

    @property
    def holds(self) -> bool:
        """Whether the log may be complete: the index does not contradict that."""
        return self.standing in (LogStanding.VOUCHED, LogStanding.UNKNOWN)


class Block(NamedTuple):
    """One line of the index: lines and bytes of the log up to its end, digest, and whether it is the last."""

    lines: int
    size: int
    digest: bytes
    end: bool


_PIECE_BYTES = 1 << 20
_LONGEST = 200
"""Bytes of a line of the index, at most."""
_FIRST = Block(0, 0, b"", end=False)


def index_path(log: Path) -> Path:
    """The path of the index of a log, compressed or not."""
    name = log.stem if is_compressed(log) else log.name
    return log.with_name(name + SUFFIX)


class LogIndex:
    """Writes the index of a log that is being written.

    Raises:
        OSError: it cannot be written; so do ``add`` and ``close``.
    """

    def __init__(self, log: Path) -> None:
        self._descriptor = os.open(index_path(log), os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        self._lines = self._size = self._own_size = 0
        self._digest = b""
        self._put(f"{_TITLE} {VERSION}")

    def add(self, text: bytes, lines: int) -> None:
        """Add a block that has just been written to the log: whole lines."""
        digest = hashlib.sha256(self._digest + text).digest()
        self._put(f"{self._lines + lines} {self._size + len(text)} {digest.hex()}")
        self._digest = digest
        self._lines += lines
        self._size += len(text)

    def close(self, ended: bool) -> None:
        """Close it; ``ended``: the flight was completed."""
        try:
            if ended:
                digest = hashlib.sha256(self._digest).hexdigest()
                self._put(f"{self._lines} {self._size} {digest} end")
        finally:
            os.close(self._descriptor)

    def _put(self, text: str) -> None:
        sealed = text.encode("ascii")
        line = b"%b %08x\n" % (sealed, crc32(sealed))
        if os.write(self._descriptor, line) < len(line):
            os.ftruncate(self._descriptor, self._own_size)
            os.lseek(self._descriptor, 0, os.SEEK_END)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        self._own_size += len(line)


class _BrokenError(Exception):
    """Log and index do not agree; the message says how."""


def check_against_index(log: Path) -> IndexCheck:
    """Compare a log with its index; any content of the two files gives a result, never an error."""
    name = index_path(log).name
    try:
        check_regular(index_path(log))
        with index_path(log).open("rb") as index, open_text(log) as file:
            return _compare(name, file, _blocks(name, index))
    except FileNotFoundError:
        return IndexCheck(LogStanding.UNKNOWN, f"nothing vouches for the log: there is no {name} beside it")
    except OSError as error:
        return IndexCheck(LogStanding.BROKEN, f"{name} cannot be compared with the log: {error.strerror}")
    except _BrokenError as broken:
        return IndexCheck(LogStanding.BROKEN, str(broken))


def _compare(name: str, file: BinaryIO, blocks: Iterator[Block]) -> IndexCheck:
    last = _FIRST
    for block in blocks:
        digest, missing = _digest(file, block.size - last.size, last.digest)
        if missing:
            raise _BrokenError(
                f"truncated: the log has {block.size - missing} bytes, its index covers {block.size}"
            )
        if digest != block.digest:
            raise _BrokenError(f"altered: lines {last.lines + 1} to {block.lines} are not what was flown")
        last = block
    more = bool(file.read(1))
    if last.end and more:
        raise _BrokenError(f"altered: something was added after line {last.lines}")
    if last.end:
        return IndexCheck(LogStanding.VOUCHED, "")
    rest = (
        f"nothing vouches for what follows line {last.lines}"
        if more
        else "the flight did not come to its end, and its last second may be missing"
    )
    return IndexCheck(LogStanding.OPEN, f"{name} has no end mark: {rest}")


def _digest(file: BinaryIO, size: int, before: bytes) -> tuple[bytes, int]:
    """SHA-256 over the previous digest and the next ``size`` bytes, and how many of these are missing."""
    digest = hashlib.sha256(before)
    while size and (piece := file.read(min(size, _PIECE_BYTES))):
        digest.update(piece)
        size -= len(piece)
    return digest.digest(), size


def _blocks(name: str, index: BinaryIO) -> Iterator[Block]:
    """The blocks of an index; an incomplete last line, as left by a kill, is ignored."""
    title = _unseal(index.readline(_LONGEST))
    if title is None or not title.startswith(_TITLE.encode()):
        raise _BrokenError(f"{name} is damaged in its line 1, or no index of a log")
    version = title.decode("latin-1").split()[-1]
    if version != str(VERSION):
        raise _BrokenError(f"{name} is of version {version}, and only version {VERSION} can be read")
    last, number = _FIRST, 1
    while line := index.readline(_LONGEST):
        number += 1
        if len(line) < _LONGEST and not line.endswith(b"\n"):
            return
        block = _block(line)
        if block is None or last.end or block.size < last.size:
            raise _BrokenError(f"{name} is damaged in its line {number}")
        yield block
        last = block


def _unseal(line: bytes) -> bytes | None:
    """The text of a line of the index; None if its CRC is wrong."""
    found = _SEALED.fullmatch(line)
    return found[1] if found and int(found[2], 16) == crc32(found[1]) else None


def _block(line: bytes) -> Block | None:
    found = _BLOCK.fullmatch(_unseal(line) or b"")
    if found is None:
        return None
    return Block(int(found[1]), int(found[2]), bytes.fromhex(found[3].decode()), end=found[4] is not None)
