"""What ends a command with a sentence instead of a traceback."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager

DISK_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""``errno`` of an OSError that only means that there is no room."""


class HarnessError(Exception):
    """The message is one sentence for the user; ``exit_code`` is what the process ends with."""

    exit_code = 2


class FlightError(HarnessError):
    """The flight ended before its time."""

    exit_code = 1


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
    except ImportError:
        raise HarnessError(f"{what} needs {package}: pip install 'torquer[{extra}]'") from None
