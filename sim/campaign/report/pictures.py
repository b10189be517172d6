"""The pictures of a campaign."""

from collections.abc import Sequence
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from sim.campaign.definition.campaign import IndexLimits, StatisticsSection
from sim.campaign.definition.words import ColumnWords, percent
from sim.campaign.report.analysis import WORST, CampaignAnalysis, FigureStatistics, falls
from sim.drawing.canvas import AXES_COLOURS, INK, LIMIT, MORE_COLOURS, MUTED, WIDTH_IN, legend, log_x, log_y
from sim.statistics.order_statistics import Percentile, convergence
from sim.statistics.proportion import clopper_pearson
from sim.value_types import Array

PANEL_IN = 2.3
BAND, BAR = "#b9d4e8", "#9dbfd8"
COLUMNS = 3
LOGARITHMIC = 30.0
"""An input that varies by more than this factor has a logarithmic axis."""
MOST_INPUTS, MOST_BINS, MOST_STEPS = 6, 40, 400
MOST_TICKS, TITLE_WIDTH, TITLE_AN_INCH = 4, 26, 12
"""Of a panel of the scatter: numbers on its abscissa, letters in a line of its title; and in an inch."""


def distributions(analysis: CampaignAnalysis) -> list[Figure]:
    """A histogram of each figure; percentiles with their bounds and the requirement on it."""
    figures, panels = _panels(len(analysis.figures), 2)
    for panel, shown in zip(panels, analysis.figures, strict=False):
        bins = min(MOST_BINS, max(6, round(2.0 * len(shown.values) ** 0.5)))
        panel.hist(shown.values, bins=bins, color=BAR, edgecolor="white", linewidth=0.4)
        for number, found in enumerate(shown.percentiles):
            _mark(panel, found, number, shown)
        _limits(panel, shown)
        panel.set_title(_title(shown))
        panel.set_xlabel(shown.words.unit)
        panel.set_ylabel("runs")
        panel.yaxis.set_major_locator(MaxNLocator(integer=True))
    return figures


def cumulative(analysis: CampaignAnalysis, confidence: float) -> list[Figure]:
    """The fraction of runs up to a value, with its bounds, and the requirement."""
    figures, panels = _panels(len(analysis.figures), 2)
    for panel, shown in zip(panels, analysis.figures, strict=False):
        values, count = np.sort(shown.values), len(shown.values)
        steps = np.unique(np.linspace(1, count, min(count, MOST_STEPS)).round().astype(int))
        below = steps + (shown.without if falls(shown.requirement) else 0)
        bounds = [clopper_pearson(int(step), len(shown.ranked), confidence) for step in below]
        x = values[steps - 1]
        low, high = [each.low for each in bounds], [each.high for each in bounds]
        panel.fill_between(
            x, low, high, step="post", color=BAND, linewidth=0.0, label=f"{percent(confidence)} bounds"
        )
        panel.step(x, below / len(shown.ranked), where="post", color=AXES_COLOURS[0], label="part of runs")
        _limits(panel, shown)
        panel.set_ylim(0.0, 1.02)
        panel.set_title(_title(shown))
        panel.set_xlabel(shown.words.unit)
        panel.set_ylabel("part of runs")
        legend(panel)
    return figures


def indices(analysis: CampaignAnalysis, probability: float, limits: IndexLimits) -> list[Figure]:
    """The fraction of times of all runs, and of runs at all times, up to a value of each index; limits."""
    figures, panels = _panels(2, 2)
    for panel, title in zip(
        panels, ("mixed: part of all times", "ensemble: part of runs, at all times"), strict=False
    ):
        panel.set_title(title)
        panel.set_xlabel("deg")
        panel.axhline(probability, color=MUTED, linewidth=0.8, linestyle=(0, (4, 3)))
    for (name, profiles), colour in zip(
        analysis.profiles.items(), (*AXES_COLOURS, *MORE_COLOURS), strict=False
    ):
        for panel, values in zip(panels, (profiles[:, :-1].ravel(), profiles[:, -1]), strict=False):
            parts = np.linspace(0.0, 1.0, min(MOST_STEPS, len(values)))
            panel.plot(np.quantile(values, parts), parts, color=colour, label=name.upper())
            if (limit := getattr(limits, name)) is not None:
                panel.plot([limit], [probability], "x", color=colour, markersize=7.0)
    for panel, points in zip(panels, (slice(-1), slice(-1, None)), strict=True):
        values = np.concatenate([profiles[:, points].ravel() for profiles in analysis.profiles.values()])
        log_x(panel, float(values[values > 0.0].min()), float(values.max()))
        panel.set_ylim(0.0, 1.02)
        legend(panel)
    return figures


def scatter(analysis: CampaignAnalysis) -> list[Figure]:
    """The first figure over the inputs that it depends on most."""
    names = [each.column for each in analysis.sensitivities if each.correlation is not None][:MOST_INPUTS]
    figures, panels = _panels(len(names), COLUMNS)
    first = analysis.figures[0]
    flown = np.array(list(analysis.errors))
    places = np.searchsorted(flown, first.runs)
    for panel, name in zip(panels, names, strict=False):
        found = next(each.correlation for each in analysis.sensitivities if each.column == name)
        assert found is not None
        x = analysis.inputs[name][places]
        if x.min() > 0.0 and x.max() > LOGARITHMIC * x.min():
            log_x(panel, float(x.min()), float(x.max()))
        else:
            panel.xaxis.set_major_locator(MaxNLocator(MOST_TICKS))
        panel.plot(x, first.values, ".", color=AXES_COLOURS[0], markersize=3.0, alpha=0.6)
        worst = first.worst_first[:WORST]
        panel.plot(x[worst], first.values[worst], ".", color=LIMIT, markersize=4.0)
        if first.requirement and np.isfinite(first.requirement.at_most):
            panel.axhline(first.requirement.at_most, color=LIMIT, linewidth=0.8)
        title = "\n".join(_wrapped(analysis.input_words[name]))
        panel.set_title(f"{title}\nrank correlation {found.value:+.2f}")
        panel.set_ylabel(first.words.unit)
    return figures


def worst_runs(analysis: CampaignAnalysis, width_in: float = WIDTH_IN) -> Figure:
    """The pointing error of the worst runs over that of all: median, half and nine tenths of the runs.

    Where runs differ in length, those of the runs that last as long.
    """
    figure = Figure(figsize=(width_in, PANEL_IN + 0.9), layout="constrained")
    panel = figure.subplots()
    x, errors = over_time(list(analysis.errors.values()), analysis.orbits)
    runs, first = list(analysis.errors), analysis.figures[0]
    quantile = np.nanquantile if np.isnan(errors).any() else np.quantile
    low, quarter, middle, three, high = quantile(errors, (0.05, 0.25, 0.5, 0.75, 0.95), axis=0)
    panel.fill_between(x, low, high, color="#e4edf5", linewidth=0.0, label="90 % of runs")
    panel.fill_between(x, quarter, three, color=BAND, linewidth=0.0, label="50 %")
    panel.plot(x, middle, color=INK, label="median")
    drawn = []
    for place, colour in zip(first.worst_first[:WORST], (*AXES_COLOURS[1:], *MORE_COLOURS), strict=False):
        run = int(first.runs[place])
        drawn.append(errors[runs.index(run)])
        panel.plot(x, drawn[-1], color=colour, linewidth=0.9, label=f"run {run}")
    log_y(panel, low, high, *drawn, decades=3.5)
    panel.margins(x=0.0)
    panel.set_xlabel("orbits")
    panel.set_ylabel("pointing error [deg]")
    panel.set_title("Worst runs over the rest")
    legend(panel, None if width_in == WIDTH_IN else 3)
    return figure


def over_time(errors: Sequence[Array], orbits: Array) -> tuple[Array, Array]:
    """The errors of all runs at the same times.

    Args:
        errors: of each run, the RMS of its stretches; their number may differ.
        orbits: the length of each run.

    Returns:
        Times in orbits, and the errors at them, (runs, times); NaN after the end of a run.
    """
    points = max(map(len, errors))
    x = _middles(points, float(orbits.max()))
    rows = [
        np.where(x <= length, np.interp(x, _middles(len(error), length), error), np.nan)
        for error, length in zip(errors, orbits.tolist(), strict=True)
    ]
    return x, np.array(rows)


def _middles(count: int, length: float) -> Array:
    """The middles of ``count`` stretches."""
    return (np.arange(count) + 0.5) * length / count


def converging(analysis: CampaignAnalysis, settings: StatisticsSection, width_in: float = WIDTH_IN) -> Figure:
    """The percentile of the first figure by number of runs."""
    figure = Figure(figsize=(width_in, PANEL_IN + 0.4), layout="constrained")
    panel = figure.subplots()
    first = analysis.figures[0]
    probability, confidence = settings.probability, settings.confidence
    found = convergence(first.ranked, probability, confidence)
    least, largest = first.values.min(), first.values.max()
    low = np.clip(np.nan_to_num(found.low, nan=least), least, largest)
    high = np.clip(np.nan_to_num(found.high, nan=largest), least, largest)
    bounds = f"{percent(confidence)} bounds, all values where runs are too few for one"
    panel.fill_between(found.runs, low, high, color=BAND, linewidth=0.0, label=bounds)
    value = np.where(np.isfinite(found.value), found.value, np.nan)
    panel.plot(found.runs, value, color=AXES_COLOURS[0], label=f"{percent(probability)} of the runs so far")
    panel.set_xlabel("runs")
    panel.set_ylabel(first.words.unit)
    panel.margins(x=0.0)
    panel.set_title(
        "\n".join(wrap(f"Convergence of the {first.words.words}", round(TITLE_AN_INCH * width_in)))
    )
    legend(panel, None if width_in == WIDTH_IN else 1)
    return figure


def _panels(count: int, columns: int) -> tuple[list[Figure], list[Axes]]:
    """Figures of a panel each, of which so many stand beside each other on a wide page."""
    figures = [Figure(figsize=(WIDTH_IN / columns, PANEL_IN), layout="constrained") for _ in range(count)]
    return figures, [figure.subplots() for figure in figures]


def _wrapped(words: ColumnWords) -> list[str]:
    """A column in words, in lines that a narrow panel has room for."""
    return wrap(str(words), TITLE_WIDTH, break_long_words=False)


def _title(shown: FigureStatistics) -> str:
    return shown.words.words + (
        f"\n{shown.without} of {len(shown.ranked)} runs have none" if shown.without else ""
    )


def _mark(panel: Axes, found: Percentile, number: int, shown: FigureStatistics) -> None:
    """A percentile with its bounds; its words stand on the side to which there is room."""
    middle = 0.5 * float(shown.values.min() + shown.values.max())
    colour = {0.05: MUTED, 0.5: INK}.get(found.probability, AXES_COLOURS[1])
    if found.low is not None and found.high is not None:
        low, high = np.clip((found.low, found.high), shown.values.min(), shown.values.max()).tolist()
        panel.axvspan(low, high, color=colour, alpha=0.15, linewidth=0.0)
    if not np.isfinite(found.value):
        return
    panel.axvline(found.value, color=colour, linewidth=1.0)
    left = found.value > middle
    panel.annotate(
        percent(found.probability), (found.value, 1.0), (-2.0 if left else 2.0, -8.0 - 9.0 * number),
        ("data", "axes fraction"), "offset points", color=colour, fontsize=7.0,
        ha="right" if left else "left",
    )  # fmt: skip


def _limits(panel: Axes, shown: FigureStatistics) -> None:
    if shown.requirement is None:
        return
    for limit in (shown.requirement.at_least, shown.requirement.at_most):
        if np.isfinite(limit):
            panel.axvline(limit, color=LIMIT, linewidth=1.2, label="requirement")
