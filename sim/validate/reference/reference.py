"""Reference checks: files of known formats in a folder, each compared with this code."""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from sim.campaign.claim import Claim, ClaimOutcome, ClaimVerdict, Study
from sim.errors import HarnessError
from sim.validate.reference import attitude_check, environment_check, floquet_check, triad_check
from sim.validate.reference.comparison import ReferenceComparison
from sim.validate.reference.reference_table import DATA, ReferenceTable

Check = Callable[[ReferenceTable], Iterator[ReferenceComparison]]

CHECKS: dict[str, Check] = {
    "igrf14.csv": environment_check.check_field,
    "earth_sun.csv": environment_check.check_earth_and_sun,
    "eclipse.csv": environment_check.check_eclipse,
    "attitude_*.csv": attitude_check.check,
    "floquet.csv": floquet_check.check,
    "triad_mekf.csv": triad_check.check,
}
"""By file name; a pattern may match several files."""

ELEMENTS = "tle.txt"


@dataclass(frozen=True, slots=True)
class FileResult:
    """The result of one file; ``unused`` are the columns that no check read."""

    name: str
    rows: int
    unused: tuple[str, ...]
    outcomes: tuple[ClaimOutcome, ...]


def studies(folder: Path) -> list[Study]:
    """The checks of a folder, one study per file; a format without a file is reported as absent.

    Raises:
        HarnessError: it is not a folder, or has no file of a known format.
    """
    if not os.path.isdir(folder):  # unlike Path.is_dir, never an error, whatever the name
        raise HarnessError(f"{folder} is no folder")
    patterns = [*CHECKS, ELEMENTS]
    files = {pattern: sorted(folder.glob(pattern)) for pattern in patterns}
    if not any(files.values()):
        raise HarnessError(f"{folder} holds none of the reference files {', '.join(patterns)}")
    return [study for pattern in patterns for study in _studies(pattern, files[pattern])]


def shipped_studies(folder: Path = DATA) -> list[Study]:
    """The checks of the reference files that ship.

    Raises:
        HarnessError: one of the formats is missing there.
    """
    if missing := [pattern for pattern in [*CHECKS, ELEMENTS] if not any(folder.glob(pattern))]:
        raise HarnessError(f"{folder}: the reference data are not installed: {', '.join(missing)}")
    return studies(folder)


def check_file(path: Path, pattern: str) -> FileResult:
    """Check one file.

    Raises:
        HarnessError: it is malformed.
    """
    try:
        if pattern == ELEMENTS:
            outcomes = tuple(environment_check.check_elements(path))
            return FileResult(path.name, len(environment_check.read_elements(path)), (), outcomes)
        table = ReferenceTable(path)
        outcomes = tuple(comparison.outcome(table) for comparison in CHECKS[pattern](table))
        return FileResult(path.name, len(table), tuple(table.unused), outcomes)
    except (ArithmeticError, ValueError, np.linalg.LinAlgError) as error:
        raise HarnessError(f"{path}: a row cannot be computed ({error})") from None


def _studies(pattern: str, files: list[Path]) -> list[Study]:
    stem = Path(pattern).stem
    if not files:
        claim = Claim(f"reference.{stem.rstrip('_*')}", f"{pattern}", pattern, "")
        return [Study(claim.id, (), lambda results: [ClaimOutcome(claim, ClaimVerdict.ABSENT)])]
    return [
        Study(f"reference.{path.stem}", (partial(check_file, path, pattern),), _outcomes) for path in files
    ]


def _outcomes(results: Sequence[Any]) -> list[ClaimOutcome]:
    return [outcome for checked in results for outcome in checked.outcomes]
