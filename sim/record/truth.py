"""truth.h5: the plant's histories, one row per tick.

All datasets get their full length when the file is created, contiguous and filled with NaN. From then on
only rows change, never the structure, so that a process killed at any moment leaves a file that opens; and
the space is allocated at once, so that a disk that is too small is found before the flight.
"""

import re
import time
from array import array
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from types import TracebackType
from typing import Self

import h5py
import numpy as np
from numpy.typing import NDArray

from fsw.input.regular_file import check_regular
from sim.errors import HarnessError
from sim.plant.truth_row import TruthRow
from sim.record.destination import allocate

BLOCK_ROWS = 1024
BLOCK_S = 0.5
"""A block older than this is written with the next row, however short it is."""
ROOM_FOR_STRUCTURE = 8192

Histories = dict[str, NDArray[np.float64]]
Attributes = Mapping[str, int | str]
"""What identifies the flight: scenario, seed, epoch, tick rate, version."""

COLUMNS: tuple[tuple[str, int, str, str], ...] = (
    ("t_s", 1, "s", "time since tick 0"),
    ("q_body_from_orbit", 4, "1", "attitude, scalar first"),
    ("omega_body_orbit_radps", 3, "rad/s", "rate of the body relative to the orbital frame, body axes"),
    ("b_body_t", 3, "T", "geomagnetic field, body axes"),
    ("sun_body", 3, "1", "unit vector to the Sun, body axes"),
    ("lit", 1, "1", "visible fraction of the Sun"),
    ("m_body_am2", 3, "A m^2", "mean coil dipole over the tick that ends here, body axes"),
    ("r_eci_m", 3, "m", "position, TEME of date"),
)
"""Name, width, unit and meaning of the datasets; torques follow, one dataset per source."""
OF_WHEEL = ("wheel_nms", 1, "N m s", "momentum of the driven wheel relative to the body, along its axis")
"""The last dataset, where there is such a wheel."""


class TruthFile:
    """Writes one row per tick, in blocks: a kill leaves whole rows, at most a block short.

    Args:
        path: of the file.
        ticks: rows that it will have.
        torque_sources: names of the torques.
        attributes: of the file.
        wheel: the satellite has a wheel that is driven.

    Raises:
        HarnessError: the disk cannot hold the histories of ``ticks`` ticks.
    """

    def __init__(
        self,
        path: Path,
        ticks: int,
        torque_sources: tuple[str, ...],
        attributes: Attributes | None = None,
        wheel: bool = False,
    ) -> None:
        self._columns = sum(width for _, width, *_ in COLUMNS) + 3 * len(torque_sources) + wheel
        allocate(path, 8 * ticks * self._columns + ROOM_FOR_STRUCTURE)
        self._file = h5py.File(path, "w", libver="earliest")
        self._file.attrs.update(attributes or {})
        torques = tuple(
            (f"torque_body_nm/{source}", 3, "N m", f"torque by {source}, body axes")
            for source in torque_sources
        )
        self._datasets = []
        for name, width, unit, meaning in (*COLUMNS, *torques, *((OF_WHEEL,) if wheel else ())):
            shape = (ticks,) if width == 1 else (ticks, width)
            dataset = self._file.create_dataset(name, shape, dtype="f8", fillvalue=np.nan)
            dataset.attrs["unit"] = unit
            dataset.attrs["meaning"] = meaning
            dataset[0:1] = np.nan  # allocates the space now: the structure is final before the first row
            self._datasets.append((dataset, width))
        self._buffer = array("d")
        self._written = 0
        self._written_s = time.monotonic()
        self._file.flush()
        allocate(path, path.stat().st_size)

    def append(self, row: TruthRow) -> None:
        """Add the row of the next tick."""
        self._buffer.fromlist(row.numbers())
        full = len(self._buffer) >= BLOCK_ROWS * self._columns
        if full or time.monotonic() - self._written_s >= BLOCK_S:
            self.flush()

    def flush(self) -> None:
        """Write the rows in the buffer."""
        if not self._buffer:
            return
        block = np.array(self._buffer).reshape(-1, self._columns)
        self._buffer = array("d")
        here = slice(self._written, self._written + len(block))
        column = 0
        for dataset, width in self._datasets:
            values = block[:, column : column + width]
            dataset[here] = values[:, 0] if width == 1 else values
            column += width
        self._written = here.stop
        self._written_s = time.monotonic()
        self._file.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.flush()
        self._file.close()


LARGEST = 1e15
"""No history has a greater magnitude, in SI."""
MOST_SOURCES = 16
_SOURCE = re.compile("[a-z][a-z0-9_]{0,39}")
_DAMAGE = (OSError, KeyError, RuntimeError, TypeError, ValueError)
"""What h5py raises for a file that is not HDF5, or is damaged."""


class RowsMissingError(HarnessError):
    """Requested rows have not been written, or cannot be read while they are being written."""


class GrowingTruth:
    """Histories that another process is still writing: its structure is final, and its rows come in order.

    Args:
        path: of the file.
        ticks: rows that it will have.
    """

    def __init__(self, path: Path, ticks: int) -> None:
        self._path = path
        self.complete = ticks

    def rows(self, first: int, past: int) -> Histories:
        """Some rows of every dataset, by name.

        The file is reopened each time, so that nothing read before is taken for its present content.

        Raises:
            RowsMissingError: not all of them have been written, or the file is locked by its writer.
        """
        try:
            with TruthReader(self._path, being_written=True) as reader:
                histories = reader.rows(first, past)
        except HarnessError as error:
            raise RowsMissingError(str(error)) from None
        if min(map(_complete_rows, histories.values())) < past - first:
            raise RowsMissingError(f"{self._path}: rows {first} to {past - 1} have not been written")
        return histories


class TruthReader:
    """Reads the histories of a complete or truncated file in blocks.

    Raises:
        HarnessError: missing or not a truth file; so does ``rows``.
    """

    def __init__(self, path: Path, being_written: bool = False) -> None:
        self._path = path
        with self._report_damage():
            check_regular(path)
            self._file = h5py.File(path, "r", locking=False if being_written else None)
        try:
            with self._report_damage():
                self._names = _names(self._file, path.stat().st_size)
                self.attributes: dict[str, object] = dict(self._file.attrs)
                """What identifies the flight; none in a file of an older version."""
            self.complete = 0 if being_written else self._complete_rows()
            """Rows before the first that is not whole."""
        except HarnessError:
            self._file.close()
            raise

    def rows(self, first: int, past: int) -> Histories:
        """Some rows of every dataset, by name."""
        with self._report_damage():
            histories = {name: self._file[name][first:past] for name in self._names}
        for name, history in histories.items():
            if (np.abs(history) > LARGEST).any():
                raise HarnessError(f"{self._path}: {name} holds a magnitude above {LARGEST:g}")
        return histories

    def _complete_rows(self) -> int:
        total = len(self._file["t_s"])
        for first in range(0, total, BLOCK_ROWS):
            past = min(first + BLOCK_ROWS, total)
            complete = min(map(_complete_rows, self.rows(first, past).values()))
            if complete < past - first:
                return first + complete
        return total

    @contextmanager
    def _report_damage(self) -> Iterator[None]:
        try:
            yield
        except _DAMAGE as error:
            raise HarnessError(f"{self._path}: cannot be read as plant histories ({error})") from None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()


def read_truth(path: Path) -> Histories:
    """The complete rows of every dataset, by name.

    Raises:
        HarnessError: missing or not a truth file.
    """
    with TruthReader(path) as reader:
        return reader.rows(0, reader.complete)


def _names(file: h5py.File, size: int) -> tuple[str, ...]:
    """The names of its datasets.

    Raises:
        ValueError: the layout is not that of ``TruthFile``.
    """
    widths = {name: width for name, width, *_ in COLUMNS}
    widths |= {f"torque_body_nm/{source}": 3 for source in _sources(file)}
    if OF_WHEEL[0] in file:
        widths |= {OF_WHEEL[0]: OF_WHEEL[1]}
    _check_layout(file, widths, size)
    return tuple(widths)


def _sources(file: h5py.File) -> list[str]:
    """The names of the torques in the file.

    Raises:
        ValueError: a name that no source has, or more than ``MOST_SOURCES``.
    """
    names = list(islice(file["torque_body_nm"], MOST_SOURCES + 1))
    if len(names) > MOST_SOURCES or not all(_SOURCE.fullmatch(name) for name in names):
        raise ValueError(f"torque_body_nm is no group of at most {MOST_SOURCES} torques by name")
    return names


def _check_layout(file: h5py.File, widths: dict[str, int], size: int) -> None:
    """Check for doubles in the shapes of ``TruthFile``, contiguous and in this file, that fit its size.

    Raises:
        ValueError: any other layout.
    """
    rows = (*getattr(file["t_s"], "shape", ()), 0)[0]
    for name, width in widths.items():
        dataset, shape = file[name], (rows,) if width == 1 else (rows, width)
        if not isinstance(dataset, h5py.Dataset) or (dataset.shape, dataset.dtype) != (shape, np.dtype("f8")):
            raise ValueError(f"{name} is no table of {' x '.join(map(str, shape))} doubles")
        elsewhere = dataset.is_virtual or dataset.external or dataset.file.filename != file.filename
        if dataset.chunks or elsewhere:
            raise ValueError(f"{name} is not stored in one piece in this file")
    if 8 * rows * sum(widths.values()) > size:
        raise ValueError(f"{rows} rows do not fit into its {size} bytes")


def _complete_rows(history: NDArray[np.float64]) -> int:
    """Rows before the first with a NaN; after an interrupted flush, datasets differ in it."""
    broken = np.flatnonzero(~np.isfinite(history.reshape(len(history), -1)).all(axis=1))
    return int(broken[0]) if len(broken) else len(history)
