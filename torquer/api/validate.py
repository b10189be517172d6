"""``torquer.validate``: the published figures and reference checks."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from fsw.input.own_code import refuse_while_loading
from sim.campaign.claim import ClaimOutcome, ClaimVerdict
from sim.progress import shown
from sim.validate import command
from sim.validate.command import ValidateOptions, ValidationReport
from sim.validate.page import as_json, line
from torquer.api.arguments import checked, optional_path
from torquer.api.errors import one_sentence, required
from torquer.api.printed import PrintedResult

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Validation(PrintedResult):
    """Claims that were checked; ``print`` shows what the command prints.

    Attributes:
        found: the whole of it, as ``sim.validate`` gives it.
    """

    found: ValidationReport

    @property
    def outcomes(self) -> tuple[ClaimOutcome, ...]:
        """Each claim with its figure and verdict."""
        return self.found.outcomes

    @cached_property
    @one_sentence
    def table(self) -> "pd.DataFrame":
        """A row a claim, with figure, limits, verdict and source. Needs ``torquer[data]``."""
        rows = list(map(as_json, self.outcomes))
        table: pd.DataFrame = required("pandas", "validation.table").DataFrame(rows).set_index("id")
        return table

    @property
    def page(self) -> Path | None:
        """The page; None if it was not written."""
        return self.found.page

    @property
    def failures(self) -> tuple[str, ...]:
        """The claims that fail, a line each."""
        return tuple(line(one) for one in self.outcomes if one.verdict is ClaimVerdict.FAIL)

    @property
    def doubts(self) -> tuple[str, ...]:
        """What of the outcomes is to be looked at, a sentence each."""
        return self.found.doubts

    @property
    def ok(self) -> bool:
        """No claim fails; some may not be judged."""
        return self.found.ok

    def __str__(self) -> str:
        return "\n".join([*map(line, self.outcomes), self.found.tally])

    def __repr__(self) -> str:
        return f"<Validation: {self.found.tally}>"


@one_sentence
def validate(
    *,
    reference: str | PathLike[str] | None = None,
    flight_data: str | PathLike[str] | None = None,
    only: Sequence[str] = (),
    quick: bool = False,
    satellites: int | None = None,
    workers: int | None = None,
    out: str | PathLike[str] | None = None,
    record: bool = False,
    junit: str | PathLike[str] | None = None,
    tell: Callable[[ClaimOutcome], None] | None = None,
    progress: bool = False,
) -> Validation:
    """Check published figures and references, as ``torquer validate`` does; all take an hour or more.

    Args:
        reference: check against the reference files in this folder alone.
        flight_data: make the claims on recorded passes in this folder, alone.
        only: these claims alone, by the first words of their ids.
        quick: leave out flights.
        satellites: at most so many of each population; None: all.
        workers: processes; None: one a core.
        out: the page; None: none, unless all is run, or it is recorded.
        record: put the outcomes among those of ``validation.json``, and write the page of all.
        junit: file for the verdicts as JUnit XML.
        tell: called with each outcome once it is known; at the end, where a bar shows how far it is.
        progress: show progress on stderr.

    Raises:
        InputError: an argument, reference data that are malformed or missing, or a file to write.
    """
    options = checked(
        ValidateOptions,
        "validate",
        only=(only,) if isinstance(only, str) else only,
        quick=quick,
        satellites=satellites,
        workers=workers,
        record=record,
    )
    refuse_while_loading("torquer.validate")
    with shown(progress):
        return Validation(
            command.validate(
                options,
                reference_files=optional_path(reference, "reference"),
                flight_data=optional_path(flight_data, "flight_data"),
                out=optional_path(out, "out"),
                junit=optional_path(junit, "junit"),
                tell=tell or (lambda outcome: None),
            )
        )
