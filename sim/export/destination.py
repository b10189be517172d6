"""The file that an export writes: whole, or not there."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sim.errors import HarnessError
from sim.record.destination import check_file
from sim.record.whole_file import replacing


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
