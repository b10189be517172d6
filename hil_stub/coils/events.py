"""The events of a coil driver board."""

from enum import IntEnum
from typing import Final

from fsw.wire.frame import Frame
from fsw.wire.messages import CoilEvent, Severity


class CoilEventCode(IntEnum):
    """``event`` of ``COIL_EVENT``."""

    SELF_TEST_FAILED = 1
    DEAD_MAN = 2
    CURRENT_WHILE_OFF = 3
    NO_CURRENT = 4
    CURRENT_REVERSED = 5
    CURRENT_WRONG = 6


SEVERITY: Final = {
    CoilEventCode.SELF_TEST_FAILED: Severity.FATAL,
    CoilEventCode.DEAD_MAN: Severity.ERROR,
    CoilEventCode.CURRENT_WHILE_OFF: Severity.FATAL,
    CoilEventCode.NO_CURRENT: Severity.ERROR,
    CoilEventCode.CURRENT_REVERSED: Severity.ERROR,
    CoilEventCode.CURRENT_WRONG: Severity.WARNING,
}


class Events:
    """Encodes events, counted since boot."""

    def __init__(self) -> None:
        self._count = 0

    def frame(self, code: CoilEventCode, tick: int, argument: int = 0) -> Frame:
        """The frame of an event in ``tick``."""
        event = CoilEvent(SEVERITY[code], code, tick, argument, counter=self._count)
        self._count += 1
        return event.encode()
