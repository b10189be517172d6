"""What a command of commissioning has found, in words and values."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple


class ReportLine(NamedTuple):
    """A line for people; one that tells of a failure is said by a quiet command too."""

    text: str
    failed: bool = False


@dataclass(frozen=True, slots=True)
class CommissioningReport:
    """What was found.

    Attributes:
        lines: it, for people.
        values: the same as values of JSON.
        ok: whether it is as it should be, and all of it is determined.
    """

    lines: tuple[ReportLine, ...]
    values: Mapping[str, Any]
    ok: bool

    def __str__(self) -> str:
        return "\n".join(line.text for line in self.lines)


def in_lines(texts: Iterable[str], failed: bool = False) -> list[ReportLine]:
    """Texts as lines of one kind."""
    return [ReportLine(text, failed) for text in texts]
