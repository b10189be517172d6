"""A recorded pass: samples of magnetometer, gyros and Sun cells with their times, from a CSV file."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import isfinite, nan
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsw.input.text_file import read_text
from sim.commissioning.recorded.columns import TIME, Places, places
from sim.commissioning.recorded.strays import most_left_out
from sim.errors import HarnessError, reading
from sim.value_types import Array

Mask = NDArray[np.bool_]

MOST_BYTES = 100_000_000
LEAST_ROWS = 3
LATEST_UNIX_S = 1e11
"""Three thousand years after 1970; in milliseconds, 1973."""
LONGEST_S = 30 * 86400.0
"""Of a pass: its element set holds no longer."""
APART_S, APART_STEPS = 600.0, 10.0
"""A few rows are not of the pass beyond a gap of so long, and of so many of its longer steps."""
LINES_NAMED = 5
UNREADABLE, NO_TIME, NOT_IN_ORDER, FAR_IN_TIME, REPEATED = (
    "with a field that is no number, or with fields missing",
    "without a time",
    "whose time is out of order",
    "far in time from all others",
    "that repeat another",
)
TIMES = (FAR_IN_TIME, NOT_IN_ORDER)


class LeftOut(NamedTuple):
    """Rows of a file that are not used: why, in words that follow "rows", and their lines."""

    why: str
    lines: tuple[int, ...]


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
        lines: of the file, (n).
        left_out: rows of the file that are not among them.
    """

    name: str
    utc_unix_s: Array
    mag_nt: Array
    gyro_degps: Array | None
    cells: dict[str, Array]
    temperature_degc: Array | None
    unused: tuple[str, ...]
    lines: NDArray[np.int64]
    left_out: tuple[LeftOut, ...]

    @property
    def middle_unix_s(self) -> float:
        """The middle of its time."""
        return 0.5 * float(self.utc_unix_s[0] + self.utc_unix_s[-1])

    @property
    def rows_left_out(self) -> int:
        """How many rows of the file are not among them."""
        return sum(len(one.lines) for one in self.left_out)

    @property
    def rows_in_file(self) -> int:
        """How many rows the file has."""
        return len(self.lines) + self.rows_left_out

    def may_lack(self, rows: int, *whys: str) -> bool:
        """Whether so many more rows may be left out for one of some reasons: at most a tenth for these.

        Rows that are left out for another reason count as if they had never been there.
        """
        lost = sum(len(one.lines) for one in self.left_out if one.why in whys)
        return lost + rows <= most_left_out(len(self.lines) + lost) and len(self.lines) - rows >= LEAST_ROWS

    def without(self, rows: Mask, why: str) -> "RecordedPass":
        """The pass without these rows, (n)."""
        if not rows.any():
            return self
        kept = ~rows
        return replace(
            self,
            utc_unix_s=self.utc_unix_s[kept],
            mag_nt=self.mag_nt[kept],
            gyro_degps=None if self.gyro_degps is None else self.gyro_degps[kept],
            cells={name: current[kept] for name, current in self.cells.items()},
            temperature_degc=None if self.temperature_degc is None else self.temperature_degc[kept],
            lines=self.lines[kept],
            left_out=_added(self.left_out, why, self.lines[rows].tolist()),
        )

    def said_left_out(self) -> str:
        """How many rows were left out, and why, in words; empty if none were."""
        if not self.left_out:
            return ""
        parts = [f"{len(one.lines)} {one.why} ({_in_words(one.lines)})" for one in self.left_out]
        return f"{self.rows_left_out} of {self.rows_in_file} rows left out: {', '.join(parts)}"


def _added(left_out: tuple[LeftOut, ...], why: str, lines: list[int]) -> tuple[LeftOut, ...]:
    before = {one.why: one.lines for one in left_out}
    before[why] = tuple(sorted((*before.get(why, ()), *lines)))
    return tuple(LeftOut(*one) for one in before.items())


def _in_words(lines: Sequence[int]) -> str:
    named = ", ".join(map(str, lines[:LINES_NAMED]))
    more = len(lines) - LINES_NAMED
    return f"line{'s' * (len(lines) > 1)} {named}" + (f" and {more} more" if more > 0 else "")


def read_pass(path: Path) -> RecordedPass:
    """The pass in a CSV file whose first line names its columns.

    Rows that cannot be read, or whose time is not of the pass, are left out, a tenth of all at most.

    Raises:
        HarnessError: it cannot be read, a column is missing, too many rows are of no use.
    """
    with reading(path):
        text = read_text(path, MOST_BYTES)
    try:
        head, *rows = csv.reader(text.splitlines())
        where = places([name.strip() for name in head])
    except ValueError as error:
        said = "it is empty" if not text.strip() else error
        raise HarnessError(f"{path}: {said}") from None
    except csv.Error as error:
        raise HarnessError(f"{path}: not CSV: {error}") from None
    return _in_order(path, _read_rows(path, [name.strip() for name in head], rows, where))


class _NoRowError(ValueError):
    """A row that cannot be read; ``why`` in words that follow "rows"."""

    def __init__(self, why: str, said: str) -> None:
        super().__init__(said)
        self.why = why


def _read_rows(path: Path, head: list[str], rows: list[list[str]], where: Places) -> RecordedPass:
    """The rows that can be read, in the order of the file."""
    known = [name not in where.unused for name in head]
    numbers, lines, unread = [], [], []
    for line, row in enumerate(rows, 2):
        if row:
            try:
                numbers.append(_numbers(row, head, known))
                lines.append(line)
            except _NoRowError as error:
                unread.append((line, error))
    left_out: tuple[LeftOut, ...] = ()
    for line, fault in unread:
        left_out = _added(left_out, fault.why, [line])
    if len(unread) > most_left_out(len(lines) + len(unread)):
        line, fault = unread[0]
        raise HarnessError(f"{path}: line {line}{fault}{_as_many(len(unread), len(lines) + len(unread))}")
    if len(numbers) < LEAST_ROWS:
        raise HarnessError(f"{path}: {len(numbers)} rows are too few, at least {LEAST_ROWS} are needed")
    return _recorded(path.stem, np.array(numbers), np.array(lines), where, left_out)


def _as_many(bad: int, rows: int) -> str:
    return "" if bad == 1 else f"; {bad} of {rows} rows are like that, and at most a tenth may be left out"


def _numbers(row: list[str], head: list[str], known: list[bool]) -> list[float]:
    """The fields of a row as numbers; NaN of what is empty or in a column that is passed over."""
    if len(row) != len(head):
        raise _NoRowError(UNREADABLE, f" has {len(row)} fields, the first line {len(head)}")
    return [_number(name, field) if used else nan for name, field, used in zip(head, row, known, strict=True)]


def _number(name: str, field: str) -> float:
    if not field.strip():
        if name == TIME:
            raise _NoRowError(NO_TIME, f", column {TIME!r}: an empty field")
        return nan
    try:
        value = float(field)
    except ValueError:
        value = None
    if value is None or not isfinite(value) or abs(value) > 1e15:
        raise _NoRowError(UNREADABLE, f", column {name!r}: {field.strip()!r:.60} is no finite number")
    return value


def _recorded(
    name: str, numbers: Array, lines: NDArray[np.int64], where: Places, left_out: tuple[LeftOut, ...]
) -> RecordedPass:
    return RecordedPass(
        name=name,
        utc_unix_s=numbers[:, where.time],
        mag_nt=where.field_factor * numbers[:, list(where.field)],
        gyro_degps=None if where.gyro is None else where.gyro_factor * numbers[:, list(where.gyro)],
        cells={name: numbers[:, place] for name, place in sorted(where.cells.items())},
        temperature_degc=None if where.temperature is None else numbers[:, where.temperature],
        unused=where.unused,
        lines=lines,
        left_out=left_out,
    )


def _in_order(path: Path, recorded: RecordedPass) -> RecordedPass:
    """The pass without rows whose times are not of it, and without rows that are there twice."""
    far = far_in_time(recorded.utc_unix_s)
    near = recorded.without(far, FAR_IN_TIME) if recorded.may_lack(int(far.sum()), *TIMES) else recorded
    disordered = ~in_longest_order(near.utc_unix_s)
    if not near.may_lack(int(disordered.sum()), *TIMES):
        times = near.utc_unix_s.tolist()
        for line, (before, after) in zip(near.lines[1:], pairwise(times), strict=True):
            if after < before:
                many = _as_many(int(disordered.sum()), near.rows_in_file)
                raise HarnessError(
                    f"{path}: line {line}, column {TIME!r}: {after:.15g} after {before:.15g}; times must not "
                    f"go back{many}"
                )
    ordered = near.without(disordered, NOT_IN_ORDER)
    times = ordered.utc_unix_s
    if times[-1] - times[0] > LONGEST_S and times[0] > LATEST_UNIX_S:
        raise HarnessError(f"{path}: column {TIME!r} begins with {times[0]:.15g}: is it in milliseconds?")
    if times[-1] - times[0] > LONGEST_S:
        raise HarnessError(
            f"{path}: the rows span {(times[-1] - times[0]) / 86400.0:.0f} days, at most "
            f"{LONGEST_S / 86400.0:.0f} are allowed: an element set holds no longer"
        )
    mag_nt = ordered.mag_nt[np.isfinite(ordered.mag_nt).all(axis=1)]
    if len(mag_nt) < LEAST_ROWS:
        raise HarnessError(f"{path}: fewer than {LEAST_ROWS} rows have a field sample")
    if not np.max(np.ptp(mag_nt, axis=0)) > 0.0:
        raise HarnessError(f"{path}: all field samples are equal: that is no magnetometer that works")
    return ordered.without(repeated(ordered), REPEATED)


def in_longest_order(times_s: Array) -> Mask:
    """Which rows are kept so that times do not go back and most rows stay.

    Of several ways, that in which most times differ; of these, that which spans the least.
    """
    if (np.diff(times_s) >= 0.0).all():
        return np.ones(len(times_s), dtype=np.bool_)
    distinct, place = np.unique(times_s, return_inverse=True)
    chains = _Chains(len(distinct))
    before = [chains.append(row, time) for row, time in enumerate(place.tolist())]
    kept = np.zeros(len(times_s), dtype=np.bool_)
    row = max(chains.at, key=lambda one: (*one[:2], -distinct[place[one[3]]] + distinct[one[2]]))[3]
    while row >= 0:
        kept[row] = True
        row = before[row]
    return kept


class _Chains:
    """The best chain of rows in order that ends at each time: (rows, times, first time, last row).

    Times are numbered in their order. The best of all that end before a time is found in a tree of maxima
    (Fenwick 1994).
    """

    def __init__(self, times: int) -> None:
        self.at = [(0, 0, 0, -1)] * times
        self._tree = [(0, 0, 0, -1)] * (times + 1)

    def append(self, row: int, time: int) -> int:
        """Let a row follow the best chain that it can; the row before it, -1 if it is the first."""
        shorter, node = (0, 0, time, -1), time
        while node > 0:
            shorter = max(shorter, self._tree[node])
            node -= node & -node
        same = self.at[time]
        longer = max((shorter[0] + 1, shorter[1] + 1, shorter[2], shorter[3]), (same[0] + 1, *same[1:]))
        self.at[time] = (*longer[:3], row)
        node = time + 1
        while node < len(self._tree):
            self._tree[node] = max(self._tree[node], self.at[time])
            node += node & -node
        return longer[3]


def far_in_time(times_s: Array) -> Mask:
    """Which rows a gap sets apart from the greatest part of the pass, whatever their order."""
    order = np.argsort(times_s, kind="stable")
    steps = np.diff(times_s[order])
    apart = steps > max(APART_S, APART_STEPS * float(np.percentile(steps, 90.0)))
    part = np.concatenate(([0], np.cumsum(apart)))
    far = np.empty(len(times_s), dtype=np.bool_)
    far[order] = part != np.bincount(part).argmax()
    return far


def repeated(recorded: RecordedPass) -> Mask:
    """Which rows have the time and all values of one before."""
    columns = [recorded.utc_unix_s, *recorded.mag_nt.T, *recorded.cells.values()]
    columns += [] if recorded.gyro_degps is None else list(recorded.gyro_degps.T)
    columns += [] if recorded.temperature_degc is None else [recorded.temperature_degc]
    seen: set[bytes] = set()
    twice = []
    for row in np.column_stack(columns):
        values = row.tobytes()
        twice.append(values in seen)
        seen.add(values)
    return np.array(twice)
