"""A bench log of magnetometers against dipole commands, as CSV: the response to each command, level by level.

Columns: ``log_time_s``, ``channel`` (``cmd``, or the name of a magnetometer), ``mag_x_nt``, ``mag_y_nt``,
``mag_z_nt``, ``cmd_x_am2``, ``cmd_y_am2``, ``cmd_z_am2``. Each change of the command is a step: what the
readings are after it, less what they were before.
"""

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from io import StringIO
from itertools import pairwise
from math import isfinite, isnan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fsw.input.text_file import read_text
from sim.commissioning.phasing.bench_steps import Edge, Share, Step, fall_as_rise, step_of
from sim.errors import HarnessError
from sim.value_types import Array

TIME, CHANNEL, COMMAND = "log_time_s", "channel", "cmd"
FIELD = ("mag_x_nt", "mag_y_nt", "mag_z_nt")
COMMANDED = ("cmd_x_am2", "cmd_y_am2", "cmd_z_am2")
MOST_BYTES = 100_000_000
LARGEST = 1e12
"""A number of a log, in nT, A m^2 or s, is below."""
LONGEST_S = 8.0
"""Of the readings before and after a step that are compared."""
SETTLED_S = 1.0
"""After a step the readings have settled, unless they show it later."""
SIGMAS = 5.0
CHANGED = 0.9
"""Part of a step from which a sample shows it."""
TIED_PART = 0.99
"""Of the samples in which an axis is the same or the opposite of another, for it to be no axis of its own."""


@dataclass(frozen=True, slots=True)
class Recording:
    """The times and readings of each magnetometer, and those of the commands."""

    fields: dict[str, tuple[Array, Array]]
    commands: tuple[Array, Array]


@dataclass(frozen=True, slots=True)
class BenchResponse:
    """What one magnetometer shows.

    Attributes:
        steps: by command.
        noise_nt: standard deviation of a reading with no command, about its mean in each off phase.
        tied: axes that only repeat another one, as words.
        drift_nt: between the first and the last phase without a command.
        cycle_s: time from one reading to the next, median.
    """

    name: str
    steps: tuple[Step, ...]
    noise_nt: Array
    tied: tuple[str, ...]
    drift_nt: Array
    cycle_s: float

    def latest_s(self) -> float:
        """The largest age at which a step is shown whole; 0 where none is clear."""
        return max((step.changed_s for step in self.steps if not isnan(step.changed_s)), default=0.0)


def is_bench_log(path: Path) -> bool:
    """Whether the file is such a CSV."""
    return path.suffix.lower() == ".csv"


def read_recording(path: Path) -> Recording:
    """The content of such a CSV.

    Raises:
        HarnessError: it cannot be read, or a column or number is not as it should be.
    """
    fields: dict[str, list[tuple[float, ...]]] = {}
    commands: list[tuple[float, ...]] = []
    for line, row in _rows(path):
        channel = row[CHANNEL]
        if not channel:
            raise HarnessError(f"{path}: line {line}: {CHANNEL} is missing")
        is_command = channel == COMMAND
        numbers = _numbers(path, line, row, COMMANDED if is_command else FIELD)
        (commands if is_command else fields.setdefault(channel, [])).append(numbers)
    if not commands or not fields:
        raise HarnessError(f"{path}: it holds no commands (channel {COMMAND}), or no readings")
    return Recording({name: _split(rows) for name, rows in fields.items()}, _split(commands))


def _rows(path: Path) -> Iterator[tuple[int, dict[str, str | None]]]:
    """Each row with the number of its line; None where a line ends before a column."""
    try:
        text = read_text(path, MOST_BYTES)
        reader = csv.DictReader(StringIO(text, newline=""))
        names = list(reader.fieldnames or ())
        missing = sorted({TIME, CHANNEL, *FIELD, *COMMANDED} - set(names))
        if missing:
            raise HarnessError(f"{path}: column {missing[0]} is missing: it is no bench log")
        if twice := [name for name in (TIME, CHANNEL, *FIELD, *COMMANDED) if names.count(name) > 1]:
            raise HarnessError(f"{path}: there are two columns {twice[0]!r}")
        for row in reader:
            yield reader.line_num, row
    except (OSError, csv.Error) as error:
        why = getattr(error, "strerror", None) or error
        raise HarnessError(f"{path}: cannot be read: {why}") from None


def _numbers(
    path: Path, line: int, row: dict[str, str | None], columns: tuple[str, ...]
) -> tuple[float, ...]:
    found = []
    for column in (TIME, *columns):
        try:
            number = float(row[column] or "nan")
        except (TypeError, ValueError):
            number = float("nan")
        if not isfinite(number):
            raise HarnessError(f"{path}: line {line}: {column} is {row[column]!r:.60}, which is no number")
        if abs(number) >= LARGEST:
            raise HarnessError(f"{path}: line {line}: {column} is {number:g}, beyond {LARGEST:g}")
        found.append(number)
    return tuple(found)


def _split(rows: list[tuple[float, ...]]) -> tuple[Array, Array]:
    table = np.array(rows)
    table = table[np.argsort(table[:, 0], kind="stable")]
    return table[:, 0], table[:, 1:4]


def bench_responses(recording: Recording) -> list[BenchResponse]:
    """The response of each magnetometer, by readings that show it whole.

    When it is whole, the second half of each phase tells; a response later than that would be one to the
    command before.
    """
    begun_s = [begin for begin, *_ in _phases(*recording.commands)]
    half_s = 0.5 * float(np.median(np.diff(begun_s))) if len(begun_s) > 1 else SETTLED_S
    found = []
    for name, (time_s, field_nt) in sorted(recording.fields.items()):
        late_s = _response(name, time_s, field_nt, recording.commands, half_s).latest_s()
        settled_s = max(SETTLED_S, min(late_s, half_s))
        found.append(_response(name, time_s, field_nt, recording.commands, settled_s))
    return found


def _response(
    name: str, time_s: Array, field_nt: Array, commands: tuple[Array, Array], settled_s: float
) -> BenchResponse:
    """The response, of readings that are older than ``settled_s`` when a command has changed."""
    phases = _phases(*commands)
    inside = [(begin, end, command, _between(time_s, begin, end)) for begin, end, command in phases]
    settled = [rows[time_s[rows] > begin + settled_s] for begin, _, _, rows in inside]
    idle = [rows for phase, rows in zip(inside, settled, strict=True) if not any(phase[2]) and len(rows) > 3]
    spread = [field_nt[rows] - field_nt[rows].mean(axis=0) for rows in idle]
    noise = np.sqrt(np.mean(np.vstack(spread) ** 2, axis=0)) if spread else np.full(3, np.nan)
    by_command: dict[tuple[float, float, float], list[Edge]] = {}
    for (before, old), (after, new) in pairwise(zip(inside, settled, strict=True)):
        edge_s, rise = after[0], not any(before[2])
        near_old, near_new = old[time_s[old] > edge_s - LONGEST_S], new[time_s[new] < edge_s + LONGEST_S]
        if rise == (not any(after[2])) or min(len(near_old), len(near_new)) < 3:
            continue
        edge = _edge(time_s, field_nt, after, near_old, near_new)
        if rise:
            by_command.setdefault(after[2], []).append(edge)
        else:
            by_command.setdefault(before[2], []).append(fall_as_rise(edge))
    steps = [step_of(command, edges) for command, edges in sorted(by_command.items())]
    drift = field_nt[idle[-1]].mean(axis=0) - field_nt[idle[0]].mean(axis=0) if idle else np.full(3, np.nan)
    moments_s = np.unique(time_s)
    cycle_s = float(np.median(np.diff(moments_s))) if len(moments_s) > 1 else 0.0
    return BenchResponse(name, tuple(steps), noise, _tied(field_nt, noise), drift, cycle_s)


Phase = tuple[float, float, tuple[float, float, float], NDArray[np.int64]]


def _phases(time_s: Array, commands: Array) -> list[tuple[float, float, tuple[float, float, float]]]:
    """Begin, end and command of each run of one command."""
    changes = [0, *(np.flatnonzero(np.any(np.diff(commands, axis=0) != 0.0, axis=1)) + 1).tolist()]
    found = []
    for place, begin in enumerate(changes):
        end = changes[place + 1] if place + 1 < len(changes) else None
        x, y, z = commands[begin].tolist()
        found.append((float(time_s[begin]), float(time_s[end]) if end else np.inf, (x, y, z)))
    return found


def _between(time_s: Array, begin_s: float, end_s: float) -> NDArray[np.int64]:
    return np.flatnonzero((time_s > begin_s) & (time_s < end_s))


def _edge(
    time_s: Array, field_nt: Array, after: Phase, old: NDArray[np.int64], new: NDArray[np.int64]
) -> Edge:
    """The edge at which a phase begins; ``old``, ``new``: settled readings before and after it."""
    edge_s, _, _, since = after
    step = field_nt[new].mean(axis=0) - field_nt[old].mean(axis=0)
    rounding = _quantum(field_nt) ** 2 / 12.0
    before, later = (
        Share(rows, sign / len(rows), np.maximum(field_nt[rows].var(axis=0), rounding))
        for rows, sign in ((old, -1.0), (new, 1.0))
    )
    weight = step / max(float(step @ step), 1e-30)
    parts = (field_nt[since] - field_nt[old].mean(axis=0)) @ weight
    ages_s = time_s[since] - edge_s
    changed = int(np.argmax(parts > CHANGED)) if (parts > CHANGED).any() else len(parts) - 1
    unchanged_s = float(ages_s[changed - 1]) if changed and parts[changed - 1] < 1.0 - CHANGED else 0.0
    return Edge(step, (before, later), unchanged_s, float(ages_s[changed]))


def _quantum(field_nt: Array) -> float:
    """The step of a reading: the smallest difference between two; 0 where all are equal."""
    return float(np.diff(np.unique(field_nt)).min(initial=np.inf)) if np.ptp(field_nt) > 0.0 else 0.0


def _tied(field_nt: Array, noise: Array) -> tuple[str, ...]:
    """Axes that repeat another one, or its opposite, within a step of the reading in nearly every sample."""
    quantum = _quantum(field_nt)
    found = []
    for one, other in ((0, 1), (0, 2), (1, 2)):
        for sign, word in ((1.0, ""), (-1.0, "-")):
            same = np.abs(field_nt[:, other] - sign * field_nt[:, one]) <= quantum
            if same.mean() > TIED_PART:
                found.append(f"{'xyz'[other]} = {word}{'xyz'[one]}")
    return tuple(found)
