"""The charts of the report that show the flight: modes, attitude, rates, estimate, field and torques."""

import numpy as np
from matplotlib.figure import Figure

from fsw.wire.messages import Mode
from sim.drawing.canvas import (
    AXES_COLOURS,
    INK,
    LIMIT,
    MORE_COLOURS,
    MUTED,
    legend,
    log_y,
    shade,
    stacked,
    trace,
)
from sim.report.charts.drawn_flight import DrawnFlight

MODE_COLOURS = {
    Mode.SAFE: "#b3261e",
    Mode.DETUMBLE: "#e69f00",
    Mode.ACQUIRE: "#56b4e9",
    Mode.POINT: "#009e73",
}
SETTLED_DEG = 5.0


def modes(flight: DrawnFlight) -> Figure:
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
    return figure


def pointing(flight: DrawnFlight) -> Figure:
    """The angle of the whole attitude and that of axis 1."""
    time = flight.time
    figure, (panel,) = stacked(time, (2.3,))
    total, axis1 = flight.line("pointing_deg"), flight.line("axis1_deg")
    trace(panel, time, flight.t_s, axis1, "axis 1 from the vertical", AXES_COLOURS[0])
    trace(panel, time, flight.t_s, total, "whole attitude", INK, linewidth=1.2)
    panel.axhline(SETTLED_DEG, color=MUTED, linewidth=0.8, linestyle=(0, (4, 3)), label=f"{SETTLED_DEG:g}°")
    log_y(panel, total, axis1, decades=3.5)
    panel.set_ylabel("angle [deg]")
    panel.set_title("Pointing error")
    legend(panel)
    return figure


def rates(flight: DrawnFlight) -> Figure:
    """Rates relative to the orbital frame: components, and magnitude on a logarithmic scale."""
    time = flight.time
    figure, (components, magnitude) = stacked(time, (1.6, 1.3))
    omega, total = 1e3 * flight.line("omega_degps"), 1e3 * flight.line("rate_degps")
    for axis, colour in enumerate(AXES_COLOURS):
        trace(components, time, flight.t_s, omega[:, axis], f"axis {axis + 1}", colour)
    components.set_ylabel("rate [mdeg/s]")
    components.set_title("Rates relative to the orbital frame, body axes")
    legend(components)
    trace(magnitude, time, flight.t_s, total, "magnitude", INK)
    log_y(magnitude, total, decades=4.0)
    magnitude.set_ylabel("rate [mdeg/s]")
    magnitude.set_title("Their magnitude")
    return figure


def estimate(flight: DrawnFlight) -> Figure:
    """True errors of the estimated attitude and rate beside the 3 sigma that the filter expects."""
    time = flight.time
    figure, panels = stacked(time, (1.9, 1.6))
    histories = (
        ("Attitude estimate", "error [deg]", "attitude_error_deg", "attitude_sigma3_deg", 1.0),
        ("Rate estimate", "error [mdeg/s]", "rate_error_degps", "rate_sigma3_degps", 1e3),
    )
    for panel, (title, label, error_name, sigma3_name, unit) in zip(panels, histories, strict=True):
        error, sigma3 = unit * flight.line(error_name), unit * flight.line(sigma3_name)
        trace(panel, time, flight.t_s, error, "true error", AXES_COLOURS[0])
        trace(panel, time, flight.t_s, sigma3, "3σ of the filter", AXES_COLOURS[1], linewidth=1.3)
        log_y(panel, error, sigma3, decades=4.0)
        panel.set_ylabel(label)
        panel.set_title(title)
        legend(panel)
    return figure


def field_and_dipole(flight: DrawnFlight) -> Figure:
    """The geomagnetic field and the true dipole of the coils, body axes."""
    time = flight.time
    figure, (field, dipole) = stacked(time, (1.6, 1.4))
    b_ut, m_am2 = 1e6 * flight.line("b_body_t"), flight.line("m_body_am2")
    trace(field, time, flight.t_s, 1e6 * flight.line("field_t"), "magnitude", MUTED)
    for axis, colour in enumerate(AXES_COLOURS):
        trace(field, time, flight.t_s, b_ut[:, axis], f"axis {axis + 1}", colour)
        trace(dipole, time, flight.t_s, m_am2[:, axis], f"axis {axis + 1}", colour, linewidth=0.7)
    field.set_ylabel("field [µT]")
    field.set_title("Geomagnetic field, body axes")
    dipole.set_ylabel("dipole [A m²]")
    dipole.set_title("Coil dipole, body axes")
    legend(field)
    legend(dipole)
    return figure


def torques(flight: DrawnFlight) -> Figure:
    """Magnitudes of the torques by source."""
    time = flight.time
    figure, (panel,) = stacked(time, (2.0,))
    torques_unm = {source: 1e6 * torque for source, torque in flight.lines.torques().items()}
    colours = {"coils": INK, "gravity_gradient": AXES_COLOURS[0], "bias": AXES_COLOURS[1]}
    spare = iter((AXES_COLOURS[2], *MORE_COLOURS, LIMIT) * 4)
    for source, torque in torques_unm.items():
        label = source.replace("_", " ") + (", mean of 10 min" if source == "coils" else "")
        trace(panel, time, flight.t_s, torque, label, colours.get(source) or next(spare))
    log_y(panel, *torques_unm.values(), decades=3.5)
    panel.set_ylabel("torque [µN m]")
    panel.set_title("Torques by source")
    legend(panel)
    return figure
