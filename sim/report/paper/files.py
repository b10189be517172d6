"""The figures of a run as files: vector graphics, the same for the same run."""

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from sim.errors import writing
from sim.record.destination import check_folder
from sim.record.whole_file import replacing
from sim.report.charts.drawn_flight import DrawnFlight
from sim.report.paper.figures import FIGURES, PaperFigure
from sim.report.paper.kind import FigureKind, figure_folder
from sim.report.paper.look import COLUMN_IN, paper_style

_UNDATED: dict[str, dict[str, Any]] = {
    "pdf": {"Creator": "torquer", "Producer": None, "CreationDate": None},
    "svg": {"Creator": "torquer", "Date": None},
}


def write_figures(run: Path, flight: DrawnFlight, kind: FigureKind) -> list[Path]:
    """Write each figure that the flight has something for into the folder ``figures`` of the run.

    Raises:
        HarnessError: a file cannot be written.
    """
    folder = figure_folder(run)
    shown = {name: figure for name, figure in FIGURES.items() if not figure.why_not(flight)}
    files = [folder / f"{name}.{kind}" for name in shown]
    check_folder(folder, [file.name for file in files])
    with paper_style(), writing(folder):
        for file, figure in zip(files, shown.values(), strict=True):
            with replacing(file) as temporary:
                _drawn(figure, flight).savefig(temporary, format=kind, metadata=_UNDATED[kind])
    return files


def _drawn(figure: PaperFigure, flight: DrawnFlight) -> Figure:
    """Within ``paper_style``."""
    drawn = Figure(figsize=(COLUMN_IN, figure.aspect * COLUMN_IN))
    figure.draw(drawn.subplots(), flight)
    return drawn
