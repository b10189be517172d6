"""Rows that an earlier run has flown, from its faults.json: a long campaign may be flown in parts."""

from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fsw.input.regular_file import read_regular
from fsw.input.schema import faults
from sim.errors import HarnessError
from sim.fault_table.render import injected
from sim.fault_table.row import CaseResult, RowResult
from sim.fault_table.rows import ROWS

MOST_BYTES = 64_000_000
"""A whole campaign of ten phases and five seeds takes 3 MB."""


class KeptRow(BaseModel):
    """What is read of a row: a row without a case has shown nothing."""

    model_config = ConfigDict(strict=True)

    row: str
    injected: str
    cases: Annotated[tuple[CaseResult, ...], Field(min_length=1)]


class Campaign(BaseModel):
    """A faults.json."""

    model_config = ConfigDict(strict=True)

    rows: tuple[KeptRow, ...]


def read(path: Path) -> dict[str, RowResult]:
    """The rows of a faults.json by name, those that the table no longer has left out.

    Raises:
        HarnessError: it is none, or a row was flown with another fault than the table has now.
    """
    by_name = {row.name: row for row in ROWS}
    try:
        campaign = Campaign.model_validate_json(read_regular(path, MOST_BYTES))
    except OSError as error:
        raise _none(path, f"cannot be read: {error.strerror}") from None
    except ValidationError as error:
        raise _none(path, faults(Campaign, error)) from None
    flown = [one for one in campaign.rows if one.row in by_name]
    other = [one.row for one in flown if one.injected != injected(by_name[one.row])]
    if other:
        raise HarnessError(f"--keep {path}: row {other[0]} was flown with another fault than it has now")
    return {one.row: RowResult(by_name[one.row], one.cases, kept=True) for one in flown}


def _none(path: Path, why: str) -> HarnessError:
    return HarnessError(f"--keep {path}: not the faults.json of a campaign ({why})")
