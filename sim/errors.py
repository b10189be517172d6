"""What ends a command with a sentence instead of a traceback."""

import errno
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""``errno`` where a disk, a quota, the size of a file or shared memory is used up; it does not say which."""


class HarnessError(Exception):
    """The message is one sentence for the user; ``exit_code`` is what the process ends with."""

    exit_code = 2


class FlightError(HarnessError):
    """The flight ended before its time."""

    exit_code = 1


def refuse(given: Mapping[str, object], why: str) -> None:
    """Refuse options that would do nothing.

    Args:
        given: by option, what was given for it; nothing that is false was.
        why: the rest of the sentence.

    Raises:
        HarnessError: one of them is given.
    """
    if named := [option for option, value in given.items() if value]:
        raise HarnessError(f"{', '.join(named)}: {why}")


def is_out_of_memory(error: BaseException) -> bool:
    """Whether an error means that this process gets no more memory; a library that does not load says so."""
    if isinstance(error, OSError):
        return error.errno == errno.ENOMEM
    words = ("failed to map segment", "cannot allocate memory")
    return isinstance(error, MemoryError) or (
        isinstance(error, ImportError) and any(word in str(error).lower() for word in words)
    )


@contextmanager
def needing(what: str, package: str, extra: str) -> Iterator[None]:
    """Import in this block what an extra brings.

    Args:
        what: needs it, as the user says it.
        package: as it is installed; several with commas.
        extra: of torquer.

    Raises:
        HarnessError: it is not installed.
    """
    try:
        yield
    except ImportError as error:
        if is_out_of_memory(error):
            raise
        raise HarnessError(f"{what} needs {package}: pip install 'torquer[{extra}]'") from None


def reading(path: Path | str) -> AbstractContextManager[None]:
    """A block that reads this file.

    Raises:
        HarnessError: it cannot be read, and why.
    """
    return _naming(path, "read")


def writing(path: Path | str) -> AbstractContextManager[None]:
    """A block that writes this file, or into this folder.

    Raises:
        HarnessError: it cannot be written, and why.
    """
    return _naming(path, "written")


@contextmanager
def _naming(path: Path | str, done: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise HarnessError(f"{path}: cannot be {done} ({error.strerror or error})") from None
