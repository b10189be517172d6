"""The figures: what of a flight each of them draws, on axes of any size."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties
from matplotlib.patches import Patch

from sim.drawing.canvas import ECLIPSE, TimeAxis, shade
from sim.drawing.time_chart import Panel, draw_lines
from sim.report.charts import over_time
from sim.report.charts.coils import draw_raster
from sim.report.charts.drawn_flight import DrawnFlight

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
