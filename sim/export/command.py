"""``torquer export``: a run, or a log alone, in the format of another tool."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from sim.console import say
from sim.errors import HarnessError
from sim.export import can_log, mcap, netcdf, tables
from sim.export.destination import whole_file
from sim.export.source import LogPass, Source, open_source
from sim.progress import Watch, progress
from sim.record import run_dir

Write = Callable[[Source, Path, Watch], list[str]]


class Format(NamedTuple):
    """How a format is written, and whether it is the log that is read, or the histories; its suffixes."""

    write: Write
    of_log: bool
    suffixes: tuple[str, ...]


FORMATS = {
    "mcap": Format(mcap.write_mcap, True, (".mcap",)),
    "blf": Format(can_log.write_blf, True, (".blf",)),
    "asc": Format(can_log.write_asc, True, (".asc",)),
    "csv": Format(tables.write_csv, False, (".csv",)),
    "parquet": Format(tables.write_parquet, False, (".parquet", ".pq")),
    "netcdf": Format(netcdf.write_netcdf, False, (".nc", ".nc4")),
}


def export(run_or_log: Path, name: str | None, out: Path, force: bool, law: str | None = None) -> int:
    """Write the file; say what of the flight is missing in it.

    Args:
        run_or_log: a run directory, or a candump log alone.
        name: of the format; None: by the suffix of ``out``.
        out: the file.
        force: replace one that is there.
        law: the law of its own that the run flew, named again: the histories need it.

    Returns:
        The exit code: 1 if a file of the run is not that of its run.json, else 0.

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
    say(f"exported: {out}")
    for line in (*source.binding.lines, *(f"note: {note}" for note in notes)):
        say(line)
    return int(not source.binding.holds)


def _by_suffix(out: Path) -> str:
    for name, found in FORMATS.items():
        if out.suffix.lower() in found.suffixes:
            return name
    raise HarnessError(f"--out {out}: say by --format which it is: {', '.join(FORMATS)}")


def _ticks(source: Source) -> int:
    return 0 if source.record is None else source.record["ticks"]
