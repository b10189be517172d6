"""Charts against time, described once: drawn as a picture, and as data that the page's script draws."""

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sim.drawing.canvas import DOTS_AN_INCH, MUTED, Span, TimeAxis, legend, log_y, stacked, trace
from sim.value_types import Array, Json


@dataclass(frozen=True, slots=True)
class Series:
    """A quantity over time; NaN where there is none."""

    label: str
    y: Array
    colour: str
    width: float = 1.0


@dataclass(frozen=True, slots=True)
class Level:
    """A horizontal line."""

    value: float
    label: str
    colour: str = MUTED


@dataclass(frozen=True, slots=True)
class Panel:
    """Quantities on one ordinate.

    Attributes:
        title: of the panel.
        label: of the ordinate, with its unit.
        height_in: of the area of the lines.
        series: what is drawn.
        decades: a logarithmic ordinate over at most so many; None: linear.
        levels: horizontal lines, labelled.
        reach: the ordinate's ends; None: those of the values.
    """

    title: str
    label: str
    height_in: float
    series: Sequence[Series]
    decades: float | None = None
    levels: Sequence[Level] = ()
    reach: Span | None = None


@dataclass(frozen=True, slots=True)
class TimeChart:
    """Panels over one time axis; ``t_s`` is the time of every value."""

    t_s: Array
    panels: Sequence[Panel]


class DrawnChart(NamedTuple):
    """A chart as a picture or several, and as the data of the script; None of what is a picture alone.

    ``narrow`` is the picture for a narrow screen, where there is no script that draws it.
    """

    picture: Figure | Sequence[Figure]
    data: Json | None = None
    narrow: Figure | None = None


def draw(time: TimeAxis, chart: TimeChart) -> DrawnChart:
    """The chart, within ``canvas.style``."""
    picture, axes = stacked(time, [panel.height_in for panel in chart.panels])
    panels = []
    for each, panel in zip(axes, chart.panels, strict=True):
        draw_lines(each, time, chart.t_s, panel)
        each.set_title(panel.title)
        legend(each)
        panels.append(_data(each, panel))
    return DrawnChart(picture, {"panels": panels})


def time_data(time: TimeAxis, t_s: Array, start_unix_s: float) -> Json:
    """What all charts of a page share: the axis, and the time of every value."""
    return {
        "label": time.label,
        "unit_s": time.unit_s,
        "start_unix_s": start_unix_s,
        "end_s": time.end_s,
        "eclipses": [[round(edge, 1) for edge in span] for span in time.eclipses],
        "t_s": packed(t_s),
    }


def packed(values: Array) -> str:
    """Numbers in single precision, little end first, in base 64."""
    return b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii")


def draw_lines(axes: Axes, time: TimeAxis, t_s: Array, panel: Panel, width: float = 1.0) -> None:
    """The lines of a panel and its ordinate, on axes of any size; ``width`` is a factor of the lines'."""
    for series in panel.series:
        trace(axes, time, t_s, series.y, series.label, series.colour, linewidth=width * series.width)
    for level in panel.levels:
        axes.axhline(
            level.value, color=level.colour, linewidth=width, linestyle=(0, (4, 3)), label=level.label
        )
    if panel.decades is not None:
        log_y(axes, *(series.y for series in panel.series), decades=panel.decades)
    if panel.reach is not None:
        axes.set_ylim(*panel.reach)
    axes.set_ylabel(panel.label)


def _data(axes: Axes, panel: Panel) -> Json:
    low, high = axes.get_ylim()
    return {
        "title": panel.title,
        "label": panel.label,
        "height": round(DOTS_AN_INCH * panel.height_in),
        "decades": panel.decades if axes.get_yscale() == "log" else None,
        "reach": [float(low), float(high)],
        "series": [
            {
                "label": series.label,
                "colour": series.colour,
                "width": series.width,
                "y": packed(series.y),
            }
            for series in panel.series
        ],
        "levels": [
            {"value": level.value, "label": level.label, "colour": level.colour} for level in panel.levels
        ],
    }
