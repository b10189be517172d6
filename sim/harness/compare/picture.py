"""The picture of a comparison: pointing error over time, a panel a driver, every line named at its end."""

from collections.abc import Sequence
from math import log10
from pathlib import Path

from matplotlib.axes import Axes

from sim.harness.compare.case import Driver
from sim.harness.compare.score import Result
from sim.harness.report.canvas import (
    AXES_COLOURS,
    INK,
    MORE_COLOURS,
    MUTED,
    RIGHT_IN,
    WIDTH_IN,
    log_y,
    stacked,
    style,
    trace,
)
from sim.harness.summary import SETTLED_DEG

COLOURS = (*AXES_COLOURS, *MORE_COLOURS, INK, "#7b3fa0", "#8a6d3b", "#8f9a1f")
DASHES: tuple[object, ...] = ("-", (0, (5, 1.5)), (0, (1.5, 1.2)))
"""A law has its colour in all panels; when the colours are used up, the same again dashed."""

PANEL_IN, NAMES_IN = 3.1, 1.45
LINE_HEIGHT = 0.052
"""Of a name, as a fraction of a panel's height."""
DOTS_PER_INCH = 150


def picture(path: Path, title: str, results: Sequence[Result]) -> None:
    """Draw what flew, as PNG; nothing if nothing did."""
    flown = [result for result in results if result.history is not None]
    if not flown:
        return
    drivers = [driver for driver in Driver if any(result.score.driver is driver for result in flown)]
    laws = list(dict.fromkeys(result.score.law for result in flown))
    errors = [result.history.error_deg for result in flown if result.history is not None]
    assert flown[0].history is not None
    with style():
        figure, panels = stacked(flown[0].history.time, [PANEL_IN] * len(drivers), legends=False)
        figure.subplots_adjust(right=1.0 - (NAMES_IN + RIGHT_IN) / WIDTH_IN)
        for panel, driver in zip(panels, drivers, strict=True):
            log_y(panel, *errors, decades=3.5)
            panel.axhline(SETTLED_DEG, color=MUTED, linewidth=0.8, linestyle=(0, (4, 3)))
            panel.set_ylabel("pointing error [deg]")
            panel.set_title(f"{title}: {driver.value} coil driver")
            _lines(panel, laws, [result for result in flown if result.score.driver is driver])
        figure.savefig(
            path, format="png", dpi=DOTS_PER_INCH, facecolor="white", metadata={"Software": "torquer"}
        )


def _lines(panel: Axes, laws: Sequence[str], results: Sequence[Result]) -> None:
    ends = []
    for score, history in results:
        assert history is not None
        number = laws.index(score.law)
        colour, dashes = COLOURS[number % len(COLOURS)], DASHES[number // len(COLOURS) % len(DASHES)]
        trace(panel, history.time, history.t_s, history.error_deg, score.law, colour, linestyle=dashes)
        ends.append((_height(panel, float(history.error_deg[-1])), score, colour))
    ends.sort(key=lambda end: end[0])
    for (height, score, colour), at in zip(ends, spread([end[0] for end in ends], LINE_HEIGHT), strict=True):
        panel.annotate(
            f"{score.law}  {score.pointing_rms_deg:.2f}°",
            xy=(1.0, height),
            xytext=(1.035, at),
            xycoords="axes fraction",
            textcoords="axes fraction",
            va="center",
            color=colour,
            fontsize=7.5,
            arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.6, "shrinkA": 1.0, "shrinkB": 0.0},
            annotation_clip=False,
        )


def _height(panel: Axes, value: float) -> float:
    """Where a value stands in a panel, as a fraction of its height, within the panel."""
    bottom, top = panel.get_ylim()
    if panel.get_yscale() == "log":
        bottom, top, value = log10(bottom), log10(top), log10(max(value, 1e-12))
    return min(max((value - bottom) / (top - bottom), 0.0), 1.0)


def spread(heights: Sequence[float], least: float) -> list[float]:
    """Places for names near rising heights, at least so far apart; within 0 to 1 if they fit."""
    placed: list[float] = []
    for height in heights:
        placed.append(height if not placed else max(height, placed[-1] + least))
    ceiling = 1.0
    for index in reversed(range(len(placed))):
        placed[index] = min(placed[index], ceiling)
        ceiling = placed[index] - least
    return placed
