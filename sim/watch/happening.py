"""What happens in a flight, in words."""

from enum import StrEnum
from typing import NamedTuple

from fsw.wire.messages import SENDERS, Severity
from sim.report.event_words import in_words


class Weight(StrEnum):
    """How much a happening matters; a pulse is the everyday of a flight."""

    PULSE = "pulse"
    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


class Occurrence(NamedTuple):
    """Something that happened: its number, when, and what. Tick and time are None before the first SYNC."""

    number: int
    tick: int | None
    unix_s: int | None
    weight: Weight
    words: str


_WEIGHTS = {Severity.INFO: Weight.INFO, Severity.WARNING: Weight.WARNING}


def event_words(can_id: int, severity: int, event: int, argument: int) -> tuple[Weight, str]:
    """An event of a node: its weight, and what happened."""
    node = SENDERS[can_id]
    words = in_words({"t_s": 0.0, "node": node, "severity": severity, "event": event, "argument": argument})
    weight = _WEIGHTS[Severity(severity)] if severity in _WEIGHTS else Weight.ERROR
    return weight, f"{node.lower()}: {words.what}"
