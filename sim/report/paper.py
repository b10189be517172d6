"""Figures of a run for papers: their look, what each draws, and their files."""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patches import Patch

from sim.drawing.canvas import ECLIPSE, INK, TimeAxis, look, shade
from sim.drawing.time_chart import Panel, draw_lines
from sim.errors import writing
from sim.record.destination import check_folder
from sim.record.run_dir import FigureKind, figure_folder
from sim.record.whole_file import replacing
from sim.report.charts import over_time
from sim.report.charts.coils import draw_raster
from sim.report.charts.drawn_flight import DrawnFlight

# --- How figures for papers look: a column wide, with letters that stay readable in it

COLUMN_IN = 3.5
"""Width of a column of most journals."""
_STYLE: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 7.5,
    "axes.labelsize": 7.5,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 6.5,
    "axes.linewidth": 0.6,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": "#dfe4ea",
    "grid.linewidth": 0.4,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "lines.linewidth": 0.9,
    "legend.frameon": False,
    "legend.handlelength": 1.4,
    "legend.handletextpad": 0.5,
    "legend.columnspacing": 1.1,
    "legend.borderaxespad": 0.25,
    "legend.borderpad": 0.1,
    "figure.constrained_layout.use": True,
    "figure.constrained_layout.h_pad": 0.02,
    "figure.constrained_layout.w_pad": 0.02,
    "pdf.fonttype": 42,  # TrueType, as publishers ask for
    "svg.fonttype": "path",  # looks the same wherever it is opened
    "svg.hashsalt": "torquer",
}


def paper_style() -> AbstractContextManager[None]:
    """The look of a paper, whatever the user's own matplotlib settings are; they are left as they were."""
    return look(_STYLE)


# --- The figures: what of a flight each of them draws, on axes of any size

PanelOf = Callable[[DrawnFlight], Panel]
LINE_WIDTH = 0.75
"""Of those of the report, which is wider."""


class PaperFigure(NamedTuple):
    """A figure.

    Attributes:
        draw: onto axes.
        aspect: height by width, as it is best looked at.
        replayed: whether it shows what the flight software did, which a replay tells.
        lack: why there is nothing to show of a flight; empty where there is.
    """

    draw: Callable[[Axes, DrawnFlight], None]
    aspect: float = 0.62
    replayed: bool = False
    lack: Callable[[DrawnFlight], str] = lambda flight: ""

    def why_not(self, flight: DrawnFlight) -> str:
        """Why it cannot be drawn of a flight; empty where it can."""
        return self.lack(flight) if flight.lines.ticks else "no tick was flown"


def of_panel(panel_of: PanelOf) -> Callable[[Axes, DrawnFlight], None]:
    """Draws lines over time."""

    def draw(axes: Axes, flight: DrawnFlight) -> None:
        _begin(axes, flight.time)
        draw_lines(axes, flight.time, flight.t_s, panel_of(flight), LINE_WIDTH)
        _legend(axes, flight.time)

    return draw


def pulses(axes: Axes, flight: DrawnFlight) -> None:
    """A lane for each coil, a bar for each pulse, up or down by its polarity, as high as its level."""
    _begin(axes, flight.time)
    draw_raster(axes, flight)
    axes.spines["left"].set_visible(True)


def modes(axes: Axes, flight: DrawnFlight) -> None:
    """A lane for each mode of the flight software."""
    _begin(axes, flight.time)
    axes.grid(visible=False)
    over_time.draw_modes(axes, flight)


def _no_estimate(flight: DrawnFlight) -> str:
    return "" if flight.lines.has_estimates else "the flight software had no estimate"


def _no_pulse(flight: DrawnFlight) -> str:
    return "" if flight.audit.pulses else "no pulse was fired"


FIGURES = {
    "pointing": PaperFigure(of_panel(over_time.pointing_panel)),
    "rates": PaperFigure(of_panel(over_time.rate_panel)),
    "rate_magnitude": PaperFigure(of_panel(over_time.rate_magnitude_panel)),
    "attitude_error": PaperFigure(of_panel(over_time.attitude_error_panel), replayed=True, lack=_no_estimate),
    "rate_error": PaperFigure(of_panel(over_time.rate_error_panel), replayed=True, lack=_no_estimate),
    "dipoles": PaperFigure(of_panel(over_time.dipole_panel)),
    "pulses": PaperFigure(pulses, 0.75, lack=_no_pulse),
    "field": PaperFigure(of_panel(over_time.field_panel)),
    "torques": PaperFigure(of_panel(over_time.torque_panel), 0.7),
    "modes": PaperFigure(modes, 0.4, replayed=True),
}
"""By name, that of the file too."""


def _begin(axes: Axes, time: TimeAxis) -> None:
    axes.set_xlim(time.start_s / time.unit_s, time.end_s / time.unit_s)
    if axes.xaxis.get_tick_params().get("labelbottom", True):  # else axes below share its time
        axes.set_xlabel(f"time [{_unit(time)}]")
    shade(axes, time, time.eclipses)


def _unit(time: TimeAxis) -> str:
    return {60.0: "min", 1.0: "s"}.get(time.unit_s, f"orbits of {time.unit_s / 60.0:.1f} min")


def _legend(axes: Axes, time: TimeAxis) -> None:
    """Over the axes, where it hides nothing, in as few lines as it fits."""
    handles, labels = axes.get_legend_handles_labels()
    if time.eclipses:
        handles, labels = [*handles, Patch(facecolor=ECLIPSE)], [*labels, "eclipse"]
    letter_in = LETTER * FontProperties(size=rcParams["legend.fontsize"]).get_size_in_points() / 72.0
    letters = axes.bbox.width / axes.figure.dpi / letter_in
    columns = fitting_columns([len(label) for label in labels], letters)
    axes.legend(handles, labels, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns)


LETTER, HANDLE_LETTERS = 0.56, 5
"""Width of a letter by the size of its font; room of an entry's line and of the gap beside it, in letters."""


def fitting_columns(lengths: Sequence[int], letters: float) -> int:
    """The most columns in which entries of so many letters, listed column after column, fit side by side."""
    for columns in range(len(lengths), 1, -1):
        widest = [max(column) for column in np.array_split(lengths, columns)]
        if sum(widest) + HANDLE_LETTERS * columns <= letters:
            return columns
    return 1


# --- The figures of a run as files: vector graphics, the same for the same run

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
