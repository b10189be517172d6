"""The sections of the report that hold charts, and the words under each chart."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from sim.audit.auditor import AuditReport
from sim.audit.findings import COILS, AuditLimits
from sim.drawing.canvas import AXES_COLOURS, INK, LIMIT, style
from sim.drawing.inline_svg import chart
from sim.drawing.page_parts import Chart
from sim.drawing.time_chart import DrawnChart, Level, Panel, Series, TimeChart, draw
from sim.report.charts import coils, ground_track, over_time
from sim.report.charts.drawn_flight import DrawnFlight
from sim.report.charts.lines import Lines
from sim.scenario.schema import Scenario

# --- The charts of the report that show how much coils and wheel are used, of what they can give


def duty(flight: DrawnFlight) -> DrawnChart:
    """Duty over the orbit before each time, against what pulse length and back-off allow."""
    limits, t_s = flight.audit.limits, flight.t_s
    cycle_s = (limits.pulse_us + limits.backoff_us) / 1e6
    known = t_s >= min(5.0 * cycle_s, flight.length_s / 4.0)
    duties = [np.where(known, 100.0 * flight.duty(coil, t_s), np.nan) for coil in COILS]
    series = [
        Series(f"coil {coil}", duty, colour)
        for coil, duty, colour in zip(COILS, duties, AXES_COLOURS, strict=True)
    ]
    if limits.shared:
        series.append(Series("all", sum(duties, np.zeros_like(t_s)), INK, 1.3))
    long_run = 100.0 * limits.pulse_us / (limits.pulse_us + limits.backoff_us)
    what = "all coils" if limits.shared else "each coil"
    bound = np.where(known, 100.0 * flight.most_duty(t_s), np.nan)
    series.append(Series(f"{long_run:.2f} %: limit of {what}", bound, LIMIT, 1.3))
    most = max([long_run, *(float(np.nanmax(line)) for line in (bound, *duties) if known.any())])
    panel = Panel(
        "Duty over the last orbit",
        "duty [%]",
        1.8,
        series,
        reach=(0.0, 1.15 * most),
    )
    return draw(flight.time, TimeChart(t_s, (panel,)))


def continuous_duty(flight: DrawnFlight) -> DrawnChart:
    """Duty of a continuous driver over the orbit before each time, against its part of a tick."""
    duties, most = 100.0 * flight.line("duty"), 100.0 * flight.audit.limits.most_duty(flight.length_s)
    series = [
        *(Series(f"coil {coil}", duties[:, coil], AXES_COLOURS[coil]) for coil in COILS),
        Series("any coil", duties[:, len(COILS)], INK, 1.3),
    ]
    limit = Level(most, f"{most:.4g} %: the part of a tick for which coils are driven", LIMIT)
    panel = Panel(
        "Duty over the last orbit", "duty [%]", 1.8, series, levels=(limit,), reach=(0.0, 1.15 * most)
    )
    return draw(flight.time, TimeChart(flight.t_s, (panel,)))


def wheel(flight: DrawnFlight) -> DrawnChart:
    """The momentum of the driven wheel relative to the body, between the ends of its range."""
    most_mnms = 1e3 * (flight.wheel_nms or 0.0)
    momentum = Series("wheel", 1e3 * flight.line("wheel_nms"), AXES_COLOURS[0])
    levels = [Level(sign * most_mnms, f"{sign * most_mnms:+.4g} mN m s", LIMIT) for sign in (1.0, -1.0)]
    reach = (-1.15 * most_mnms, 1.15 * most_mnms)
    panel = Panel("Momentum of the wheel", "momentum [mN m s]", 1.6, (momentum,), levels=levels, reach=reach)
    return draw(flight.time, TimeChart(flight.t_s, (panel,)))


# --- The sections

Drawing = tuple[Callable[[DrawnFlight], DrawnChart], str]
"""What draws a chart, and the words under it."""


class ChartSection(NamedTuple):
    """A section with charts, or a note why there are none."""

    anchor: str
    title: str
    charts: tuple[Chart, ...] = ()
    note: str = ""


def sections(scenario: Scenario, lines: Lines, audit: AuditReport) -> list[ChartSection]:
    """All sections with charts; that of the attitude is first, as it is looked at first."""
    if lines.ticks == 0:
        return [ChartSection("attitude", "Flight", note="No tick was flown: there is nothing to draw.")]
    flight = DrawnFlight.of(scenario, lines, audit)
    with style():
        return [
            ChartSection("attitude", "Attitude", _charts(flight, _ATTITUDE)),
            ChartSection("track", "Ground track", _charts(flight, _TRACK)),
            ChartSection("estimate", "Estimate", _charts(flight, _ESTIMATE))
            if lines.has_estimates
            else ChartSection("estimate", "Estimate", note=_NO_ESTIMATE[scenario.knowledge]),
            _effort(flight),
            ChartSection("environment", "Field, dipole and torques", _charts(flight, _ENVIRONMENT)),
        ]


def _effort(flight: DrawnFlight) -> ChartSection:
    """How coils, and a wheel that is driven, are used."""
    audit, wheel = flight.audit, _WHEEL if flight.wheel_nms is not None else ()
    title = "Coils and wheel against their limits" if wheel else "Coils against their limits"
    if audit.limits.is_continuous:
        used, driven = _CONTINUOUS, audit.dipoles is not None and audit.dipoles.any_driven > 0
    else:
        used, driven = _coils(audit.limits), bool(audit.pulses)
    if driven:
        return ChartSection("coils", title, _charts(flight, (*used, *wheel)))
    return ChartSection("coils", title, _charts(flight, wheel), "No coil was driven.")


def _charts(flight: DrawnFlight, drawings: tuple[Drawing, ...]) -> tuple[Chart, ...]:
    charts = []
    for drawing, words in drawings:
        drawn = drawing(flight)
        charts.append(chart(drawing.__name__, drawn.picture, words, drawn.data, drawn.narrow))
    return tuple(charts)


_TRACK: tuple[Drawing, ...] = (
    (
        ground_track.track,
        "Where the satellite was above the Earth; thick in eclipse. Dots: where each coil was driven.",
    ),
)
_ATTITUDE: tuple[Drawing, ...] = (
    (
        over_time.pointing,
        "True angle from the nominal attitude, and of axis 1, which looks up, from the local vertical. Grey "
        "bands, here and in all charts against time, are eclipses. A long history is drawn as the span "
        "between its least and largest values.",
    ),
    (over_time.modes, "Mode of the controller."),
    (
        over_time.rates,
        "True rate of the body relative to the orbital frame.",
    ),
)
_ESTIMATE: tuple[Drawing, ...] = (
    (
        over_time.estimate,
        "True error of the estimate, over all three axes, and three times the standard deviation that the "
        "filter states for it, 3 √tr P. A filter that knows what it does not know stays under the line.",
    ),
)
_ENVIRONMENT: tuple[Drawing, ...] = (
    (over_time.field_and_dipole, "As the plant has them. Coil 0, 1, 2 drives along body axis 1, 2, 3."),
    (
        over_time.torques,
        "As the plant has them, magnitudes. The coils act in pulses: theirs is the magnitude of the mean "
        "torque over ten minutes.",
    ),
)
_CONTINUOUS: tuple[Drawing, ...] = (
    (
        continuous_duty,
        "Fraction of the orbit before each time, or of the flight so far, for which a coil was driven: ticks "
        "in which the plant has a dipole along it, by the part of a tick for which the driver drives.",
    ),
)
_WHEEL: tuple[Drawing, ...] = (
    (
        wheel,
        "Momentum of the driven wheel along its axis, relative to the body, as the plant has it. Dashed: "
        "where its motor can speed it up no more.",
    ),
)
_NO_ESTIMATE = {
    "perfect": "Perfect knowledge: the plant sent attitude and rate to the controller.",
    "filter": "The filter gave no estimate in this flight.",
}


def _coils(limits: AuditLimits) -> tuple[Drawing, ...]:
    whose = "any coil" if limits.shared else "the same coil"
    return (
        (
            coils.raster,
            "A lane for each coil: bars go up or down with the polarity and reach as far as the level. They "
            "are drawn wider than the pulses last.",
        ),
        (
            coils.zoom,
            f"With the length of each pulse, at most {limits.pulse_us / 1e6:g} s. Shaded: the back-off of "
            f"{limits.backoff_us / 1e6:g} s from the end of a pulse, in which no pulse of {whose} may start.",
        ),
        (
            duty,
            "Fraction of the orbit before each time, or of the flight so far, for which a coil was driven, "
            "and the most that the limits admit in that time: pulses fit a little more into a short one.",
        ),
        (
            coils.gaps_and_levels,
            "From the end of a pulse to the start of the next; and how often which level.",
        ),
    )
