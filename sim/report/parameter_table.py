"""The table of the report that shows what the filter estimates besides attitude and rate."""

from math import degrees
from typing import Any

from fsw.core.estimation.parameters import COMPONENTS
from fsw.wire.messages import Component
from sim.drawing.page_parts import Table

Json = dict[str, Any]

UNITS = {
    "mag_bias_t": ("nT", 1e9),
    "torque_body_nm": ("N m", 1.0),
    "dipole_body_am2": ("A m²", 1.0),
    "coil_error": ("%", 100.0),
    "inertia_error_kgm2": ("kg m²", 1.0),
    "mag_turn_rad": ("°", degrees(1.0)),
    "mag_scale": ("%", 100.0),
    "sun_turn_rad": ("°", degrees(1.0)),
    "delay_s": ("s", 1.0),
    "cell_excess": ("%", 100.0),
    "cell_gain": ("%", 100.0),
    "earth_light": ("%", 100.0),
}
"""The unit in which the page shows a parameter, and how many of these are one of SI."""


def parameter_table(summary: Json) -> Table:
    """Estimates, bounds and truth in readable units, a row per component, named as on the bus."""
    figures = summary.get("parameters", {})
    rows = []
    for component, (name, offset) in zip(Component, COMPONENTS, strict=True):
        if name in figures:
            unit, factor = UNITS[name]
            columns = [figures[name].get(key) for key in ("bound", "value", "sigma", "truth")]
            cells = ["–" if column is None else f"{factor * column[offset]:.4g}" for column in columns]
            rows.append((component.name.lower(), unit, *cells))
    return Table(("", "unit", "bound", "estimate at the end", "sigma", "truth"), rows)
