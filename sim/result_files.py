"""The files that a command writes: whole, and none of them one that it reads."""

import os
from collections.abc import Mapping
from pathlib import Path

from sim.errors import HarnessError, writing
from sim.record.destination import check_file
from sim.record.whole_file import replace_file

Files = Mapping[str, Path | None]
"""By what they are, as the user is told; None: there is none."""


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
