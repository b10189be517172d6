"""Errors that end the plant."""

from typing import ClassVar


class PlantError(ValueError):
    """The plant cannot continue: a model ends, or the integration diverges; the message is a clause.

    ``exit_code`` is that of a process which this error ends in flight.
    """

    exit_code: ClassVar[int] = 1
