"""Checks that results can be written, made before anything is computed, so that no work is lost."""

import errno
import os
from collections.abc import Sequence
from contextlib import suppress
from datetime import UTC, datetime
from itertools import count
from pathlib import Path
from tempfile import TemporaryFile

from fsw.input.regular_file import check_regular
from sim.errors import HarnessError

_NOT_SUPPORTED = (errno.EBADF, errno.EINVAL, errno.EOPNOTSUPP)
"""Errors of a file system that allocates no space in advance; it is then allocated as it is written."""


def check_folder(folder: Path, names: Sequence[str] = ()) -> None:
    """Create a folder if it does not exist, and check that these files can be written into it.

    Raises:
        HarnessError: they cannot; the message says which, and why.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder):
            pass
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        raise HarnessError(f"{folder}: cannot be written ({_why(error)})") from None
    for name in names:
        _check_target(folder / name)


def new_folder(parent: Path, name: str) -> Path:
    """Create ``<parent>/<name>-<UTC time>``, with a number added if that exists; each call, another folder.

    Raises:
        HarnessError: it cannot be created.
    """
    check_folder(parent)
    stem = f"{name}-{datetime.now(UTC):%Y%m%dT%H%M%SZ}"
    for number in count(1):
        path = parent / (stem if number == 1 else f"{stem}-{number}")
        with suppress(FileExistsError):
            path.mkdir()
            break
    return path


def check_file(path: Path) -> None:
    """Create the folder of a file if it does not exist, and check that the file can be written.

    Raises:
        HarnessError: it cannot.
    """
    check_folder(path.parent)
    _check_target(path)


def allocate(path: Path, size: int) -> None:
    """Allocate the space of a file of histories on the disk.

    Raises:
        HarnessError: the disk does not have enough.
    """
    try:
        with path.open("ab") as file:
            os.posix_fallocate(file.fileno(), 0, size)
    except OSError as error:
        if error.errno in _NOT_SUPPORTED:
            return
        raise HarnessError(
            f"{path}: histories of this length need {size / 1e6:.1f} MB: {error.strerror}"
        ) from None


def _check_target(path: Path) -> None:
    """Check that a file of this path can be replaced: none that is a folder, a device or write-protected."""
    try:
        if os.path.islink(path) and os.readlink(path).startswith("/proc/"):
            raise ValueError("a stream of this process, and no file")
        if os.path.lexists(path):
            check_regular(path)
            if not os.path.islink(path):
                with path.open("ab"):
                    pass
        else:
            path.stat()
    except FileNotFoundError:
        return
    except (OSError, ValueError) as error:
        raise HarnessError(f"{path}: cannot be written ({_why(error)})") from None


def _why(error: OSError | ValueError) -> str:
    return getattr(error, "strerror", None) or str(error)
