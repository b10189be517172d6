"""What a flight costs, the same for every law: how late it settles, and what error is left.

    cost = T_s / T + log2(1 + RMS / 5 deg)

T the length of the flight, T_s when the error is under 5 deg from then on, however short the rest (T if it
never is), RMS that of the last orbit. The error is the angle from the nominal attitude, with
``modes.axis_only`` that of body axis 1 from the vertical; of laws that do not point it is the rate less the
one wanted, 0.05 deg/s in place of 5 deg, or, where the scenario requires a spin rate, that about body axis 1
alone, which a spin that is fixed in space holds while the orbital frame turns; the requirement says when it
has settled.
"""

from math import log2
from typing import NamedTuple

import numpy as np

from fsw.core.laws.entry import Aim
from sim.scenario.schema import Scenario, flight_table
from sim.statistics.settling import Settling, held_ticks
from sim.tuning.flown import FlownMotion
from sim.value_types import Array

BY_RATE = frozenset({Aim.RATE, Aim.SPIN, Aim.SUN})
"""Laws of these aims do not point: the rate tells them apart."""
SETTLED_DEG, SETTLED_DEGPS = 5.0, 0.05
"""Errors below which a flight has settled."""
LOST = 10.0
"""The cost of a flight that failed, more than that of any other."""


class Cost(NamedTuple):
    """Of a flight: the cost, the orbits until it settled, and the RMS of its last orbit.

    It has settled if it stays so for the last orbit at least; None: it has not.

    The RMS is in deg, or in deg/s for a law that does not point.
    """

    total: float
    settle_orbits: float | None
    rms: float


def cost_of(flight: FlownMotion, scenario: Scenario, aim: Aim) -> Cost:
    """The cost of a flight of a scenario by a law with an aim."""
    axis_only = flight_table(scenario).modes.axis_only
    pointing = axis_only or aim not in BY_RATE
    if pointing:
        error, settled = flight.axis1_deg if axis_only else flight.pointing_deg, SETTLED_DEG
    else:
        error, settled = _rate_error_degps(flight, scenario)
    rms = float(np.sqrt(np.mean(error[flight.orbit(-1)] ** 2)))
    step_s = float(flight.t_s[1])
    settling = Settling(held_ticks(1.0 / step_s, flight.orbit_s))
    settling.take(error < settled)
    settle_orbits = None if settling.tick is None else settling.tick * step_s / flight.orbit_s
    if not np.isfinite(rms):
        return Cost(LOST, None, rms)
    return Cost(settling.since / len(error) + log2(1.0 + rms / settled), settle_orbits, rms)


def _rate_error_degps(flight: FlownMotion, scenario: Scenario) -> tuple[Array, float]:
    """The error of the rate that is wanted, and under which it has settled."""
    off = np.degrees(flight.relative_body_radps - np.array([scenario.control.spin_radps, 0.0, 0.0]))
    for required in scenario.requirement:
        if required.what == "spin":
            return np.abs(off[:, 0]), required.settled_degps
    whole: Array = np.linalg.norm(off, axis=1)
    return whole, SETTLED_DEGPS
