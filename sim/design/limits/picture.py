"""The picture: pointing error over each quantity, a panel each, on one logarithmic axis."""

from collections.abc import Mapping
from math import isfinite
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from sim.design.limits.sweep import BOUND, QUANTITIES, Line, Setting, Sweep, error_deg
from sim.drawing.canvas import AXES_COLOURS, INK, style
from sim.record.whole_file import replacing

MARGINS = {
    "left": 0.08,
    "right": 0.985,
    "bottom": 0.05,
    "top": 0.92,
    "hspace": 0.5,
    "wspace": 0.08,
}
COLUMNS, LEAST_DEG, MOST_DEG = 2, 0.008, 25.0
LOOKS = {
    BOUND: {"color": INK, "linestyle": "-", "linewidth": 2.2},
    "mpc": {"color": AXES_COLOURS[1], "linestyle": "--", "marker": "o", "markersize": 4.5},
    "pulse_mpc": {"color": AXES_COLOURS[0], "linestyle": "-", "marker": "s", "markersize": 4.0},
}
"""Told apart without their colours: the bound by its width, the laws by dashes and markers."""
NO_TORQUE_LOOK = {"markerfacecolor": "white", "linewidth": 0.8}


def draw(flown: Mapping[str, float], path: Path) -> None:
    """Draw what has been flown; what was lost stands as a triangle at the upper edge."""
    rows = -(-len(QUANTITIES) // COLUMNS)
    with style():
        figure = Figure(figsize=(8.2, 2.75 * rows + 0.6))
        panels = figure.subplots(rows, COLUMNS, sharey=True, squeeze=False, gridspec_kw=MARGINS)
        for number, quantity in enumerate(QUANTITIES):
            panel = panels[divmod(number, COLUMNS)]
            for line in quantity.lines:
                _line(panel, quantity, line, flown)
            _axes(panel, quantity, f"({'abcdefghijkl'[number]}) {quantity.title}")
        for row in panels:
            row[0].set_ylabel("pointing error, RMS [deg]")
        handles, labels = panels[0][0].get_legend_handles_labels()
        columns = [number for law in range(3) for number in (law, law + 3)]
        figure.legend(
            [handles[number] for number in columns],
            [labels[number] for number in columns],
            loc="upper center",
            ncols=3,
        )
        with replacing(path) as file:
            figure.savefig(file, format="svg", facecolor="white", metadata={"Date": None})


def _line(panel: Axes, quantity: Sweep, line: Line, flown: Mapping[str, float]) -> None:
    known = [(one.at, error_deg(one, line, flown)) for one in quantity.settings]
    there = [(at, error) for at, error in known if error is not None]
    kept = [(at, error) for at, error in there if isfinite(error)]
    look = LOOKS[line.law] | ({} if line.torque else NO_TORQUE_LOOK)
    if quantity.scale == "names" and line.law != BOUND:
        look = look | {"linestyle": "none"}
    name = f"{line.law}, {'30 nN m an axis' if line.torque else 'no torque'}"
    panel.plot([at for at, _ in kept], [error for _, error in kept], label=name, **look)  # type: ignore[arg-type]  # of any option
    lost = [at for at, error in there if not isfinite(error)]
    panel.plot(lost, [MOST_DEG] * len(lost), "^", color=look["color"], clip_on=False)


def _axes(panel: Axes, quantity: Sweep, title: str) -> None:
    panel.set(yscale="log", ylim=(LEAST_DEG, MOST_DEG), xlabel=quantity.label)
    panel.set_title(title)
    panel.yaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
    panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    panel.yaxis.set_minor_locator(NullLocator())
    if quantity.scale == "linear":
        return
    if quantity.scale == "log":
        panel.set_xscale("log")
        panel.xaxis.set_minor_locator(NullLocator())
    panel.set_xticks([one.at for one in quantity.settings])
    panel.set_xticklabels([_tick(quantity, one) for one in quantity.settings])


def _tick(quantity: Sweep, setting: Setting) -> str:
    """Of levels one under the other."""
    return setting.label.replace(", ", "\n") if quantity.scale == "names" else f"{setting.at:g}"
