"""The picture of a comparison: the error over time, a panel a driver, every line labelled at its end."""

from collections.abc import Sequence
from math import log10
from pathlib import Path

from matplotlib.axes import Axes

from fsw.core.laws.table import LAWS
from sim.compare.case import Driver
from sim.compare.score import WINDOW_ORBITS, Result
from sim.drawing.canvas import AXES_COLOURS, INK, MORE_COLOURS, MUTED, log_y, stacked, style, trace
from sim.record.whole_file import replacing
from sim.scenario.controlled import Controlled
from sim.value_types import Array

COLOURS = (*AXES_COLOURS, *MORE_COLOURS, INK, "#7b3fa0", "#8a6d3b", "#8f9a1f")
DASHES: tuple[object, ...] = (
    "-",
    (0, (5, 1.5)),
    (0, (1.5, 1.2)),
    (0, (8, 1.5, 1.5, 1.5)),
    (0, (10, 4)),
    (0, (1, 3)),
    (0, (5, 1.5, 1, 1.5, 1, 1.5)),
    (0, (10, 1.5, 4, 1.5)),
)
"""A law has its colour in all panels; when the colours are used up, the same again dashed."""

PANEL_IN, LINE_IN, LETTER_IN, LEAD_IN = 3.1, 0.16, 0.062, 0.3
"""Least height of a panel, height of a name beside it, width of its letters and of the line to it."""
DOTS_PER_INCH = 150


def picture(path: Path, title: str, results: Sequence[Result], by: Controlled) -> None:
    """Draw the flights, as PNG; nothing if there is none."""
    flights = [result for result in results if result.history is not None]
    if not flights:
        return
    drivers = [driver for driver in Driver if any(result.score.driver is driver for result in flights)]
    laws = laws_of(flights)
    errors = [result.history.error for result in flights if result.history is not None]
    names_in = LEAD_IN + LETTER_IN * max(
        len(_name(score.law, history.error, by)) for score, history in flights if history is not None
    )
    assert flights[0].history is not None
    with style():
        height_in = max(PANEL_IN, LINE_IN * len(laws))
        heights_in = [height_in] * len(drivers)
        figure, panels = stacked(flights[0].history.time, heights_in, legends=False, right_in=names_in)
        shaded = "; eclipses shaded" if flights[0].history.time.eclipses else ""
        smoothed = f"RMS of {WINDOW_ORBITS:g} orbits about each time"
        panels[-1].set_xlabel(f"{flights[0].history.time.label}; {smoothed}{shaded}")
        for panel, driver in zip(panels, drivers, strict=True):
            log_y(panel, *errors, decades=3.5)
            _settled(panel, by)
            panel.set_ylabel(axis_label(by))
            panel.set_title(f"{title}: {driver.value} coil driver")
            _lines(
                panel,
                LINE_IN / height_in,
                laws,
                [result for result in flights if result.score.driver is driver],
                by,
            )
        panels[0].text(
            1.035, 1.03, "at the end", transform=panels[0].transAxes, color=MUTED, fontsize=7.0, va="bottom"
        )
        with replacing(path) as file:
            figure.savefig(
                file, format="png", dpi=DOTS_PER_INCH, facecolor="white", metadata={"Software": "torquer"}
            )


def laws_of(flights: Sequence[Result]) -> list[str]:
    """The laws that were flown, in the order of their table; user laws are last."""
    flown = {flight.score.law for flight in flights}
    return [*(law for law in LAWS if law in flown), *sorted(flown - LAWS.keys())]


def colour_of(number: int) -> str:
    """That of a law, by its number among those drawn."""
    return COLOURS[number % len(COLOURS)]


def axis_label(by: Controlled) -> str:
    """Of the ordinate."""
    return f"pointing error [{by.unit}]" if by.unit == "deg" else f"error of the {by.words} [{by.unit}]"


def with_unit(error: float, by: Controlled) -> str:
    """Short."""
    return f"{error:.3g}°" if by.unit == "deg" else f"{error:.3g} {by.unit}"


def _name(law: str, error: Array, by: Controlled) -> str:
    return f"{law}  {with_unit(float(error[-1]), by)}"


def _settled(panel: Axes, by: Controlled) -> None:
    panel.axhline(by.threshold, color=MUTED, linewidth=0.8, linestyle=(0, (4, 3)))
    panel.annotate(
        with_unit(by.threshold, by), (0.0, by.threshold), (3.0, 2.0),
        panel.get_yaxis_transform(), "offset points", color=MUTED, fontsize=7.0, annotation_clip=True,
    )  # fmt: skip


def _lines(
    panel: Axes, line_height: float, laws: Sequence[str], results: Sequence[Result], by: Controlled
) -> None:
    ends = []
    for score, history in results:
        assert history is not None
        number = laws.index(score.law)
        colour, dashes = colour_of(number), DASHES[number // len(COLOURS) % len(DASHES)]
        trace(panel, history.time, history.t_s, history.error, score.law, colour, linestyle=dashes)
        name = _name(score.law, history.error, by)
        ends.append((_height(panel, float(history.error[-1])), name, colour))
    ends.sort(key=lambda end: end[0])
    places = spread([height for height, *_ in ends], line_height)
    for (height, name, colour), at in zip(ends, places, strict=True):
        panel.annotate(
            name,
            xy=(1.0, height),
            xytext=(1.035, at),
            xycoords="axes fraction",
            textcoords="axes fraction",
            va="center",
            color=colour,
            fontsize=7.5,
            arrowprops={
                "arrowstyle": "-", "color": colour, "linewidth": 0.6,
                "relpos": (0.0, 0.5), "shrinkA": 0.0, "shrinkB": 0.0,
            },
            annotation_clip=False,
        )  # fmt: skip


def _height(panel: Axes, value: float) -> float:
    """Where a value stands in a panel, as a fraction of its height, within the panel."""
    bottom, top = panel.get_ylim()
    if panel.get_yscale() == "log":
        bottom, top, value = log10(bottom), log10(top), log10(max(value, 1e-12))
    return min(max((value - bottom) / (top - bottom), 0.0), 1.0)


def spread(heights: Sequence[float], least: float) -> list[float]:
    """Places for names: at least so far apart, within 0 to 1 if they fit, moved least from rising heights.

    With ``least`` times its number taken off each, the places need only not fall: neighbours that do are
    pooled at their mean.
    """
    pools: list[tuple[float, int]] = []
    for number, height in enumerate(heights):
        mean, count = height - least * number, 1
        while pools and pools[-1][0] > mean:
            before, more = pools.pop()
            mean, count = (mean * count + before * more) / (count + more), count + more
        pools.append((mean, count))
    room = max(0.0, 1.0 - least * (len(heights) - 1))
    levels = [min(max(mean, 0.0), room) for mean, count in pools for _ in range(count)]
    return [level + least * number for number, level in enumerate(levels)]
