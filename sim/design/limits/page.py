"""docs/pulse-limits.md, from the template ``page.md.j2`` and what was flown alone."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, sqrt
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from sim.design.limits.linear_flight import LOST_DEG
from sim.design.limits.sweep import BOUND, QUANTITIES, Line, Setting, Sweep, all_orders, error_deg
from sim.drawing.canvas import AXES_COLOURS, INK, style
from sim.record.whole_file import replacing


@dataclass(frozen=True, slots=True)
class Agreement:
    """A whole flight beside linear ones, their RMS errors in deg, of the same orbits."""

    name: str
    whole_deg: float
    linear_deg: tuple[float, ...]


def page(flown: Mapping[str, float], agreements: Sequence[Agreement], platform: str) -> str:
    """The page.

    Args:
        flown: by the key of an order, its error in deg.
        agreements: whole flights beside linear ones.
        platform: what it was computed with.
    """

    def deg(title: str, label: str, law: str, torque: bool = True) -> str:
        return _figure(_error_deg(title, label, Line(law, torque), flown))

    def beyond(title: str, label: str, law: str) -> str:
        error = _error_deg(title, label, Line(law), flown)
        least = _error_deg(title, label, Line(BOUND), flown)
        return "" if error is None or least is None else _figure(sqrt(max(0.0, error**2 - least**2)))

    environment = Environment(
        loader=PackageLoader("sim.design.limits"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    orders = all_orders()
    return environment.get_template("page.md.j2").render(
        quantities=[(one.title, list(_table(one, flown))) for one in QUANTITIES],
        agreements=agreements,
        deg=deg,
        beyond=beyond,
        platform=platform,
        there=sum(order.key in flown for order in orders),
        orders=len(orders),
    )


def _error_deg(title: str, label: str, line: Line, flown: Mapping[str, float]) -> float | None:
    """What was flown of a quantity at the value that is so called."""
    quantity = next(one for one in QUANTITIES if one.title == title)
    setting = next(one for one in quantity.settings if one.label == label)
    return error_deg(setting, line, flown)


def _table(quantity: Sweep, flown: Mapping[str, float]) -> Iterator[str]:
    """A row for each value, a column for each line."""
    names = [line.law if line.torque else f"{line.law}, no torque" for line in quantity.lines]
    yield _row(quantity.label, *names)
    yield "|---" * (1 + len(names)) + "|"
    for setting in quantity.settings:
        errors = (error_deg(setting, line, flown) for line in quantity.lines)
        yield _row(setting.label, *map(_figure, errors))


def _figure(error: float | None) -> str:
    if error is None:
        return ""
    return f"{error:.3g}" if isfinite(error) else f"> {LOST_DEG:g}"


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


# --- The picture: pointing error over each quantity, a panel each, on one logarithmic axis

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
