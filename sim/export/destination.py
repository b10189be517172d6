"""The file that an export writes: whole, or not there."""

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from platform import node

from sim.errors import HarnessError
from sim.record.destination import check_file

_MACHINE = re.sub(r"\W+", "_", node())


@contextmanager
def whole_file(out: Path, force: bool) -> Iterator[Path]:
    """Yield the path of a temporary file beside ``out``, which takes its name if the block succeeds.

    What exports that were killed have left in the folder is removed.

    Args:
        out: where the file is wanted.
        force: whether it may take the place of another.

    Raises:
        HarnessError: it may not, or cannot be written.
    """
    check_file(out)
    if os.path.lexists(out) and not force:
        raise HarnessError(f"{out} already exists: name another file by --out, or replace it by --force")
    _remove_left_over(out.parent)
    temporary = out.with_name(f".torquer-{_MACHINE}-{os.getpid()}.part")
    try:
        yield temporary
        temporary.replace(out)
    finally:
        temporary.unlink(missing_ok=True)


def _remove_left_over(folder: Path) -> None:
    """Remove temporary files of processes of this machine that have ended; what cannot be removed stays."""
    if os.name != "posix":  # elsewhere asking for a process by a signal would end it
        return
    for path in folder.glob(f".torquer-{_MACHINE}-*.part"):
        number = path.stem.rpartition("-")[2]
        if number.isdecimal() and not _is_running(int(number)):
            with suppress(OSError):
                path.unlink()


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:  # of another user
        pass
    return True


def write_text(out: Path, text: str, force: bool) -> None:
    """Write a text file, whole or not at all.

    Raises:
        HarnessError: it cannot be written, or is there and may not be replaced.
    """
    with whole_file(out, force) as path:
        path.write_text(text, encoding="utf-8", newline="\n")
