"""The charts of the report that show the pulses against their limits: rasters, gaps, levels."""

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator

from sim.audit.findings import COILS, DrivenPulse
from sim.drawing.canvas import (
    AXES_COLOURS,
    LIMIT,
    NARROW_IN,
    WIDTH_IN,
    Span,
    TimeAxis,
    legend,
    shade,
    stacked,
)
from sim.drawing.envelope import BINS
from sim.drawing.time_chart import DrawnChart
from sim.report.charts.drawn_flight import DrawnFlight
from sim.value_types import Json

ZOOM_S = 1200.0
MARKS = 300
"""Marks of broken limits in a chart; the log of a board out of control may hold thousands."""
BACKOFF = "#f7e3d3"
_REACH = 0.42
"""Height of a bar of the highest level; lanes are 1 apart."""


def raster(flight: DrawnFlight) -> DrawnChart:
    """Every pulse of the flight: a lane per coil, a bar up or down by polarity, as high as its level."""
    time = flight.time
    figure, (panel,) = stacked(time, (2.1,), legends=bool(flight.audit.violations))
    draw_raster(panel, flight)
    panel.set_title("Every pulse of the flight")
    _violations(panel, flight, time)
    return DrawnChart(figure, {"panels": [pulse_lanes(flight)]})


def draw_raster(panel: Axes, flight: DrawnFlight) -> None:
    """The lanes and their bars, on axes of any size."""
    _lanes(panel, flight)
    bin_s, unit_s = flight.length_s / (2 * BINS), flight.time.unit_s
    for coil, colour in zip(COILS, AXES_COLOURS, strict=True):
        bars = {
            (round(float(pulse.start_s) / bin_s), pulse.level)
            for pulse in flight.audit.pulses
            if pulse.coil == coil
        }
        centres = [(place * bin_s / unit_s, level) for place, level in sorted(bars)]
        _bars(panel, coil, [(x, x, level) for x, level in centres], colour, flight.audit.limits.max_level)


def zoom(flight: DrawnFlight) -> DrawnChart:
    """The twenty minutes with the most pulses: their lengths, and the back-off after each."""
    return DrawnChart(_zoom(flight, WIDTH_IN), narrow=_zoom(flight, NARROW_IN))


def _zoom(flight: DrawnFlight, width_in: float) -> Figure:
    time = flight.window(flight.busiest(ZOOM_S), min(ZOOM_S, flight.length_s))
    figure, (panel,) = stacked(time, (2.3,), legends=bool(flight.audit.violations), width_in=width_in)
    _lanes(panel, flight)
    limits = flight.audit.limits
    backoff_s = limits.backoff_us / 1e6
    shown = [p for p in flight.audit.pulses if time.start_s - backoff_s < p.start_s < time.end_s]
    for coil, colour in zip(COILS, AXES_COLOURS, strict=True):
        locking = shown if limits.shared else [pulse for pulse in shown if pulse.coil == coil]
        low, high = _lane_fractions(coil)
        shade(panel, time, _backoff_spans(locking, backoff_s, time), low, high, BACKOFF, "backoff")
        own = [pulse for pulse in shown if pulse.coil == coil and pulse.end_s > time.start_s]
        edges = [(float(p.start_s) / time.unit_s, float(p.end_s) / time.unit_s, p.level) for p in own]
        _bars(panel, coil, edges, colour, limits.max_level)
        for (left, right, level), pulse in zip(edges, own, strict=True):
            panel.annotate(
                f"{float(pulse.length_s):.3g} s",
                ((left + right) / 2.0, _lane(coil)),
                (0.0, -3.0 if level > 0 else 3.0),
                textcoords="offset points",
                ha="center",
                va="top" if level > 0 else "bottom",
                fontsize=6.5,
                annotation_clip=True,
            )
    panel.xaxis.set_major_locator(MaxNLocator(10, steps=[1, 2, 5, 10]))
    part = f"The {ZOOM_S / 60.0:g} minutes with the most pulses" if flight.length_s > ZOOM_S else "The same"
    panel.set_title(f"{part}, to scale" + (", back-off shaded" if width_in == WIDTH_IN else ""))
    _violations(panel, flight, time)
    return figure


def gaps_and_levels(flight: DrawnFlight) -> DrawnChart:
    """The lengths of the gaps against the back-off, and the levels of the pulses."""
    pictures = [Figure(figsize=(WIDTH_IN / 2.0, 2.6), layout="constrained") for _ in range(2)]
    gaps, levels = (picture.subplots() for picture in pictures)
    _gaps(gaps, flight)
    _levels(levels, flight)
    return DrawnChart(pictures)


def _gaps(panel: Axes, flight: DrawnFlight) -> None:
    limits, gaps_s = flight.audit.limits, flight.gaps_s()
    limit_s = max(limits.backoff_us / 1e6, 1.0)
    least = float(np.clip(gaps_s.min(initial=limit_s / 2.0), 0.1, limit_s / 2.0))
    most = max(float(gaps_s.max(initial=0.0)), 2.0 * limit_s) * 1.001
    edges = np.unique((*np.geomspace(least, limit_s, 8)[:-1], limit_s, *np.geomspace(limit_s, most, 40)[1:]))
    counts, _ = np.histogram(np.maximum(gaps_s, least), edges)
    panel.stairs(counts, edges, fill=True, color=AXES_COLOURS[0])
    panel.yaxis.set_major_locator(MaxNLocator("auto", integer=True))
    panel.set_xscale("log")
    panel.set_xlim(edges[0], edges[-1])
    ticks = [t for t in (0.1, 1, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 1e4, 1e5) if least <= t <= most]
    panel.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    panel.set_xticks([], minor=True)
    panel.axvspan(edges[0], limit_s, facecolor=LIMIT, alpha=0.1, linewidth=0.0)
    panel.axvline(limit_s, color=LIMIT, linestyle=(0, (4, 2)), linewidth=1.1, label=f"{limit_s:g} s back-off")
    panel.grid(axis="x", visible=False)
    panel.set_xlabel("gap to the next pulse" + ("" if limits.shared else " of the same coil") + " [s]")
    panel.set_ylabel("count")
    panel.set_title(f"Gaps, least {gaps_s.min():.3f} s" if len(gaps_s) else "Gaps")
    legend(panel)


def _levels(panel: Axes, flight: DrawnFlight) -> None:
    highest = flight.audit.limits.max_level
    levels = range(-highest, highest + 1)
    for coil, colour in zip(COILS, AXES_COLOURS, strict=True):
        fired_levels = [pulse.level for pulse in flight.audit.pulses if pulse.coil == coil]
        heights = [fired_levels.count(level) for level in levels]
        places = np.array(levels) + 0.27 * (coil - 1)
        panel.bar(places, heights, 0.27, color=colour, label=f"coil {coil}", linewidth=0.0)
    panel.set_xticks(list(levels), [f"{level:+d}" if level else "0" for level in levels])
    panel.grid(axis="x", visible=False)
    panel.yaxis.set_major_locator(MaxNLocator("auto", integer=True))
    panel.set_xlabel("level")
    panel.set_ylabel("pulses")
    panel.set_title("Levels")
    legend(panel)


def _lane(coil: int) -> float:
    return float(len(COILS) - 1 - coil)


def _lane_fractions(coil: int) -> tuple[float, float]:
    return (_lane(coil) + 0.04) / len(COILS), (_lane(coil) + 0.96) / len(COILS)


def _lanes(panel: Axes, flight: DrawnFlight) -> None:
    highest = flight.audit.limits.max_level
    panel.set_ylim(-0.5, len(COILS) - 0.5)
    panel.set_yticks([_lane(coil) for coil in COILS], [f"coil {coil}" for coil in COILS])
    panel.set_yticks([_lane(coil) + sign * _REACH for coil in COILS for sign in (-1, 1)], minor=True)
    panel.set_yticklabels(
        [f"{sign * highest:+d}" for _ in COILS for sign in (-1, 1)], minor=True, fontsize=6.5
    )
    panel.tick_params(axis="y", which="both", length=0.0)
    panel.spines["left"].set_visible(False)


def _bars(
    panel: Axes, coil: int, edges: Iterable[tuple[float, float, int]], colour: str, max_level: int
) -> None:
    """All bars of a coil as one path; an outline, thin where there are many, keeps the shortest visible."""
    corners, codes = [], []
    for left, right, level in edges:
        low = _lane(coil)
        high = low + _REACH * level / max_level
        corners += [(left, low), (left, high)]
        codes += [Path.MOVETO, Path.LINETO]
        if right > left:
            corners += [(right, high), (right, low), (left, low)]
            codes += [Path.LINETO, Path.LINETO, Path.CLOSEPOLY]
    if not corners:
        return
    width = 0.8 if len(corners) < 1000 else 0.4
    bars = PathPatch(Path(corners, codes), facecolor=colour, edgecolor=colour, linewidth=width, zorder=2)
    bars.set_gid(f"pulses-{coil}")
    bars.set_clip_on(True)
    panel.add_patch(bars)


def _backoff_spans(pulses: Sequence[DrivenPulse], backoff_s: float, time: TimeAxis) -> list[Span]:
    """The back-off of each pulse that lies in the window, at least in part."""
    ends = [float(pulse.end_s) for pulse in pulses]
    return [(end, end + backoff_s) for end in ends if end < time.end_s and end + backoff_s > time.start_s]


def _violations(panel: Axes, flight: DrawnFlight, time: TimeAxis) -> None:
    violations = [v for v in flight.audit.violations if time.start_s <= v.time_s <= time.end_s][:MARKS]
    if violations:
        x = [float(one.time_s) / time.unit_s for one in violations]
        y = [_lane(one.coil) if one.coil is not None else len(COILS) - 0.6 for one in violations]
        panel.plot(x, y, "x", color=LIMIT, markersize=6, markeredgewidth=1.6, label="limit broken", zorder=3)
        legend(panel)


# --- The pulses of a flight as data of the page: a lane per coil

MOST_PULSES = 6000
"""Of a coil; of more, only the strongest in each of this many parts of the flight is shown."""


def pulse_lanes(flight: DrawnFlight) -> Json:
    """When each coil was driven, at which level, and for how long it locks out the next pulse."""
    limits = flight.audit.limits
    lanes = []
    for coil, colour in zip(COILS, AXES_COLOURS, strict=True):
        pulses = shown([pulse for pulse in flight.audit.pulses if pulse.coil == coil], flight.length_s)
        lanes.append(
            {
                "label": f"coil {coil}",
                "colour": colour,
                "spans_s": [[round(float(p.start_s), 3), round(float(p.end_s), 3)] for p in pulses],
                "levels": [pulse.level for pulse in pulses],
            }
        )
    return {
        "title": "Every pulse of the flight",
        "height": 200,
        "lanes": lanes,
        "most": limits.max_level,
        "backoff_s": limits.backoff_us / 1e6,
        "shared": limits.shared,
    }


def shown(pulses: Sequence[DrivenPulse], length_s: float) -> Sequence[DrivenPulse]:
    """The pulses of a coil, in order; of very many the strongest of each part of the flight."""
    if len(pulses) <= MOST_PULSES:
        return pulses
    strongest: dict[int, DrivenPulse] = {}
    for pulse in pulses:
        part = int(MOST_PULSES * float(pulse.start_s) / length_s)
        if part not in strongest or abs(pulse.level) > abs(strongest[part].level):
            strongest[part] = pulse
    return list(strongest.values())
