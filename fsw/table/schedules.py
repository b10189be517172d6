"""What the periodic laws compute once, when the onboard table is loaded: gain schedules, steps of pulses."""

from collections.abc import Callable
from functools import lru_cache
from math import atan2, ceil, hypot, pi, sqrt
from typing import Any, NamedTuple

import numpy as np

from fsw.core.actuation.pulses import PulseConfig
from fsw.core.algebra.vector import Mat3, Vec3, cross, dot, inverse, norm
from fsw.core.laws.h_infinity import robust_schedule
from fsw.core.laws.lqg_field import field_only_schedule
from fsw.core.laws.lqr import STEPS, LqrGains, schedule
from fsw.core.laws.lqr_averaged import averaged_schedule
from fsw.core.laws.lqr_disturbed import disturbed_schedule
from fsw.core.laws.plan.cost_to_go import rounded_problem, rounded_schedule
from fsw.core.laws.plan.orbit_ahead import sight
from fsw.core.laws.plan.pulse_model import PulseModel, choices
from fsw.core.laws.plan.riccati import Schedule, regulator_problem
from fsw.core.orbit.earth import DIPOLE_TM3, MU_M3PS2
from fsw.core.orbit.propagation import Orbit, state_eci
from fsw.table.table import FlightTable

SCHEDULERS: dict[str, Callable[..., Schedule]] = {
    "lqr": schedule,
    "mpc": schedule,
    "pulse_mpc": schedule,
    "sdre": schedule,
    "mpc_box": schedule,
    "mpc_fitted": schedule,
    "mpc_held": schedule,
    "h_infinity": robust_schedule,
    "lqr_averaged": averaged_schedule,
    "lqr_disturbed": disturbed_schedule,
    "lqg_field": field_only_schedule,
}
"""How the schedule of each law that needs one is made from body, circle and weights."""

LEAST_STEP_S = 60.0
"""Least time between opportunities, though coils could fire sooner: pulses closer together gain little."""
LEAST_SEARCHED, SEARCHED_S = 6, 600.0
"""Opportunities that are searched, and for how long at least."""


@lru_cache(maxsize=32)
def _made(
    make: Callable[..., Schedule],
    inertia_kgm2: Mat3,
    wheel_body_nms: Vec3,
    round_orbit: "Circle",
    weights: Any,  # noqa: ANN401  (each law has its own class)
) -> Schedule:
    """Pure, and the same for several laws unless their weights differ."""
    return make(inertia_kgm2, wheel_body_nms, *round_orbit, weights)


class Circle(NamedTuple):
    """The circle of an orbit's size and plane, and the field above the equator there."""

    rate_radps: float
    inclination_rad: float
    field_t: float


def circle(orbit: Orbit, unix_s: float) -> Circle | None:
    """The circle; None where the orbit has no position."""
    state = state_eci(orbit, unix_s)
    if state is None:
        return None
    r, v = state
    semi_axis_m = 1.0 / (2.0 / norm(r) - dot(v, v) / MU_M3PS2)
    n1, n2, n3 = cross(r, v)
    rate_radps = sqrt(MU_M3PS2 / semi_axis_m**3)
    return Circle(rate_radps, atan2(hypot(n1, n2), n3), DIPOLE_TM3 / semi_axis_m**3)


def schedules(table: FlightTable, orbit: Orbit, gains: dict[str, Any]) -> dict[str, Schedule]:
    """By law, the schedule for this body and the circle of its orbit."""
    round_orbit, body = circle(orbit, table.epoch_unix_s), table.body
    if round_orbit is None:
        return {}
    found = {
        law: _made(make, body.law_inertia, body.law_wheel_nms, round_orbit, _weights(make, gains[law]))
        for law, make in SCHEDULERS.items()
    }
    return found | {"pulse_mpc": rounded_schedule(found["pulse_mpc"])}


def _weights(make: Callable[..., Schedule], gains: Any) -> Any:  # noqa: ANN401  (each law has its own class)
    """What the schedule depends on: for the plain regulator the two weights alone, whatever its law."""
    return LqrGains(gains.rate, gains.effort) if make is schedule else gains


def planned_pulses(
    table: FlightTable, orbit: Orbit, gains: dict[str, Any], timing: PulseConfig
) -> PulseModel | None:
    """What pulsed coils can do at each opportunity; None with a continuous driver.

    With a back-off per coil the three take turns.
    """
    round_orbit = circle(orbit, table.epoch_unix_s)
    if round_orbit is None or table.coils.driver != "pulsed":
        return None
    rest = 1 if timing.shared else 3
    soonest_ticks = -(-(timing.pulse_ticks + timing.backoff_ticks) // rest)
    step_ticks = max(soonest_ticks, ceil(LEAST_STEP_S / rest / timing.tick_s))
    step_s = step_ticks * timing.tick_s
    searched = max(LEAST_SEARCHED, ceil(SEARCHED_S / step_s))
    problem = regulator_problem(
        table.body.law_inertia,
        table.body.law_wheel_nms,
        round_orbit.rate_radps,
        round_orbit.field_t,
        step_s,
        gains["pulse_mpc"].rate,
        gains["pulse_mpc"].effort,
    )
    orbit_s = 2.0 * pi / round_orbit.rate_radps
    steps_s = np.arange(round(gains["pulse_mpc"].horizon_orbits * STEPS)) * orbit_s / STEPS
    pulses_s, after_s = np.arange(searched) * step_s, searched * step_s - 0.5 * timing.pulse_s
    axes = table.body.law_axes
    coil_axes = timing.coil_axes if axes is None else axes.matrix(timing.coil_axes)
    wanted_s = [*pulses_s, *(pulses_s + 0.5 * step_s), *(after_s + 0.5 * orbit_s / STEPS + steps_s)]
    return PulseModel(
        *choices(timing.levels_am2, timing.pulse_s, inverse(table.body.law_inertia), coil_axes),
        step_ticks,
        rest,
        rounded_problem(problem),
        searched,
        sight(wanted_s, orbit_s),
    )
