"""What a notebook shows of a result: what ``print`` does."""

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

from sim.commissioning.report import CommissioningReport


class PrintedResult:
    """A result that a notebook shows as text."""

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"


# --- What wiring, calibration and recorded telemetry have shown, for programs


@dataclass(frozen=True)
class CommissioningResult(PrintedResult):
    """What was found; ``print`` shows what the command prints.

    Attributes:
        found: lines and values, as ``sim.commissioning`` gives them.
    """

    found: CommissioningReport

    @property
    def values(self) -> Mapping[str, Any]:
        """Everything, as ``--json`` prints it."""
        return self.found.values

    @property
    def ok(self) -> bool:
        """Whether the command ends with exit code 0."""
        return self.found.ok

    def __str__(self) -> str:
        return str(self.found)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {'ok' if self.ok else 'not ok'}>"
