"""The files that a command writes: whole, and none of them one that it reads."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from sim.errors import HarnessError, writing
from sim.record.destination import check_file
from sim.record.whole_file import replace_file, replacing

Files = Mapping[str, Path | None]
"""By what they are, as the user reads it; None: there is none."""


def check_results(wanted: Files, read: Files) -> None:
    """Check, before anything is computed or touched, that files can be written, each in a place of its own.

    Args:
        wanted: files to write, by option.
        read: files that are read.

    Raises:
        HarnessError: one is also another one that is written or read, or cannot be written.
    """
    taken = {what: path for what, path in read.items() if path is not None}
    asked = {option: path for option, path in wanted.items() if path is not None}
    for option, path in asked.items():
        for what, other in taken.items():
            if _are_one(path, other):
                raise HarnessError(
                    f"{option} {path} and {what} {other} are the same file: name another by {option}"
                )
        taken[option] = path
    for path in asked.values():
        check_file(path)


def write_result(path: Path, text: str) -> None:
    """Write a file at once, so that it is never there in part; it takes the place of a symbolic link.

    Raises:
        HarnessError: it cannot be written.
    """
    with writing(path):  # the name of a recorded file, which stands in the text, need not be valid UTF-8
        replace_file(path, text.encode("utf-8", errors="backslashreplace"))


def _are_one(path: Path, other: Path) -> bool:
    if os.path.realpath(path) == os.path.realpath(other):
        return True
    return os.path.exists(path) and os.path.exists(other) and os.path.samefile(path, other)


# --- The file that an export writes: whole, or not there


@contextmanager
def whole_file(out: Path, force: bool) -> Iterator[Path]:
    """Yield the path of a temporary file beside ``out``, which takes its name if the block succeeds.

    Args:
        out: where the file is wanted.
        force: whether it may take the place of another.

    Raises:
        HarnessError: it may not, or cannot be written.
    """
    check_file(out)
    if os.path.lexists(out) and not force:
        raise HarnessError(f"{out} already exists: name another file by --out, or replace it by --force")
    with replacing(out) as temporary:
        yield temporary


def write_text(out: Path, text: str, force: bool) -> None:
    """Write a text file, whole or not at all.

    Raises:
        HarnessError: it cannot be written, or is there and may not be replaced.
    """
    with whole_file(out, force) as path:
        path.write_text(text, encoding="utf-8", newline="\n")
