"""The charts of the report that show how much coils and wheel are used, of what they can give."""

import numpy as np

from sim.audit.findings import COILS
from sim.drawing.canvas import AXES_COLOURS, INK, LIMIT
from sim.drawing.time_chart import DrawnChart, Level, Panel, Series, TimeChart, draw
from sim.report.charts.drawn_flight import DrawnFlight


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
