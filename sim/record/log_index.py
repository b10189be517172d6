"""The index beside a bus log: what vouches that the log is whole and as it was flown.

``bus.log.index`` is written as the flight goes. Its first line names its version; then comes a line for each
block of the log, a block being what ``BLOCK_WRITES`` writes (as a rule ticks) have added:

    torquer-log-index 1 crc32
    <lines> <bytes> <sha256> crc32
    <lines> <bytes> <sha256> end crc32

Lines and bytes count from the start of the log. The digest is SHA-256 over the digest before it (of the first
block: nothing) and the block, so that every digest hangs on all that stands before it. ``end`` is on the last
line of a flight that came to its end. Each line is sealed by a CRC-32 of its text: damage to the index is
told from damage to the log.

A digest without a key guards against mishap and carelessness, not against somebody who forges both files.
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

from fsw.input.regular_file import read_regular

VERSION = 1
SUFFIX = ".index"
BLOCK_WRITES = 64
_TITLE = "torquer-log-index"
_SEALED = re.compile(rb"(.{1,160}) ([0-9a-f]{8})\n")
_BLOCK = re.compile(rb"(\d{1,12}) (\d{1,15}) ([0-9a-f]{64})( end)?")


class Standing(Enum):
    """What the index says of a log."""

    VOUCHED = "vouched"
    """Whole and as it was flown."""
    UNKNOWN = "unknown"
    """There is no index."""
    OPEN = "open"
    """As it was flown, but the flight was cut short: nothing vouches for the end."""
    BROKEN = "broken"
    """Cut, altered, or with an index that cannot be used."""


class Voucher(NamedTuple):
    """What the index says of a log, and in a sentence; empty where there is nothing to tell."""

    standing: Standing
    sentence: str

    @property
    def holds(self) -> bool:
        """Whether nothing speaks against a log that claims to be complete."""
        return self.standing in (Standing.VOUCHED, Standing.UNKNOWN)


class Block(NamedTuple):
    """One line of the index: lines and bytes of the log up to its end, digest, and whether it is the last."""

    lines: int
    size: int
    digest: bytes
    end: bool


_PIECE_BYTES = 1 << 20
_MOST_INDEX_BYTES = 64_000_000
"""An index of 2^24 ticks has 30 MB."""
_FIRST = Block(0, 0, b"", end=False)


def index_of(log: Path) -> Path:
    """Where the index of a log is."""
    return log.with_name(log.name + SUFFIX)


class LogIndex:
    """Writes the index of a log that is being written.

    Raises:
        OSError: it cannot be written; so do ``add`` and ``close``.
    """

    def __init__(self, log: Path) -> None:
        self._descriptor = os.open(index_of(log), os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        self._lines = self._size = self._writes = self._own_size = 0
        self._hash = hashlib.sha256()
        self._put(f"{_TITLE} {VERSION}")

    def add(self, text: bytes, lines: int) -> None:
        """What has just been written to the log: whole lines."""
        self._hash.update(text)
        self._lines += lines
        self._size += len(text)
        self._writes += 1
        if self._writes == BLOCK_WRITES:
            self._close_block("")

    def close(self, ended: bool) -> None:
        """Vouch for the rest; ``ended``: the flight came to its end."""
        try:
            if ended or self._writes:
                self._close_block(" end" if ended else "")
        finally:
            os.close(self._descriptor)

    def _close_block(self, end: str) -> None:
        digest = self._hash.digest()
        self._put(f"{self._lines} {self._size} {digest.hex()}{end}")
        self._hash = hashlib.sha256(digest)
        self._writes = 0

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


def vouch(log: Path) -> Voucher:
    """Compare a log with the index beside it; never an error, whatever the files hold."""
    name = index_of(log).name
    try:
        content = read_regular(index_of(log), _MOST_INDEX_BYTES)
        with log.open("rb") as file:
            return _compare(name, file, _blocks(name, content))
    except FileNotFoundError:
        return Voucher(Standing.UNKNOWN, f"nothing vouches for the log: there is no {name} beside it")
    except OSError as error:
        return Voucher(Standing.BROKEN, f"{name} cannot be compared with the log: {error.strerror}")
    except _BrokenError as broken:
        return Voucher(Standing.BROKEN, str(broken))


def _compare(name: str, file: BinaryIO, blocks: Iterator[Block]) -> Voucher:
    there = os.fstat(file.fileno()).st_size
    last = _FIRST
    for block in blocks:
        if there < block.size:
            raise _BrokenError(f"truncated: the log has {there} bytes, its index tells of {block.size}")
        if _digest(file, block.size - last.size, last.digest) != block.digest:
            raise _BrokenError(f"altered: lines {last.lines + 1} to {block.lines} are not what was flown")
        last = block
    if last.end and there > last.size:
        raise _BrokenError(f"altered: something was added after line {last.lines}")
    if last.end:
        return Voucher(Standing.VOUCHED, "")
    rest = (
        f"nothing vouches for what follows line {last.lines}"
        if there > last.size
        else "the flight did not come to its end"
    )
    return Voucher(Standing.OPEN, f"{name} has no end mark: {rest}")


def _digest(file: BinaryIO, size: int, before: bytes) -> bytes:
    """SHA-256 over the digest before and the next so many bytes: a block is as large as its index says."""
    digest = hashlib.sha256(before)
    while size and (piece := file.read(min(size, _PIECE_BYTES))):
        digest.update(piece)
        size -= len(piece)
    return digest.digest()


def _blocks(name: str, content: bytes) -> Iterator[Block]:
    """What an index tells; half a line, that a kill has left, is passed over."""
    lines = content.splitlines(keepends=True)
    title = _unsealed(lines[0]) if lines else None
    if title is None or not title.startswith(_TITLE.encode()):
        raise _BrokenError(f"{name} is damaged in its line 1, or no index of a log")
    version = title.decode("latin-1").split()[-1]
    if version != str(VERSION):
        raise _BrokenError(f"{name} is of version {version}, and only version {VERSION} can be read")
    last = _FIRST
    for number, line in enumerate(lines[1:], 2):
        if number == len(lines) and not line.endswith(b"\n"):
            return
        block = _block(line)
        if block is None or last.end or block.size < last.size:
            raise _BrokenError(f"{name} is damaged in its line {number}")
        yield block
        last = block


def _unsealed(line: bytes) -> bytes | None:
    """The text of a line of the index; None if its CRC is wrong."""
    found = _SEALED.fullmatch(line)
    return found[1] if found and int(found[2], 16) == crc32(found[1]) else None


def _block(line: bytes) -> Block | None:
    found = _BLOCK.fullmatch(_unsealed(line) or b"")
    if found is None:
        return None
    return Block(int(found[1]), int(found[2]), bytes.fromhex(found[3].decode()), end=found[4] is not None)
