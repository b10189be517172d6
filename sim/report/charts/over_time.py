"""The charts of the report that show the flight: modes, attitude, rates, estimate, field and torques."""

import numpy as np

from fsw.wire.messages import Mode
from sim.drawing.canvas import AXES_COLOURS, INK, LIMIT, MORE_COLOURS, MUTED, Span, shade, stacked
from sim.drawing.time_chart import DrawnChart, Level, Panel, Series, TimeChart, draw
from sim.report.charts.drawn_flight import DrawnFlight
from sim.scenario.controlled import SETTLED_DEG, SLOW_DEGPS
from sim.value_types import Array, Json

MODE_COLOURS = {
    Mode.SAFE: "#b3261e",
    Mode.DETUMBLE: "#e69f00",
    Mode.ACQUIRE: "#56b4e9",
    Mode.POINT: "#009e73",
}
MOST_SPANS = 2000
"""Most spans of a mode that are drawn."""


def modes(flight: DrawnFlight) -> DrawnChart:
    """The mode of the controller."""
    time = flight.time
    figure, (panel,) = stacked(time, (0.9,), legends=False)
    rows = len(Mode)
    for row, mode in enumerate(Mode):
        low, high = (row + 0.18) / rows, (row + 0.82) / rows
        shade(panel, time, flight.in_mode(mode), low, high, MODE_COLOURS[mode], f"mode-{mode.name}")
    panel.set_ylim(0.0, rows)
    panel.set_yticks(np.arange(rows) + 0.5, [mode.name for mode in Mode])
    panel.tick_params(axis="y", length=0.0)
    panel.grid(axis="y", visible=False)
    panel.set_title("Mode")
    return DrawnChart(figure, {"panels": [_mode_lanes(flight)]})


def _mode_lanes(flight: DrawnFlight) -> Json:
    lanes = [
        {"label": mode.name, "colour": MODE_COLOURS[mode], "spans_s": _few(flight.in_mode(mode))}
        for mode in Mode
    ]
    return {"title": "Mode", "height": 100, "lanes": lanes}


def _few(spans: tuple[Span, ...]) -> list[Span]:
    """The longest of them, in order, where a controller that chatters has very many."""
    longest = sorted(spans, key=lambda span: span[0] - span[1])[:MOST_SPANS]
    return sorted(longest)


def pointing(flight: DrawnFlight) -> DrawnChart:
    """The angle of the whole attitude and that of axis 1."""
    panel = Panel(
        "Pointing error",
        "angle [deg]",
        2.3,
        (
            Series("axis 1 from the vertical", flight.line("axis1_deg"), AXES_COLOURS[0]),
            Series("whole attitude", flight.line("pointing_deg"), INK, 1.2),
        ),
        decades=3.5,
        levels=(Level(SETTLED_DEG, f"{SETTLED_DEG:g}°"),),
    )
    return draw(flight.time, TimeChart(flight.t_s, (panel,)))


def rates(flight: DrawnFlight) -> DrawnChart:
    """Rates relative to the orbital frame: components, and magnitude on a logarithmic scale."""
    tumbles = float(np.nanmax(flight.line("rate_degps"))) >= SLOW_DEGPS
    unit, factor = ("deg/s", 1.0) if tumbles else ("mdeg/s", 1e3)
    omega, total = factor * flight.line("omega_degps"), factor * flight.line("rate_degps")
    components = Panel(
        "Rates relative to the orbital frame, body axes", f"rate [{unit}]", 1.6, _by_axis(omega)
    )
    magnitude = Panel(
        "Their magnitude", f"rate [{unit}]", 1.3, (Series("magnitude", total, INK),), decades=4.0
    )
    return draw(flight.time, TimeChart(flight.t_s, (components, magnitude)))


def estimate(flight: DrawnFlight) -> DrawnChart:
    """True errors of the estimated attitude and rate, and the 3 sigma that the filter expects."""
    histories = (
        ("Attitude estimate", "error [deg]", 1.9, "attitude_error_deg", "attitude_sigma3_deg", 1.0),
        ("Rate estimate", "error [mdeg/s]", 1.6, "rate_error_degps", "rate_sigma3_degps", 1e3),
    )
    panels = [
        Panel(
            title,
            label,
            height_in,
            (
                Series("true error", unit * flight.line(error), AXES_COLOURS[0]),
                Series("3σ of the filter", unit * flight.line(sigma3), AXES_COLOURS[1], 1.3),
            ),
            decades=4.0,
        )
        for title, label, height_in, error, sigma3, unit in histories
    ]
    return draw(flight.time, TimeChart(flight.t_s, panels))


def field_and_dipole(flight: DrawnFlight) -> DrawnChart:
    """The geomagnetic field and the true dipole of the coils, body axes."""
    b_ut, m_am2 = 1e6 * flight.line("b_body_t"), flight.line("m_body_am2")
    magnitude = Series("magnitude", 1e6 * flight.line("field_t"), MUTED)
    field = Panel("Geomagnetic field, body axes", "field [µT]", 1.6, (magnitude, *_by_axis(b_ut)))
    dipole = Panel("Coil dipole, body axes", "dipole [A m²]", 1.4, _by_axis(m_am2, 0.7))
    return draw(flight.time, TimeChart(flight.t_s, (field, dipole)))


def torques(flight: DrawnFlight) -> DrawnChart:
    """Magnitudes of the torques by source."""
    colours = {"coils": INK, "gravity_gradient": AXES_COLOURS[0], "bias": AXES_COLOURS[1]}
    spare = iter((AXES_COLOURS[2], *MORE_COLOURS, LIMIT) * 4)
    series = [
        Series(
            source.replace("_", " ") + (", mean of 10 min" if source == "coils" else ""),
            1e6 * torque,
            colours.get(source) or next(spare),
        )
        for source, torque in flight.lines.torques().items()
    ]
    panel = Panel("Torques by source", "torque [µN m]", 2.0, series, decades=3.5)
    return draw(flight.time, TimeChart(flight.t_s, (panel,)))


def _by_axis(vectors: Array, width: float = 1.0) -> tuple[Series, ...]:
    return tuple(
        Series(f"axis {axis + 1}", vectors[:, axis], colour, width)
        for axis, colour in enumerate(AXES_COLOURS)
    )
