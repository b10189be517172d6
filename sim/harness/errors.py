"""What ends a command with a sentence instead of a traceback."""


class HarnessError(Exception):
    """The message is one sentence for the user; ``exit_code`` is what the process ends with."""

    exit_code = 2
