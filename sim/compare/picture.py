"""The picture of a comparison: pointing error over time, a panel a driver, every line labelled at its end."""

from collections.abc import Sequence
from math import log10
from pathlib import Path

from matplotlib.axes import Axes

from fsw.core.laws.table import LAWS
from sim.compare.case import Driver
from sim.compare.score import WINDOW_ORBITS, Result
from sim.drawing.canvas import AXES_COLOURS, INK, MORE_COLOURS, MUTED, log_y, stacked, style, trace
from sim.report.figures.controlled import SETTLED_DEG

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

PANEL_IN, NAMES_IN, LINE_IN = 3.1, 1.6, 0.16
"""Least height of a panel, width of the names beside it, and height of one of them."""
DOTS_PER_INCH = 150


def picture(path: Path, title: str, results: Sequence[Result]) -> None:
    """Draw the flights, as PNG; nothing if there is none."""
    flights = [result for result in results if result.history is not None]
    if not flights:
        return
    drivers = [driver for driver in Driver if any(result.score.driver is driver for result in flights)]
    laws = laws_of(flights)
    errors = [result.history.error_deg for result in flights if result.history is not None]
    assert flights[0].history is not None
    with style():
        height_in = max(PANEL_IN, LINE_IN * len(laws))
        heights_in = [height_in] * len(drivers)
        figure, panels = stacked(flights[0].history.time, heights_in, legends=False, right_in=NAMES_IN)
        shaded = "; eclipses shaded" if flights[0].history.time.eclipses else ""
        smoothed = f"RMS of {WINDOW_ORBITS:g} orbits about each time"
        panels[-1].set_xlabel(f"{flights[0].history.time.label}; {smoothed}{shaded}")
        for panel, driver in zip(panels, drivers, strict=True):
            log_y(panel, *errors, decades=3.5)
            _settled(panel)
            panel.set_ylabel("pointing error [deg]")
            panel.set_title(f"{title}: {driver.value} coil driver")
            _lines(
                panel,
                LINE_IN / height_in,
                laws,
                [result for result in flights if result.score.driver is driver],
            )
        figure.savefig(
            path, format="png", dpi=DOTS_PER_INCH, facecolor="white", metadata={"Software": "torquer"}
        )


def laws_of(flights: Sequence[Result]) -> list[str]:
    """The laws that were flown, in the order of their table; those of one's own are last."""
    flown = {flight.score.law for flight in flights}
    return [*(law for law in LAWS if law in flown), *sorted(flown - LAWS.keys())]


def colour_of(number: int) -> str:
    """That of a law, by its number among those drawn."""
    return COLOURS[number % len(COLOURS)]


def _settled(panel: Axes) -> None:
    panel.axhline(SETTLED_DEG, color=MUTED, linewidth=0.8, linestyle=(0, (4, 3)))
    panel.annotate(
        f"{SETTLED_DEG:g}°", (0.0, SETTLED_DEG), (3.0, 2.0), panel.get_yaxis_transform(), "offset points",
        color=MUTED, fontsize=7.0, annotation_clip=True,
    )  # fmt: skip


def _lines(panel: Axes, line_height: float, laws: Sequence[str], results: Sequence[Result]) -> None:
    ends = []
    for score, history in results:
        assert history is not None
        number = laws.index(score.law)
        colour, dashes = colour_of(number), DASHES[number // len(COLOURS) % len(DASHES)]
        trace(panel, history.time, history.t_s, history.error_deg, score.law, colour, linestyle=dashes)
        end_deg = float(history.error_deg[-1])
        ends.append((_height(panel, end_deg), score.law, end_deg, colour))
    ends.sort(key=lambda end: end[0])
    panel.text(1.035, 1.03, "at the end", transform=panel.transAxes, color=MUTED, fontsize=7.0, va="bottom")
    places = spread([height for height, *_ in ends], line_height)
    for (height, law, end_deg, colour), at in zip(ends, places, strict=True):
        panel.annotate(
            f"{law}  {end_deg:.3g}°",
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
