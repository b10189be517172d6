"""What ends a command with a sentence instead of a traceback."""

import errno

DISK_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""``errno`` of an OSError that only means that there is no room."""


class HarnessError(Exception):
    """The message is one sentence for the user; ``exit_code`` is what the process ends with."""

    exit_code = 2


class FlightError(HarnessError):
    """The flight ended before its time."""

    exit_code = 1
