"""A recorded pass: samples of magnetometer, gyros and Sun cells with their times, from a CSV file."""

import csv
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite, isnan, nan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fsw.input.text_file import read_text
from sim.commissioning.recorded.columns import TIME, Places, places
from sim.errors import HarnessError

Array = NDArray[np.float64]

MOST_BYTES = 100_000_000
LEAST_ROWS = 3
LATEST_UNIX_S = 1e11
"""Three thousand years after 1970; in milliseconds, 1973."""
LONGEST_S = 30 * 86400.0
"""Of a pass: its element set holds no longer."""


@dataclass(frozen=True, slots=True)
class RecordedPass:
    """Samples in the order of time; NaN where a field of the file is empty.

    Attributes:
        name: of the file, without its suffix.
        utc_unix_s: times, (n).
        mag_nt: magnetometer as recorded, its own axes, (n, 3).
        gyro_degps: gyros as recorded, (n, 3); None: there are none.
        cells: currents of the Sun cells as recorded, (n), by their names.
        temperature_degc: (n); None: there is none.
        unused: columns that mean nothing here.
    """

    name: str
    utc_unix_s: Array
    mag_nt: Array
    gyro_degps: Array | None
    cells: dict[str, Array]
    temperature_degc: Array | None
    unused: tuple[str, ...]

    @property
    def middle_unix_s(self) -> float:
        """The middle of its time."""
        return 0.5 * float(self.utc_unix_s[0] + self.utc_unix_s[-1])


def read_pass(path: Path) -> RecordedPass:
    """The pass in a CSV file whose first line names its columns.

    Raises:
        HarnessError: it cannot be read, a column is missing, a field is no number, time goes back.
    """
    try:
        text = read_text(path, MOST_BYTES)
    except OSError as error:
        raise HarnessError(f"{path}: cannot be read ({error.strerror or error})") from None
    try:
        head, *rows = csv.reader(text.splitlines())
        where = places([name.strip() for name in head])
    except ValueError as error:
        said = "it is empty" if not text.strip() else error
        raise HarnessError(f"{path}: {said}") from None
    except csv.Error as error:
        raise HarnessError(f"{path}: not CSV: {error}") from None
    lines = [line for line, row in enumerate(rows, 2) if row]
    kept = [name.strip() not in where.unused for name in head]
    numbers = np.array([_numbers(path, line, rows[line - 2], head, kept) for line in lines])
    return _checked(path, lines, numbers, where)


def _numbers(path: Path, line: int, row: list[str], head: list[str], kept: list[bool]) -> list[float]:
    """The fields of a row as numbers; NaN of what is empty or in a column that is passed over."""
    if len(row) != len(head):
        raise HarnessError(f"{path}: line {line} has {len(row)} fields, the first line {len(head)}")
    fields = zip(head, row, kept, strict=True)
    return [_number(path, line, name, field) if known else nan for name, field, known in fields]


def _number(path: Path, line: int, name: str, field: str) -> float:
    if not field.strip():
        return nan
    try:
        value = float(field)
    except ValueError:
        value = None
    if value is None or not isfinite(value) or abs(value) > 1e15:
        raise HarnessError(f"{path}: line {line}, column {name!r}: {field.strip()!r:.60} is no finite number")
    return value


def _checked(path: Path, lines: list[int], numbers: Array, where: Places) -> RecordedPass:
    """The pass, whose times must be known and in order."""
    if len(numbers) < LEAST_ROWS:
        raise HarnessError(f"{path}: {len(numbers)} rows are too few, at least {LEAST_ROWS} are needed")
    times = numbers[:, where.time].tolist()
    for line, (before, after) in zip(lines[1:], pairwise(times), strict=True):
        if not before <= after:
            unknown = isnan(before) or isnan(after)
            said = "an empty field" if unknown else f"{after:.15g} after {before:.15g}"
            raise HarnessError(f"{path}: line {line}, column {TIME!r}: {said}; times must not go back")
    if times[-1] - times[0] > LONGEST_S and times[0] > LATEST_UNIX_S:
        raise HarnessError(f"{path}: column {TIME!r} begins with {times[0]:.15g}: is it in milliseconds?")
    if times[-1] - times[0] > LONGEST_S:
        raise HarnessError(
            f"{path}: the rows span {(times[-1] - times[0]) / 86400.0:.0f} days, at most "
            f"{LONGEST_S / 86400.0:.0f} are allowed: an element set holds no longer"
        )
    mag_nt = where.field_factor * numbers[:, list(where.field)]
    if np.isfinite(mag_nt).all(axis=1).sum() < LEAST_ROWS:
        raise HarnessError(f"{path}: fewer than {LEAST_ROWS} rows have a field sample")
    if not np.nanmax(np.ptp(mag_nt[np.isfinite(mag_nt).all(axis=1)], axis=0)) > 0.0:
        raise HarnessError(f"{path}: all field samples are equal: that is no magnetometer that works")
    return RecordedPass(
        name=path.stem,
        utc_unix_s=numbers[:, where.time],
        mag_nt=mag_nt,
        gyro_degps=None if where.gyro is None else where.gyro_factor * numbers[:, list(where.gyro)],
        cells={name: numbers[:, place] for name, place in sorted(where.cells.items())},
        temperature_degc=None if where.temperature is None else numbers[:, where.temperature],
        unused=where.unused,
    )
