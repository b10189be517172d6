"""The pictures of the populations: pointing and honesty over what differs from the onboard table."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sim.campaign.flight import FlightResult
from sim.drawing.canvas import AXES_COLOURS, LIMIT, MUTED, log_y, style
from sim.record.whole_file import replacing
from sim.validate.population.claims import inside
from sim.validate.population.sweep import Quantity

HONEST_PERCENT = 99.7
"""Part of the time that a normal error is inside 3 sigma."""
DASHES = (0, (4, 3))

ACROSS = (
    ("dipole_am2", "residual dipole [A m²]", "log"),
    ("inertia_percent", "largest error of a moment of inertia [%]", "linear"),
    ("misalignment_deg", "turns of both sensors, sum [deg]", "linear"),
)
"""Figure, label and scale of each column of the picture of the satellites."""

Flights = Sequence[FlightResult]
worst_inside, mean_inside = inside(np.min), inside(np.mean)


class SizeSpread(NamedTuple):
    """What satellites of one size did: median, or mean, and worst."""

    size: float
    satellites: int
    pointing_deg: tuple[float, float]
    estimate_deg: tuple[float, float]
    inside_percent: tuple[float, float]


def spread_of(size: float, flights: Flights) -> SizeSpread:
    """Pointing and estimate by median and largest, the time inside 3 sigma by mean and worst axis."""

    def both(figure: str) -> tuple[float, float]:
        values = [flight.figures[figure] for flight in flights]
        return float(np.median(values)), float(np.max(values))

    means, worst = ([pick(flight) for flight in flights] for pick in (mean_inside, worst_inside))
    shares = (100.0 * float(np.mean(means)), 100.0 * float(np.min(worst)))
    return SizeSpread(size, len(flights), both("pointing_deg"), both("estimate_deg"), shares)


def draw_satellites(populations: Mapping[str, Flights], path: Path) -> None:
    """Pointing error above, honesty of the worst axis below, a dot for each satellite."""
    with style():
        figure = Figure(figsize=(8.2, 4.6), layout="constrained")
        above, below = figure.subplots(2, len(ACROSS), sharex="col", sharey="row")
        for (name, flights), colour in zip(populations.items(), AXES_COLOURS, strict=False):
            for column, (key, _, _) in enumerate(ACROSS):
                x = [flight.figures[key] for flight in flights]
                pointing = [flight.figures["pointing_deg"] for flight in flights]
                honesty = [100.0 * worst_inside(flight) for flight in flights]
                _dots(above[column], x, pointing, name, colour)
                _dots(below[column], x, honesty, name, colour)
        flown = [flight for flights in populations.values() for flight in flights]
        log_y(above[0], np.array([flight.figures["pointing_deg"] for flight in flown]), decades=3.0)
        for column, (_, label, scale) in enumerate(ACROSS):
            above[column].set(xscale=scale)
            below[column].set(xscale=scale, xlabel=label)
            below[column].axhline(HONEST_PERCENT, color=LIMIT, linewidth=0.8, linestyle=DASHES)
        above[0].set(ylabel="pointing error, RMS [deg]", title="Pointing, last three orbits")
        below[0].set(ylabel="time inside 3 sigma [%]", title="Honesty, worst axis; 99.7 % dashed")
        above[0].legend()
        _save(figure, path)


def draw_sweep(sweep: Mapping[Quantity, Sequence[SizeSpread]], path: Path) -> None:
    """Pointing, estimate and honesty, a row each, over the size of each quantity, a column each."""
    with style():
        figure = Figure(figsize=(8.2, 6.4), layout="constrained")
        panels = figure.subplots(len(SWEEP_ROWS), len(sweep), sharex="col", sharey="row", squeeze=False)
        for row, (label, _, title, pair) in zip(panels, SWEEP_ROWS, strict=True):
            row[0].set(ylabel=label, title=title)
            for panel, (quantity, sizes) in zip(row, sweep.items(), strict=True):
                panel.set(xscale=quantity.scale, xlim=_span(quantity))
                _both(panel, [spread.size for spread in sizes], [pair(spread) for spread in sizes])
                panel.axvline(quantity.bound, color=MUTED, linewidth=0.8, linestyle=":")
        for row, (_, is_angle, _, pair) in zip(panels, SWEEP_ROWS, strict=True):
            if is_angle:
                values = [pair(spread) for sizes in sweep.values() for spread in sizes]
                log_y(row[0], np.array(values).ravel(), decades=3.0)
            else:
                for panel in row:
                    panel.axhline(HONEST_PERCENT, color=LIMIT, linewidth=0.8, linestyle=DASHES)
        for panel, quantity in zip(panels[-1], sweep, strict=True):
            panel.set_xlabel(quantity.label)
        panels[0][0].legend()
        _save(figure, path)


SWEEP_ROWS: tuple[tuple[str, bool, str, Callable[[SizeSpread], tuple[float, float]]], ...] = (
    ("pointing error, RMS [deg]", True, "Pointing, last three orbits", lambda of: of.pointing_deg),
    ("error of the estimate, RMS [deg]", True, "Estimate", lambda of: of.estimate_deg),
    ("time inside 3 sigma [%]", False, "Honesty; 99.7 % dashed", lambda of: of.inside_percent),
)
"""Label, whether an angle, title and values of each row."""


def _span(quantity: Quantity) -> tuple[float, float]:
    """From the least to the largest size, with room for the dots."""
    least, most = quantity.sizes(2)
    if quantity.scale == "log":
        room = (most / least) ** 0.04
        return least / room, most * room
    room = 0.04 * (most - least)
    return least - room, most + room


def _both(panel: Axes, sizes: Sequence[float], values: Sequence[tuple[float, float]]) -> None:
    for number, (name, dashes) in enumerate((("median; of honesty the mean", "-"), ("worst", "--"))):
        chosen, colour = [pair[number] for pair in values], AXES_COLOURS[number]
        panel.plot(sizes, chosen, dashes, marker="o", markersize=3.0, label=name, color=colour)


def _dots(panel: Axes, x: Sequence[float], y: Sequence[float], name: str, colour: str) -> None:
    panel.plot(x, y, linestyle="none", marker="o", markersize=3.0, alpha=0.7, label=name, color=colour)


def _save(figure: Figure, path: Path) -> None:
    with replacing(path) as file:
        figure.savefig(file, format="svg", facecolor="white", metadata={"Date": None})
