"""Tables of the periodic regulators, from the onboard table: computed once when it is loaded."""

from math import acos, sqrt
from typing import Any

from fsw.core.earth import DIPOLE_TM3, MU_M3PS2
from fsw.core.laws.lqr import LqrGains, schedule
from fsw.core.laws.riccati import Schedule
from fsw.core.orbit import Orbit, state_eci
from fsw.core.vector import cross, dot, norm
from fsw.io.schema import TableError
from fsw.io.table import FlightTable

SCHEDULED = ("lqr", "mpc")
"""The laws that need a schedule."""


def schedules(table: FlightTable, orbit: Orbit, gains: dict[str, Any]) -> dict[str, Schedule]:
    """By law, the schedule for this body and the circle of this orbit's size; none where none holds the body.

    Raises:
        TableError: none holds it and the law is selected.
    """
    state = state_eci(orbit, table.epoch_unix_s)
    if state is None:
        return {}
    r, v = state
    semi_axis_m = 1.0 / (2.0 / norm(r) - dot(v, v) / MU_M3PS2)
    normal = cross(r, v)
    found = {}
    for law in SCHEDULED:
        weights = LqrGains(gains[law].rate, gains[law].effort)
        try:
            found[law] = schedule(
                table.body.inertia,
                table.body.wheel_nms,
                sqrt(MU_M3PS2 / semi_axis_m**3),
                acos(normal[2] / norm(normal)),
                DIPOLE_TM3 / semi_axis_m**3,
                weights,
            )
        except ValueError as error:
            if table.control.law == law:
                raise TableError(f"flight table: control.law = '{law}': {error}") from None
    return found
