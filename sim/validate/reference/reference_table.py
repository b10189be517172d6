"""Reference data in files: comment lines, then a table with named columns."""

import csv
from collections.abc import Sequence
from datetime import datetime
from math import isfinite
from pathlib import Path

import numpy as np

from fsw.input.text_file import read_text
from sim.errors import HarnessError, reading
from sim.value_types import Array

MOST_BYTES = 16_000_000

DATA = Path(__file__).with_name("data")
"""The reference files that ship; its README.md says what made each."""

_LABELS = ("case", "name", "kind", "utc_iso", "t_s")
"""Columns that identify a row for a reader."""


class ReferenceTable:
    """A CSV file: lines that begin with ``#``, a line of column names, rows.

    Args:
        path: the file.

    Raises:
        HarnessError: the file cannot be read, has no rows, or a row has more or fewer fields than names.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        lines = read_lines(path)
        self.comments = [line.lstrip("#").strip() for _, line in lines if line.startswith("#")]
        rows = [(number, line) for number, line in lines if line.strip() and not line.startswith("#")]
        if len(rows) < 2:
            raise HarnessError(f"{path}: no rows of data")
        fields = [_fields(path, number, line) for number, line in rows]
        self._names_line, self.names = rows[0][0], fields[0]
        self.lines = [number for number, _ in rows[1:]]
        self._rows = fields[1:]
        self._read: set[str] = set()
        for line, row in zip(self.lines, self._rows, strict=True):
            if len(row) != len(self.names):
                first = self.names[min(len(row), len(self.names) - 1)]
                raise HarnessError(
                    f"{path}, line {line}, column {first}: {len(row)} fields, but {len(self.names)} names"
                )

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def unused(self) -> list[str]:
        """Columns that were not read."""
        return [name for name in self.names if name not in self._read]

    def texts(self, name: str) -> list[str]:
        """A column as it is written.

        Raises:
            HarnessError: there is no such column.
        """
        if name not in self.names:
            raise HarnessError(f"{self.path}, line {self._names_line}: there is no column {name}")
        self._read.add(name)
        place = self.names.index(name)
        return [row[place] for row in self._rows]

    def column(self, name: str) -> Array:
        """A column of finite numbers, (n,).

        Raises:
            HarnessError: there is no such column, or a field of it is no finite number.
        """
        numbers = []
        for line, text in zip(self.lines, self.texts(name), strict=True):
            number = _number(text)
            if number is None:
                raise HarnessError(f"{self.path}, line {line}, column {name}: '{text}' is no finite number")
            numbers.append(number)
        return np.array(numbers)

    def columns(self, *names: str) -> Array:
        """Several columns, (n, k); raises as ``column`` does."""
        return np.stack([self.column(name) for name in names], axis=1)

    def unix_s(self, name: str) -> Array:
        """A column of UTC times in ISO 8601, as Unix seconds, (n,).

        Raises:
            HarnessError: there is no such column, or a field of it is no time with a time zone.
        """
        times = []
        for line, text in zip(self.lines, self.texts(name), strict=True):
            try:
                time = datetime.fromisoformat(text)
            except ValueError:
                time = None
            if time is None or time.tzinfo is None:
                raise HarnessError(
                    f"{self.path}, line {line}, column {name}: '{text}' is no time like 2025-03-20T09:00:00Z"
                )
            times.append(time.timestamp())
        return np.array(times)

    def header(self, start: str, count: int) -> list[float]:
        """The numbers behind the last ``=`` of the comment that begins with ``start``.

        Raises:
            HarnessError: there is no such comment, or not so many finite numbers in it.
        """
        line = self.comment(start)
        if line is None:
            raise HarnessError(f"{self.path}: the header has no line '{start} ... = ...'")
        return self.numbers_after(f"{line} ", "= ", count, start)

    def numbers_after(self, line: str, sign: str, count: int, what: str) -> list[float]:
        """``count`` numbers after the last ``sign`` in a comment.

        Raises:
            HarnessError: there are fewer.
        """
        words = line.rpartition(sign)[2].replace(";", " ").replace(",", " ").split()[:count]
        numbers = [number for word in words if (number := _number(word)) is not None]
        if len(numbers) != count:
            raise HarnessError(f"{self.path}: the header's line '{what} ...' does not give {count} numbers")
        return numbers

    def comment(self, part: str) -> str | None:
        """The first comment that begins with, else that holds ``part``."""
        begins = [line for line in self.comments if line.startswith(part)]
        return next(iter(begins + [line for line in self.comments if part in line]), None)

    def label(self, row: int) -> str:
        """A text that identifies a row."""
        named = [(name, self._rows[row][self.names.index(name)]) for name in _LABELS if name in self.names]
        text = ", ".join(f"{name} {value}" for name, value in named)
        return f"{self.path.name} line {self.lines[row]} ({text})"


def read_lines(path: Path) -> list[tuple[int, str]]:
    """The lines of a text file with their numbers.

    Raises:
        HarnessError: it cannot be read as text.
    """
    with reading(path):
        text = read_text(path, MOST_BYTES)
    return list(enumerate(text.splitlines(), start=1))


def names_of(stem: str, parts: Sequence[object], end: str = "") -> list[str]:
    """Column names that differ in one part: ``stem`` + part + ``end``."""
    return [f"{stem}{part}{end}" for part in parts]


def _fields(path: Path, number: int, line: str) -> list[str]:
    """The fields of a line; a quoted one ends in its line."""
    try:
        (fields,) = csv.reader([line], strict=True)
    except csv.Error as error:
        raise HarnessError(f"{path}, line {number}: {error}") from None
    return [field.strip() for field in fields]


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if isfinite(number) else None
