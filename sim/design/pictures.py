"""The pictures of ``torquer design``: the map of the gains, and robustness against errors of the inertia."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from sim.design.analysis import Analysis, PictureMaps
from sim.design.theory.bodies import Body
from sim.design.theory.linear import Gains
from sim.design.theory.robustness import PAIRS, InertiaMaps
from sim.design.theory.search import GainMap
from sim.drawing.canvas import AXES_COLOURS, LIMIT, style
from sim.record.whole_file import replacing
from sim.value_types import Array

AXIS_NAMES = ("1, radius", "2, along-track", "3, normal")
COLOURS = "RdBu_r"
DOTS_PER_INCH = 120
PANEL_IN = 4.1
"""Of a panel of the page."""
ON_MAP, MARK = "#14202b", "#fdfdfd"
"""On the colours of a map, which are the same on a dark page."""
LEAST_SCALE = 0.2
"""The colours reach at least to this degree."""

Marks = dict[str, tuple[str, Gains]]
"""Label to marker and gains."""


def gain_picture(path: Path, analysis: Analysis, maps: PictureMaps, of_scenario: Gains) -> None:
    """The figure of the gains as PNG."""
    with style():
        count = len(maps.degree_maps)
        figure = Figure(figsize=(5.2 * count + 1.0, 5.2), layout="constrained", facecolor="white")
        panels = list(figure.subplots(1, count, squeeze=False)[0])
        _draw_gains(panels, analysis, maps, of_scenario)
        _colour_bar(figure, panels, _gain_reach(maps))
        figure.suptitle(_title(analysis.body, "degree of stability over the gains"))
        _save(path, figure)


def gain_panels(analysis: Analysis, maps: PictureMaps, of_scenario: Gains) -> list[Figure]:
    """The same for a page, a figure for each panel."""
    figures = [_panel_figure() for _ in maps.degree_maps]
    _draw_gains([figure.subplots() for figure in figures], analysis, maps, of_scenario)
    for figure in figures:
        _colour_bar(figure, figure.axes, _gain_reach(maps))
    return figures


def robustness_picture(path: Path, analysis: Analysis, maps: InertiaMaps) -> None:
    """The figure of robustness as PNG."""
    with style():
        figure = Figure(figsize=(10.5, 9.0), layout="constrained", facecolor="white")
        panels = list(figure.subplots(2, 2).ravel())
        _draw_robustness(panels, maps)
        _colour_bar(figure, panels[:3], _reach(maps.degree))
        gains = analysis.chosen.gains
        gains_text = f"k_w {float(gains.k_w):.5g}, k_a {float(gains.k_a):.5g}"
        figure.suptitle(_title(analysis.body, f"degree of stability on another inertia, {gains_text}"))
        _save(path, figure)


def robustness_panels(maps: InertiaMaps) -> list[Figure]:
    """The same for a page, a figure for each panel."""
    figures = [_panel_figure() for _ in range(4)]
    _draw_robustness([figure.subplots() for figure in figures], maps)
    for figure in figures[:3]:
        _colour_bar(figure, figure.axes, _reach(maps.degree))
    return figures


def _panel_figure() -> Figure:
    return Figure(figsize=(PANEL_IN, PANEL_IN), layout="constrained")


def _draw_gains(panels: Sequence[Axes], analysis: Analysis, maps: PictureMaps, of_scenario: Gains) -> None:
    """The degree of stability over (k_w, k_a), for the continuous dipole and for pulses."""
    found, pulsed = analysis.search, analysis.pulsed
    marks = {"continuous dipole": _marks(analysis, of_scenario), "pulses": {"scenario": ("x", of_scenario)}}
    if found is None:
        marks["pulses"]["given"] = ("D", analysis.chosen.gains)
    elif pulsed is not None and pulsed.search is not None:
        marks["pulses"] |= {
            "best": ("*", pulsed.search.best.gains),
            "steady": ("o", pulsed.search.steady.gains),
        }
    for panel, (name, one) in zip(panels, maps.degree_maps.items(), strict=True):
        panel.set_title(name)
        _gain_panel(panel, one, marks[name], _gain_reach(maps))


def _gain_reach(maps: PictureMaps) -> float:
    return _reach(*(one.degree for one in maps.degree_maps.values()))


def _draw_robustness(panels: Sequence[Axes], maps: InertiaMaps) -> None:
    """The degree of stability against errors of the inertia."""
    for panel, (one, other), degree in zip(panels[:3], PAIRS, maps.degree, strict=True):
        percent = 100.0 * maps.errors
        _field(panel, percent, percent, degree, _reach(maps.degree))
        panel.plot(0.0, 0.0, "+", color=ON_MAP, markersize=9)
        panel.set_xlabel(f"error of the mass spread along axis {AXIS_NAMES[one]} (%)")
        panel.set_ylabel(f"error of the mass spread along axis {AXIS_NAMES[other]} (%)")
        panel.set_title(f"spreads along axes {one + 1} and {other + 1}")
    _tilt_panel(panels[3], maps)


def _marks(analysis: Analysis, of_scenario: Gains) -> Marks:
    own: Marks = {"scenario": ("x", of_scenario)}
    if analysis.search is None:
        return own | {"given": ("D", analysis.chosen.gains)}
    return own | {"best": ("*", analysis.search.best.gains), "steady": ("o", analysis.search.steady.gains)}


def _gain_panel(panel: Axes, one: GainMap, marks: Marks, reach: float) -> None:
    _field(panel, one.k_w, one.k_a, one.degree, reach)
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_xlim(one.k_w[0], one.k_w[-1])
    panel.set_ylim(one.k_a[0], one.k_a[-1])
    panel.set_xlabel("k_w (N m s/T²)")
    panel.set_ylabel("k_a (N m/T²)")
    for label, (marker, gains) in marks.items():
        inside = one.k_w[0] <= gains.k_w <= one.k_w[-1] and one.k_a[0] <= gains.k_a <= one.k_a[-1]
        if inside:
            panel.plot(
                gains.k_w, gains.k_a, marker, label=label, color="#ffd84d" if marker == "*" else MARK,
                markeredgecolor=ON_MAP, markersize=13 if marker == "*" else 8, linestyle="none",
            )  # fmt: skip
    panel.legend(
        loc="upper left", frameon=True, facecolor=MARK, labelcolor=ON_MAP, framealpha=1.0, borderpad=0.5
    )


def _reach(*degrees: Array) -> float:
    """The range of the colours, either way: to the most stable; the unstable are clipped at the same size."""
    return max(LEAST_SCALE, *(-float(np.nanmin(degree)) for degree in degrees))


def _field(panel: Axes, x: Array, y: Array, degree: Array, reach: float) -> None:
    """Colours of the degree, thin lines every tenth, a thick one where stability ends."""
    shown = np.clip(degree, -reach, reach)
    panel.contourf(x, y, shown, levels=np.linspace(-reach, reach, 41), cmap=COLOURS, extend="both")
    lines = panel.contour(x, y, shown, levels=np.arange(-2.0, 0.0, 0.1), colors=ON_MAP, linewidths=0.4)
    panel.clabel(lines, fmt="%.1f", fontsize=6.5)
    if shown.min() < 0.0 < shown.max():
        panel.contour(x, y, shown, levels=[0.0], colors=LIMIT, linewidths=1.6)
    panel.grid(False)


def _tilt_panel(panel: Axes, maps: InertiaMaps) -> None:
    for axis, (degree, colour) in enumerate(zip(maps.tilted, AXES_COLOURS, strict=True)):
        panel.plot(maps.tilts_deg, degree, color=colour, label=f"about axis {AXIS_NAMES[axis]}")
    panel.axhline(0.0, color=LIMIT, linewidth=1.2)
    panel.set_xlabel("turn of the principal axes (deg)")
    panel.set_ylabel("degree of stability (1/rad)")
    panel.set_title("directions of the principal axes")
    panel.margins(x=0.0)
    panel.legend(loc="best", frameon=True, facecolor="white", borderpad=0.5)


def _colour_bar(figure: Figure, panels: Sequence[Axes], reach: float) -> None:
    scale = ScalarMappable(TwoSlopeNorm(0.0, -reach, reach), COLOURS)
    bar = figure.colorbar(scale, ax=list(panels), shrink=0.9, extend="both")
    bar.set_label("degree of stability, max ln|multiplier| / 2π (1/rad); blue is stable")


def _title(body: Body, what: str) -> str:
    return f"{body.name}, {body.altitude_km:.0f} km, {body.inclination_deg:.1f}°: {what}"


def _save(path: Path, figure: Figure) -> None:
    with replacing(path) as file:
        figure.savefig(
            file, format="png", dpi=DOTS_PER_INCH, facecolor="white", metadata={"Software": "torquer"}
        )
