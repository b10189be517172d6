"""How charts of the report look."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from math import ceil
from threading import RLock
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from sim.drawing.envelope import BINS, Envelope
from sim.value_types import Array

Span = tuple[float, float]

INK, MUTED, LIMIT = "#1b2733", "#5b6b7b", "#b3261e"
AXES_COLOURS = ("#0072b2", "#d55e00", "#009e73")
"""Blue, vermilion, green of Okabe and Ito: distinct in all kinds of colour vision."""
MORE_COLOURS = ("#cc79a7", "#e69f00", "#56b4e9")
ECLIPSE = "#dde4ee"

WIDTH_IN, NARROW_IN = 8.2, 4.4
"""Of a picture as wide as the page, and of one for a narrow screen."""
DOTS_AN_INCH = 96
"""Pixels of a page in an inch of a picture."""
LEFT_IN, RIGHT_IN, BOTTOM_IN = 0.72, 0.12, 0.42
TITLE_IN, LEGEND_IN = 0.32, 0.19
"""Margins: the same in all charts, so that their times stand under each other."""
NEAR = 4.0
"""Values whose factor is smaller are drawn on a linear axis."""
_STYLE: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlepad": 7.0,
    "axes.labelcolor": INK,
    "axes.edgecolor": "#8a97a5",
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": "#c9d2dc",
    "grid.linewidth": 0.4,
    "text.color": INK,
    "xtick.color": "#8a97a5",
    "ytick.color": "#8a97a5",
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.0,
    "legend.frameon": False,
    "legend.handlelength": 1.4,
    "legend.columnspacing": 1.4,
    "legend.borderaxespad": 0.2,
    "legend.borderpad": 0.1,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "path.simplify": True,
    "svg.fonttype": "none",
    "svg.hashsalt": "torquer",
}

SETTINGS = RLock()
"""Held while the settings of matplotlib are changed: those of the whole process."""


@contextmanager
def look(settings: Mapping[Any, Any]) -> Iterator[None]:
    """Settings of matplotlib, whatever the user's own are; they are left as they were."""
    with SETTINGS, matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(settings)
        yield


def style() -> AbstractContextManager[None]:
    """The look of the report, whatever the user's own matplotlib settings are; they are left as they were."""
    return look(_STYLE)


@dataclass(frozen=True, slots=True)
class TimeAxis:
    """A time axis in the unit that suits its length.

    Attributes:
        label: name and unit.
        unit_s: seconds in one unit.
        start_s: where it begins.
        end_s: where it ends.
        eclipses: spans of time without Sun, s.
    """

    label: str
    unit_s: float
    start_s: float
    end_s: float
    eclipses: tuple[Span, ...] = ()

    def of(self, t_s: Array) -> Array:
        """Times as numbers on this axis."""
        return t_s / self.unit_s


def stacked(
    time: TimeAxis,
    heights_in: Sequence[float],
    legends: bool = True,
    right_in: float = RIGHT_IN,
    width_in: float = WIDTH_IN,
) -> tuple[Figure, list[Axes]]:
    """A figure of panels one over the other on one time axis, eclipses shaded, with room for legends.

    ``right_in`` is the margin beside the panels, wider where something stands there.
    """
    count, inner_in = len(heights_in), sum(heights_in)
    top_in = TITLE_IN + LEGEND_IN * legends
    height_in = inner_in + top_in * count + BOTTOM_IN
    figure = Figure(figsize=(width_in, height_in))
    grid = figure.subplots(
        count,
        1,
        sharex=True,
        squeeze=False,
        height_ratios=list(heights_in),
        gridspec_kw={
            "left": LEFT_IN / width_in,
            "right": 1.0 - right_in / width_in,
            "bottom": BOTTOM_IN / height_in,
            "top": 1.0 - top_in / height_in,
            "hspace": top_in * count / inner_in,
        },
    )
    panels = list(grid[:, 0])
    figure.align_ylabels(panels)
    for panel in panels:
        panel.set_xlim(time.start_s / time.unit_s, time.end_s / time.unit_s)
        panel.margins(x=0.0)
        shade(panel, time, time.eclipses)
    panels[-1].set_xlabel(time.label)
    return figure, panels


def shade(
    panel: Axes,
    time: TimeAxis,
    spans: Sequence[Span],
    low: float = 0.0,
    high: float = 1.0,
    colour: str = ECLIPSE,
    name: str = "eclipse",
) -> None:
    """Bands over spans of time, between two fractions of the panel's height; one path for all."""
    if not spans:
        return
    corners = []
    for start_s, end_s in _joined(spans, (time.end_s - time.start_s) / (4 * BINS)):
        left = max(start_s, time.start_s) / time.unit_s
        right = min(end_s, time.end_s) / time.unit_s
        corners += [(left, low), (left, high), (right, high), (right, low), (left, low)]
    codes = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY] * (len(corners) // 5)
    bands = PathPatch(Path(corners, codes), facecolor=colour, edgecolor="none", linewidth=0.0, zorder=0.2)
    bands.set_transform(panel.get_xaxis_transform())
    bands.set_gid(name)
    panel.add_artist(bands)


def _joined(spans: Sequence[Span], least_s: float) -> list[Span]:
    """Spans in order, those joined whose gap is too small to be seen."""
    joined = [spans[0]]
    for start_s, end_s in spans[1:]:
        if start_s - joined[-1][1] < least_s:
            joined[-1] = (joined[-1][0], max(end_s, joined[-1][1]))
        else:
            joined.append((start_s, end_s))
    return joined


def trace(panel: Axes, time: TimeAxis, t_s: Array, y: Array, label: str, colour: str, **how: object) -> None:
    """One history as a line, a long one as its envelope; few values get a dot each."""
    if len(t_s) > 0:
        envelope = Envelope(len(t_s), 1)
        envelope.take(y[:, None])
        t_s, y = t_s[envelope.places], envelope.points[:, 0]
    marker = "." if len(t_s) <= 60 else ""
    panel.plot(time.of(t_s), y, label=label, color=colour, marker=marker, **how)  # type: ignore[arg-type]  # of any option


def legend(panel: Axes, columns: int | None = None) -> None:
    """A legend between panel and title, in one line or so many columns; left, where its title is."""
    handles, labels = panel.get_legend_handles_labels()
    ncols = max(1, columns or len(labels))
    lines = ceil(len(labels) / ncols)
    panel.legend(handles, labels, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=ncols)
    panel.set_title(panel.get_title(loc="left"), pad=72.0 * LEGEND_IN * max(1, lines) + 6.0)


def log_y(panel: Axes, *histories: Array, decades: float) -> None:
    """A logarithmic ordinate with plain numbers, over at most so many decades.

    Without positive values, or with nearly equal ones, it stays linear. A short peak, such as when a filter
    starts, may run out at the top.
    """
    values = np.concatenate([history[np.isfinite(history) & (history > 0.0)] for history in histories])
    if len(values) == 0:
        return
    top = min(float(values.max()), 5.0 * float(np.quantile(values, 0.995)))
    bottom = max(float(values.min()), top / 10.0**decades)
    if top < NEAR * bottom:
        return
    panel.set_yscale("log")
    panel.set_ylim(bottom / 1.3, top * 1.3)
    _plain_numbers(panel.yaxis, top / bottom)


def log_x(panel: Axes, low: float, high: float) -> None:
    """A logarithmic abscissa with plain numbers, for values between two positive ones; linear if near."""
    if high < NEAR * low:
        return
    panel.set_xscale("log")
    _plain_numbers(panel.xaxis, high / low)


def _plain_numbers(axis: Axis, factor: float) -> None:
    """Powers of ten alone, or 1, 2, 5 where the axis spans a small factor: none runs into the next."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if factor < 50.0 else (1.0,)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_locator(NullLocator())
