"""Where the satellite of a scenario differs from its onboard table by more than the bounds of that table."""

from math import degrees

import numpy as np

from fsw.table.estimator import table_bounds
from fsw.table.uncertainty import UncertaintyTable, limits
from fsw.table.uncertainty import bounds as ordinary_bounds
from sim.report.figures.parameters import true_parameters
from sim.scenario.schema import Scenario, flight_table

SHOWN = 3
BEYOND = 1.2
"""A deviation above this many times its bound is stated, if it is more than ordinary for such a satellite."""
WITHOUT_SENSORS = ("coil_error", "inertia_error_kgm2")
"""What matters to a controller with perfect knowledge."""

WORDS = {
    "mag_bias_t": ("magnetometer bias", "nT", 1e9),
    "torque_body_nm": ("disturbance torque", "N m", 1.0),
    "dipole_body_am2": ("residual dipole", "A m^2", 1.0),
    "coil_error": ("gain or axes of the coils off by", "%", 100.0),
    "inertia_error_kgm2": ("inertia off by", "kg m^2", 1.0),
    "mag_turn_rad": ("magnetometer turned by", "deg", degrees(1.0)),
    "mag_scale": ("scale of the magnetometer off by", "%", 100.0),
    "sun_turn_rad": ("Sun sensor turned by", "deg", degrees(1.0)),
    "delay_s": ("age of the samples", "s", 1.0),
    "cell_gain": ("gain of a Sun cell off by", "%", 100.0),
    "earth_light": ("Earth's light on the cells off by", "% of the Sun's", 100.0),
}
"""A parameter in words, the unit in which it is stated, and how many of these are one of SI."""


def beyond_bounds(scenario: Scenario) -> list[str]:
    """Its parameters beyond their bounds, a clause each, the worst first; at most ``SHOWN``."""
    table = flight_table(scenario)
    bounds = limits(table_bounds(table), table.body.inertia)
    albedo = table.cells.albedo if table.cells else None
    usual = ordinary_bounds(UncertaintyTable(), table.ordinary, albedo)
    ordinary = limits(usual, table.body.inertia)
    at_start = {"lit": np.ones(1), "t_s": np.zeros(1)}
    found = []
    for name, values in true_parameters(scenario, table, at_start).items():
        if scenario.knowledge == "perfect" and name not in WITHOUT_SENSORS:
            continue
        times, true, bound = max(
            (abs(true) / max(BEYOND * bound, least), abs(true), bound)
            for true, bound, least in zip(values, bounds[name], ordinary[name], strict=True)
        )
        if times > 1.0:
            words, unit, factor = WORDS[name]
            found.append((times, f"{words} {factor * true:.3g} {unit}, its bound is {factor * bound:.3g}"))
    return [sentence for _, sentence in sorted(found, reverse=True)[:SHOWN]]
