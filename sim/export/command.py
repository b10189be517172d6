"""``torquer export``: a run, or a log alone, in the format of another tool."""

import csv
from collections.abc import Callable
from dataclasses import dataclass
from math import isnan
from pathlib import Path
from typing import NamedTuple

import can
import numpy as np
from h5py import string_dtype
from numpy.typing import NDArray

from fsw.bus.python_can import message_of
from sim.console import counted
from sim.errors import HarnessError, needing
from sim.export import mcap
from sim.export.history_table import AXES, Block, HistoryTable
from sim.export.source import LogPass, Source, open_source
from sim.progress import Watch, progress
from sim.record import run_dir
from sim.result_files import whole_file

# --- Histories as CSV and Parquet: a row a tick, a column a component, its unit in its name


def _columns(block: Block) -> NDArray[np.float64]:
    """The columns side by side, (n, columns)."""
    return np.column_stack(list(block.values()))


def write_csv(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a CSV file with one line of names; numbers read back to the last bit, none is an empty field."""
    table = HistoryTable(source)
    with path.open("w", encoding="ascii", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([name for quantity in table.quantities for name in quantity.columns])

        def take(block: Block) -> None:
            for row in _columns(block).tolist():
                writer.writerow(["" if isnan(value) else repr(value) for value in row])

        return table.read(take, watch)


def write_parquet(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a Parquet file; columns have unit and meaning as metadata, the file what identifies the flight.

    Raises:
        HarnessError: the package pyarrow is missing.
    """
    with needing("parquet", "pyarrow", "export"):
        import pyarrow as pa  # noqa: PLC0415  an extra
        import pyarrow.parquet as pq  # noqa: PLC0415  an extra
    table = HistoryTable(source)
    fields = [
        pa.field(name, pa.float64(), metadata={"unit": quantity.unit, "meaning": quantity.meaning})
        for quantity in table.quantities
        for name in quantity.columns
    ]
    schema = pa.schema(fields, metadata={key: str(value) for key, value in source.identity.items()})
    with pq.ParquetWriter(path, schema) as writer:

        def take(block: Block) -> None:
            arrays = [pa.array(column, from_pandas=True) for column in _columns(block).T]  # NaN is null
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))

        return table.read(take, watch)


# --- Histories as NetCDF-4 by the CF conventions, for xarray, Panoply and the like

_AXES = {3: "xyz", 4: "wxyz"}
"""The second dimension of a quantity, by its width."""


def write_netcdf(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a NetCDF file: a variable a quantity over time, with units and meaning.

    Raises:
        HarnessError: the package h5netcdf is missing.
    """
    with needing("netcdf", "h5netcdf", "export"):
        import h5netcdf  # noqa: PLC0415  an extra
    table = HistoryTable(source)
    with h5netcdf.File(path, "w") as file:
        file.dimensions = {"time": table.ticks} | {name: len(name) for name in _AXES.values()}
        file.attrs.update({"Conventions": "CF-1.11", "title": "Torquer flight"} | source.identity)
        for width, name in _AXES.items():
            labels = file.create_variable(name, (name,), string_dtype())
            labels[:] = np.array([axis[1:] for axis in AXES[width]], dtype=object)
        time = file.create_variable("time", ("time",), "f8")
        time.attrs["units"] = f"seconds since {source.identity['epoch_utc']}"
        time.attrs["calendar"] = "standard"
        time.attrs["standard_name"] = "time"
        for quantity in table.quantities:
            dimensions = ("time",) if quantity.width == 1 else ("time", _AXES[quantity.width])
            variable = file.create_variable(quantity.name, dimensions, "f8", fillvalue=np.nan)
            variable.attrs["units"] = quantity.unit
            variable.attrs["long_name"] = quantity.meaning
        written = 0

        def take(block: Block) -> None:
            nonlocal written
            here = slice(written, written + len(block["t_s"]))
            file.variables["time"][here] = block["t_s"]
            for name, values in block.items():
                file.variables[name][here] = values
            written = here.stop

        return table.read(take, watch)


# --- The bus log in the formats of Vector's tools, written by python-can

MOST_CHANNELS = 2**16 - 1


def write_blf(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a binary log, its time stamps to the microsecond."""
    return _write(can.BLFWriter(path), source, watch)


def write_asc(source: Source, path: Path, watch: Watch) -> list[str]:
    """Write a text log; its time stamps count from the first frame, the date being in its head."""
    return _write(can.ASCWriter(path), source, watch)


def _write(writer: can.BLFWriter | can.ASCWriter, source: Source, watch: Watch) -> list[str]:
    """Both formats count time from the first frame: what is stamped earlier gets its time, and a note."""
    log = LogPass(source.log)
    first_us: int | None = None
    early = 0
    with writer:
        for entry in log:
            first_us = entry.timestamp_us if first_us is None else first_us
            early += entry.timestamp_us < first_us
            stamp_us = max(entry.timestamp_us, first_us)
            writer.on_message_received(message_of(entry.frame, stamp_us / 1e6, _channel(entry.channel)))
            watch(stamp_us - first_us)
    if early:
        log.notes.append(f"{counted(early, 'frame')} stamped earlier than the first, now with its time")
    return log.notes


def _channel(name: str) -> str | None:
    """The name of a bus, if it ends with a number that the formats hold, or with none."""
    number = can.util.channel2int(name)
    return name if number is None or number < MOST_CHANNELS else None


# --- The command

Write = Callable[[Source, Path, Watch], list[str]]


class Format(NamedTuple):
    """How a format is written, and whether it is the log that is read, or the histories; its suffixes."""

    write: Write
    of_log: bool
    suffixes: tuple[str, ...]


FORMATS = {
    "mcap": Format(mcap.write_mcap, True, (".mcap",)),
    "blf": Format(write_blf, True, (".blf",)),
    "asc": Format(write_asc, True, (".asc",)),
    "csv": Format(write_csv, False, (".csv",)),
    "parquet": Format(write_parquet, False, (".parquet", ".pq")),
    "netcdf": Format(write_netcdf, False, (".nc", ".nc4")),
}


@dataclass(frozen=True, slots=True)
class ExportedFile:
    """A file that was written.

    Attributes:
        path: it.
        notes: what of the flight is missing in it, and what of the run is not as its ``run.json`` says.
        ok: whether each file of the run is that of its ``run.json``.
    """

    path: Path
    notes: tuple[str, ...]
    ok: bool


def export(
    run_or_log: Path, name: str | None, out: Path, force: bool, law: str | None = None
) -> ExportedFile:
    """Write the file.

    Args:
        run_or_log: a run directory, or a candump log alone.
        name: of the format; None: by the suffix of ``out``.
        out: the file.
        force: replace one that is there.
        law: the user law that the run flew, named again: the histories need it.

    Raises:
        HarnessError: there is no such run or format, or the file cannot be written.
    """
    chosen = FORMATS[name or _by_suffix(out)]
    source = open_source(run_or_log, law)
    own = {(source.log.parent / name).resolve() for name in (*run_dir.FILES, source.log.name)}
    if out.resolve() in own:
        raise HarnessError(f"{out} is a file of the run itself: name another by --out")
    total = LogPass(source.log).duration_us() if chosen.of_log else _ticks(source)
    with whole_file(out, force) as path, progress(f"exporting {out.name}", total) as watch:
        notes = chosen.write(source, path, watch)
    lines = (*source.binding.lines, *(f"note: {note}" for note in notes))
    return ExportedFile(out, lines, source.binding.holds)


def _by_suffix(out: Path) -> str:
    for name, found in FORMATS.items():
        if out.suffix.lower() in found.suffixes:
            return name
    raise HarnessError(f"--out {out}: say by --format which it is: {', '.join(FORMATS)}")


def _ticks(source: Source) -> int:
    return 0 if source.record is None else source.record["ticks"]
