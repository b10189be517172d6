"""Reads regular files only, and of each no more than its purpose allows."""

import errno
import os
from pathlib import Path
from stat import S_ISDIR, S_ISREG


def read_regular(path: Path, most_bytes: int) -> bytes:
    """The content of a file.

    Raises:
        OSError: there is no such file, it is a directory, pipe or device, cannot be read, or holds more than
            ``most_bytes``; ``strerror`` says which.
    """
    check_regular(path)
    with path.open("rb") as file:
        content = file.read(most_bytes + 1)
    if len(content) > most_bytes:
        raise OSError(errno.EFBIG, f"it is larger than {most_bytes / 1e6:g} MB")
    return content


def check_regular(path: Path) -> None:
    """Check, without opening it, that a path is that of a regular file: a pipe or device may never end.

    Raises:
        OSError: it is not.
    """
    if "\0" in str(path):
        raise OSError(errno.EINVAL, "there is a NUL in its name")
    mode = path.stat().st_mode
    if S_ISDIR(mode):
        raise OSError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not S_ISREG(mode):
        raise OSError(errno.EINVAL, "it is no regular file")
