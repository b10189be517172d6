"""Gain schedules of the periodic regulators, computed once when the onboard table is loaded."""

from functools import lru_cache
from math import atan2, hypot, sqrt
from typing import Any

from fsw.core.algebra.vector import cross, dot, norm
from fsw.core.laws.lqr import LqrGains, schedule
from fsw.core.laws.riccati import Schedule
from fsw.core.orbit.earth import DIPOLE_TM3, MU_M3PS2
from fsw.core.orbit.propagation import Orbit, state_eci
from fsw.table.table import FlightTable

SCHEDULED = ("lqr", "mpc")
"""The laws that need a schedule."""

_schedule = lru_cache(maxsize=16)(schedule)
"""Pure, and the same for both laws unless their weights differ."""


def schedules(table: FlightTable, orbit: Orbit, gains: dict[str, Any]) -> dict[str, Schedule]:
    """By law, the schedule for this body and the circle of this orbit's size and plane."""
    state = state_eci(orbit, table.epoch_unix_s)
    if state is None:
        return {}
    r, v = state
    semi_axis_m = 1.0 / (2.0 / norm(r) - dot(v, v) / MU_M3PS2)
    n1, n2, n3 = cross(r, v)
    return {
        law: _schedule(
            table.body.inertia,
            table.body.wheel_nms,
            sqrt(MU_M3PS2 / semi_axis_m**3),
            atan2(hypot(n1, n2), n3),
            DIPOLE_TM3 / semi_axis_m**3,
            LqrGains(gains[law].rate, gains[law].effort),
        )
        for law in SCHEDULED
    }
