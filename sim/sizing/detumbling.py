"""How long the coils take to stop a tumble, with and without the limits of pulses.

B-dot with the strongest level takes angular momentum away at c m_3 B p, B being the field across a coil's
axis, p the part of the time for which a coil may be driven, and c how well the coils stand to the field and
to the rate: measured on flights of two cubesats at 5 to 17 deg/s, within a quarter. From 1 to 0.1 deg/s takes
1 to 5 orbits more: B-dot ends at twice the orbital rate, with which the field turns; the law does the rest.
"""

from dataclasses import dataclass

import numpy as np

from sim.design.from_scenario import body_of
from sim.scenario.controlled import SLOW_DEGPS, SLOWEST_DEGPS
from sim.scenario.schema import Scenario, orbit_period_s
from sim.scenario.sections import ScenarioCoils
from sim.sizing.expectation import field_across
from sim.value_types import Vec3

ONE_AT_A_TIME, EACH, CONTINUOUS = 0.7, 1.25, 1.1
"""c of coils that share their back-off, that have one each, and that are driven continuously."""
LAST_ORBITS = 2.5
USUAL_DEGPS: Vec3 = (10.0, 10.0, 10.0)
"""About each axis, after a rough separation: where the scenario begins slowly."""


@dataclass(frozen=True, slots=True)
class Detumbling:
    """How long it takes from a rate, by how the coils are driven [s].

    Attributes:
        rate_degps: at the start.
        to_slow_s: until it stays below 1 deg/s.
        to_slowest_s: until it stays below 0.1 deg/s.
        continuous_to_slow_s: the first, by the same dipole driven continuously.
        orbit_s: the orbit's period.
    """

    rate_degps: float
    to_slow_s: float
    to_slowest_s: float
    continuous_to_slow_s: float
    orbit_s: float


def detumbling(scenario: Scenario) -> Detumbling:
    """The time to stop the rate at which the scenario begins, or a usual one where it begins slowly."""
    began = scenario.initial.rate_degps
    rate_degps = np.array(began if np.linalg.norm(began) > SLOW_DEGPS else USUAL_DEGPS)
    rate = float(np.linalg.norm(rate_degps))
    momentum_nms = float(np.linalg.norm(np.asarray(scenario.body.inertia) @ np.radians(rate_degps)))
    per_degps_nms, orbit_s = momentum_nms / rate, orbit_period_s(scenario)
    coils, across_nm = scenario.coils, scenario.coils.largest_am2 * field_across(body_of(scenario))
    continuous = coils.driver == "continuous"
    part = coils.on_part * (CONTINUOUS if continuous else ONE_AT_A_TIME if coils.shared else EACH)
    freely = CONTINUOUS * (coils.on_part if continuous else ScenarioCoils.model_fields["on_fraction"].default)
    to_slow_nms = per_degps_nms * (rate - SLOW_DEGPS)
    to_slowest_nms = per_degps_nms * (rate - SLOWEST_DEGPS)
    return Detumbling(
        rate,
        to_slow_nms / (across_nm * part),
        to_slowest_nms / (across_nm * part) + LAST_ORBITS * orbit_s,
        to_slow_nms / (across_nm * freely),
        orbit_s,
    )


def detumbling_words(found: Detumbling, continuous: bool) -> str:
    """In hours and orbits, with what a driver without pulse limits would take."""
    text = (
        f"from {found.rate_degps:.3g} deg/s under 1 deg/s in {_long(found.to_slow_s, found.orbit_s)}, "
        f"under 0.1 in {_long(found.to_slowest_s, found.orbit_s)}"
    )
    if continuous:
        return text
    freely = _long(found.continuous_to_slow_s, found.orbit_s)
    return f'{text}; without pulse limits, coils.driver = "continuous", under 1 deg/s in {freely}'


def _long(time_s: float, orbit_s: float) -> str:
    hours = f"{time_s / 3600.0:.2g} h" if time_s < 72.0 * 3600.0 else f"{time_s / 86400.0:.2g} days"
    return f"{hours} ({time_s / orbit_s:.2g} orbits)"
