"""Results of an earlier campaign, from its faults.json: a long campaign may be run in parts."""

from collections.abc import Collection
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from fsw.input.regular_file import read_regular
from fsw.input.schema import faults
from sim.errors import HarnessError
from sim.fault_table.render import injected
from sim.fault_table.row import CaseResult, RowResult
from sim.fault_table.rows.table import ROWS

MOST_BYTES = 64_000_000
"""A whole campaign of ten phases and five seeds takes 6 MB."""


class EarlierRow(BaseModel):
    """The keys of a row that are read; each row has at least one case."""

    model_config = ConfigDict(strict=True)

    row: str
    injected: str
    code: str = ""
    cases: Annotated[tuple[CaseResult, ...], Field(min_length=1)]


class CampaignFile(BaseModel):
    """A faults.json."""

    model_config = ConfigDict(strict=True)

    rows: tuple[EarlierRow, ...]


def read(path: Path, flown_now: Collection[str] = ()) -> dict[str, RowResult]:
    """The results in a faults.json by name, without rows that the table no longer has.

    Args:
        path: the file; where there is none, there are no results.
        flown_now: names of rows; those whose fault has changed since are left out.

    Raises:
        HarnessError: it is not a faults.json, or the fault of a row that is not flown now has changed since.
    """
    by_name = {row.name: row for row in ROWS}
    try:
        campaign = CampaignFile.model_validate_json(read_regular(path, MOST_BYTES))
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise _not_a_campaign(path, f"cannot be read: {error.strerror}") from None
    except ValidationError as error:
        raise _not_a_campaign(path, faults(CampaignFile, error)) from None
    current = [one for one in campaign.rows if one.row in by_name]
    other = [one.row for one in current if one.injected != injected(by_name[one.row])]
    refused = [name for name in other if name not in flown_now]
    if refused:
        raise HarnessError(f"--keep {path}: row {refused[0]} was flown with another fault than it has now")
    return {
        one.row: RowResult(by_name[one.row], one.cases, one.code) for one in current if one.row not in other
    }


def _not_a_campaign(path: Path, why: str) -> HarnessError:
    return HarnessError(f"--keep {path}: not the faults.json of a campaign ({why})")
