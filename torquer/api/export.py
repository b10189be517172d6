"""``torquer.export``: a run in the format of another tool."""

from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import Literal

from fsw.input.schema import Section
from sim.export import command
from sim.progress import shown
from torquer.api.arguments import checked, path_text
from torquer.api.errors import one_sentence
from torquer.api.laws import LawLike, law_given
from torquer.api.printed import PrintedResult


class _ExportOptions(Section):
    format: Literal["mcap", "blf", "asc", "csv", "parquet", "netcdf"] | None
    force: bool


@dataclass(frozen=True)
class Export(PrintedResult):
    """A file that was written; functions that open files take it as its path.

    Attributes:
        path: it.
        notes: what of the flight is missing in it, and what of the run is not as its ``run.json`` says.
        ok: whether each file of the run is that of its ``run.json``.
    """

    path: Path
    notes: tuple[str, ...]
    ok: bool

    def __fspath__(self) -> str:
        return fspath(self.path)

    def __str__(self) -> str:
        return "\n".join((f"exported: {self.path}", *self.notes))


@one_sentence
def export(
    run_or_log: str | PathLike[str],
    out: str | PathLike[str],
    *,
    format: str | None = None,
    force: bool = False,
    law: LawLike | None = None,
    progress: bool = False,
) -> Export:
    """Write a run for Foxglove, CANalyzer and SavvyCAN, pandas or xarray, as ``torquer export`` does.

    Args:
        run_or_log: a run, its directory, or a log, which will do for ``mcap``, ``blf`` and ``asc``.
        out: the file.
        format: ``mcap``, ``blf``, ``asc``, ``csv``, ``parquet``, ``netcdf``; None: by the suffix of ``out``.
        force: replace the file if it is there.
        law: the user law that the run flew, named or given again: the histories need it.
        progress: show progress on stderr.

    Raises:
        InputError: there is no such run or format, a package is missing, or the file cannot be written.
    """
    options = checked(_ExportOptions, "export", format=format, force=force)
    source, file = Path(path_text(run_or_log, "run_or_log")), Path(path_text(out, "out"))
    with shown(progress), law_given(law) as named:
        written = command.export(source, options.format, file, options.force, named)
    return Export(written.path, written.notes, written.ok)
