"""The charts of the report that show the flight: modes, attitude, rates, estimate, field and torques."""

import numpy as np
from matplotlib.axes import Axes

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
    figure, (panel,) = stacked(flight.time, (0.9,), legends=False)
    draw_modes(panel, flight)
    panel.set_title("Mode")
    return DrawnChart(figure, {"panels": [_mode_lanes(flight)]})


def draw_modes(panel: Axes, flight: DrawnFlight) -> None:
    """A lane for each mode, on axes of any size."""
    rows = len(Mode)
    for row, mode in enumerate(Mode):
        low, high = (row + 0.18) / rows, (row + 0.82) / rows
        shade(panel, flight.time, flight.in_mode(mode), low, high, MODE_COLOURS[mode], f"mode-{mode.name}")
    panel.set_ylim(0.0, rows)
    panel.set_yticks(np.arange(rows) + 0.5, [mode.name for mode in Mode])
    panel.tick_params(axis="y", length=0.0)
    panel.grid(axis="y", visible=False)


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
    return draw(flight.time, TimeChart(flight.t_s, (pointing_panel(flight),)))


def pointing_panel(flight: DrawnFlight) -> Panel:
    """Both angles on a logarithmic scale, and the one below which a flight has settled."""
    return Panel(
        "Pointing error",
        "pointing error [deg]",
        2.3,
        (
            Series("axis 1 from the vertical", flight.line("axis1_deg"), AXES_COLOURS[0]),
            Series("whole attitude", flight.line("pointing_deg"), INK, 1.2),
        ),
        decades=3.5,
        levels=(Level(SETTLED_DEG, f"{SETTLED_DEG:g}°"),),
    )


def rates(flight: DrawnFlight) -> DrawnChart:
    """Rates relative to the orbital frame: components, and magnitude on a logarithmic scale."""
    return draw(flight.time, TimeChart(flight.t_s, (rate_panel(flight), rate_magnitude_panel(flight))))


def rate_panel(flight: DrawnFlight) -> Panel:
    """The components, body axes."""
    unit, factor = _rate_unit(flight)
    lines = _by_axis(factor * flight.line("omega_degps"))
    return Panel("Rates relative to the orbital frame, body axes", f"relative rate [{unit}]", 1.6, lines)


def rate_magnitude_panel(flight: DrawnFlight) -> Panel:
    """The magnitude on a logarithmic scale."""
    unit, factor = _rate_unit(flight)
    line = Series("magnitude", factor * flight.line("rate_degps"), INK)
    return Panel("Their magnitude", f"relative rate [{unit}]", 1.3, (line,), decades=4.0)


def _rate_unit(flight: DrawnFlight) -> tuple[str, float]:
    """The unit that suits the rates, and how many there are in a degree a second."""
    tumbles = float(np.nanmax(flight.line("rate_degps"))) >= SLOW_DEGPS
    return ("deg/s", 1.0) if tumbles else ("mdeg/s", 1e3)


def estimate(flight: DrawnFlight) -> DrawnChart:
    """True errors of the estimated attitude and rate, and the 3 sigma that the filter expects."""
    panels = (attitude_error_panel(flight), rate_error_panel(flight))
    return draw(flight.time, TimeChart(flight.t_s, panels))


def attitude_error_panel(flight: DrawnFlight) -> Panel:
    """The error of the attitude."""
    lines = _error_lines(flight.line("attitude_error_deg"), flight.line("attitude_sigma3_deg"))
    return Panel("Attitude estimate", "attitude error [deg]", 1.9, lines, decades=4.0)


def rate_error_panel(flight: DrawnFlight) -> Panel:
    """The error of the rate."""
    lines = _error_lines(1e3 * flight.line("rate_error_degps"), 1e3 * flight.line("rate_sigma3_degps"))
    return Panel("Rate estimate", "rate error [mdeg/s]", 1.6, lines, decades=4.0)


def _error_lines(error: Array, sigma3: Array) -> tuple[Series, ...]:
    return (
        Series("true error", error, AXES_COLOURS[0]),
        Series("3σ of the filter", sigma3, AXES_COLOURS[1], 1.3),
    )


def field_and_dipole(flight: DrawnFlight) -> DrawnChart:
    """The geomagnetic field and the true dipole of the coils, body axes."""
    return draw(flight.time, TimeChart(flight.t_s, (field_panel(flight), dipole_panel(flight))))


def field_panel(flight: DrawnFlight) -> Panel:
    """The geomagnetic field, body axes."""
    magnitude = Series("magnitude", 1e6 * flight.line("field_t"), MUTED)
    lines = (magnitude, *_by_axis(1e6 * flight.line("b_body_t")))
    return Panel("Geomagnetic field, body axes", "field [µT]", 1.6, lines)


def dipole_panel(flight: DrawnFlight) -> Panel:
    """The true dipole of the coils, body axes."""
    lines = _by_axis(flight.line("m_body_am2"), 0.7)
    return Panel("Coil dipole, body axes", "dipole [A m²]", 1.4, lines)


def torques(flight: DrawnFlight) -> DrawnChart:
    """Magnitudes of the torques by source."""
    return draw(flight.time, TimeChart(flight.t_s, (torque_panel(flight),)))


def torque_panel(flight: DrawnFlight) -> Panel:
    """The magnitudes on a logarithmic scale."""
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
    return Panel("Torques by source", "torque [µN m]", 2.0, series, decades=3.5)


def _by_axis(vectors: Array, width: float = 1.0) -> tuple[Series, ...]:
    return tuple(
        Series(f"axis {axis + 1}", vectors[:, axis], colour, width)
        for axis, colour in enumerate(AXES_COLOURS)
    )
